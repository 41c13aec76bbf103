// aircraft.geo: air around a parametric aircraft, inside a sphere of radius 30.
// Paper section 4.3 (Figs. 7-10, Table 2): an aircraft of length 2 is moved by 4
// units in a mesh of non-uniform size with 20192 nodes and 97868 tetrahedra.
//
// The paper takes its geometry from the Drag Prediction Workshop. This one is of
// our own making and has the same parts: a fuselage of revolution, swept wings,
// tailplane and fin lofted from NACA 0012 sections, fused with OpenCASCADE and
// cut from the sphere. The fuselage lies along x, nose at x = -1 and tail at
// x = 1; y is to the right of the pilot, z is up. The sphere is centred at the
// origin, the middle of the fuselage.
//
//   gmsh -nt 1 -3 -format msh22 aircraft.geo -o aircraft.msh
//
// Expected with gmsh 4.8.4 (OpenCASCADE 7.6): 20197 nodes in use, one more in the
// file (see the end of "domain"), 97861 tetrahedra, aircraft 16732 and farfield
// 614 faces. The four sizes below were tuned for these counts; a coarser aircraft
// (9042 nodes, 46346 tetrahedra) comes from  -setnumber h_edge 0.02
// -setnumber h_body 0.06; half-aircraft.msh (see generate.sh) is one half, coarser.

SetFactory("OpenCASCADE");

DefineConstant[
  half   = 0,         // 1: the right half, y > 0, with the surface "symmetry"
  h_edge = 0.0095,    // size at leading and trailing edges, tips and wing roots
  h_body = 0.0238,    // size elsewhere on the aircraft
  growth = 0.606,     // increase of the size per unit of distance to the aircraft
  h_far  = 7          // size at the sphere
];

// ------------------------------------------------------------------ fuselage
// Half profile in the plane y = 0 (elliptic nose, cylinder, slender tail with a
// round end), revolved about the x axis; the seam is at the bottom.
r = 0.1;
Point(1) = {-1, 0, 0};
Point(2) = {-0.65, 0, 0};
Point(3) = {-0.65, 0, -r};
Ellipse(1) = {3, 2, 1, 1};
Point(4) = {0.35, 0, -r};
Line(2) = {3, 4};
Point(5) = {0.60, 0, -r};
Point(6) = {0.85, 0, -0.045};
Point(7) = {0.975, 0, -0.02};
Bezier(3) = {4, 5, 6, 7};
Point(8) = {0.995, 0, -0.016};
Point(9) = {1, 0, -0.01};
Point(10) = {1, 0, 0};
Bezier(4) = {7, 8, 9, 10};
Line(5) = {10, 1};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};
fuselage[] = Extrude{ {1, 0, 0}, {0, 0, 0}, 2*Pi }{ Surface{1}; };
Recursive Delete{ Surface{1}; }

// ------------------------------------------------- wings, tailplane and fin
// One closed NACA 0012 section, from the trailing edge over the upper side to the
// leading edge and back: leading edge at (x0, y0, z0), chord along x, thickness
// along z (upright = 0) or along y (upright = 1). Last coefficient 0.1036: sharp
// trailing edge. Result: the curve loop `section`.
n = 16;
Macro Section
  p = newp;
  For i In {0 : 2*n-1}
    c = 0.5*(1 + Cos(Pi*i/n));
    h = 0.6*(0.2969*Sqrt(c) - 0.1260*c - 0.3516*c^2 + 0.2843*c^3 - 0.1036*c^4);
    If (i == 0 || i == n)
      c = (i == 0) ? 1 : 0;
      h = 0;
    EndIf
    If (i > n)
      h = -h;
    EndIf
    Point(p+i) = {x0 + chord*c, y0 + upright*chord*h, z0 + (1-upright)*chord*h};
  EndFor
  l = newl;
  Spline(l) = {p : p+n};
  Spline(l+1) = {p+n : p+2*n-1, p};
  section = newll;
  Curve Loop(section) = {l, l+1};
Return

// Wings: from tip to tip through the root, half span 0.95, leading edge swept by
// 28 degrees, dihedral 5 degrees.
upright = 0;
x0 = -0.25;  y0 = 0;      z0 = -0.045;  chord = 0.42;
Call Section;
root = section;
x0 = 0.255;  y0 = 0.95;   z0 = 0.038;   chord = 0.13;
Call Section;
right = section;
x0 = 0.255;  y0 = -0.95;  z0 = 0.038;   chord = 0.13;
Call Section;
left = section;
wings = newv;
Ruled ThruSections(wings) = {left, root, right};

// Tailplane: half span 0.35.
x0 = 0.68;   y0 = 0;      z0 = 0.01;    chord = 0.21;
Call Section;
root = section;
x0 = 0.87;   y0 = 0.35;   z0 = 0.035;   chord = 0.09;
Call Section;
right = section;
x0 = 0.87;   y0 = -0.35;  z0 = 0.035;   chord = 0.09;
Call Section;
left = section;
tailplane = newv;
Ruled ThruSections(tailplane) = {left, root, right};

// Fin: up to z = 0.37.
upright = 1;
x0 = 0.58;   y0 = 0;      z0 = 0;       chord = 0.32;
Call Section;
root = section;
x0 = 0.87;   y0 = 0;      z0 = 0.37;    chord = 0.11;
Call Section;
tip = section;
fin = newv;
Ruled ThruSections(fin) = {root, tip};

// -------------------------------------------------------------------- domain
body() = BooleanUnion{ Volume{fuselage[1]}; Delete; }{ Volume{wings, tailplane, fin}; Delete; };
air = newv;
Sphere(air) = {0, 0, 0, 30};
domain() = BooleanDifference{ Volume{air}; Delete; }{ Volume{body()}; Delete; };

If (half)
  side = newv;
  Box(side) = {-31, 0, -31, 62, 31, 62};
  domain() = BooleanIntersection{ Volume{domain()}; Delete; }{ Volume{side}; Delete; };
EndIf

b = 1.1;                                        // a box around the aircraft
aircraft() = Surface In BoundingBox{-b, -b, -b, b, b, b};
farfield() = Surface{:};
farfield() -= aircraft();
If (half)
  symmetry() = Surface In BoundingBox{-31, -1e-3, -31, 31, 1e-3, 31};
  aircraft() -= symmetry();
  farfield() -= symmetry();
  Physical Surface("symmetry", 5) = {symmetry()};
EndIf

Physical Surface("aircraft", 1) = {aircraft()};
Physical Surface("farfield", 2) = {farfield()};
Physical Volume("domain", 3) = {domain()};

// A point in the middle of the fuselage, as flow solvers have one for their
// moments. No tetrahedron uses it: a reader has to pass over such a node.
reference = newp;
Point(reference) = {0, 0, 0};
Physical Point("reference", 4) = {reference};

// --------------------------------------------------------------------- sizes
// Every curve to the right, to the left and above the fuselage is an edge, a tip
// or a root of wings, tailplane or fin.
edges() = Curve In BoundingBox{-b, 0.03, -b, b, b, b};
edges() += Curve In BoundingBox{-b, -b, -b, b, -0.03, b};
edges() += Curve In BoundingBox{-b, -b, 0.03, b, b, b};

Field[1] = Distance;
Field[1].CurvesList = {edges()};
Field[1].NumPointsPerCurve = 100;
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = h_edge;
Field[2].SizeMax = h_body;
Field[2].DistMin = 0;
Field[2].DistMax = (h_body - h_edge)/0.25;
Field[2].StopAtDistMax = 1;

Field[3] = Distance;
Field[3].SurfacesList = {aircraft()};
Field[3].NumPointsPerCurve = 40;
Field[4] = Threshold;
Field[4].InField = 3;
Field[4].SizeMin = h_body;
Field[4].SizeMax = h_far;
Field[4].DistMin = 0;
Field[4].DistMax = (h_far - h_body)/growth;

Field[5] = Min;
Field[5].FieldsList = {2, 4};
Background Field = 5;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 6;                             // frontal Delaunay on the surfaces
MeshAlgorithm Surface{farfield()} = 1;          // MeshAdapt: no long edges at the poles
Mesh.Algorithm3D = 1;                           // Delaunay
Mesh.Optimize = 1;

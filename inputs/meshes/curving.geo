// curving.geo: straight-sided mesh with a boundary layer around a circle.
// Paper section 4.2 (Figs. 4-6, Table 2): the 12 wall edges, chords of the unit
// circle, and the 14 outer ones, chords of the circle of radius 21, are curved
// onto those circles in degree 4. Curving the mesh is the solver's work: every
// edge here is straight, and the boundary vertices already lie on the circles.
//
// Recipe: the paper gives 697 nodes, 1368 triangles, radii 1 and 21, 42 layers,
// ratio 1.3, wall size 1e-5 and tangential size 0.524 = 2 pi / 12.
//   - 12 wall vertices; layer k = 1..42 ends at the radius
//     r_k = 1 + 1e-5 (1.3^k - 1) / 0.3, so the last ring is at r = 3.0347;
//   - every quad is cut by the diagonal of the same sense: six triangles at each
//     inner vertex of the layers and a mesh that a turn by 30 degrees maps to
//     itself (the mirror image of the trapezoids makes both diagonals equal);
//   - from the ring to a 14-gon of radius 21, Delaunay with a linear size field.
// The layer points are given one by one: a transfinite progression would place
// them by numerical integration, 3e-4 off in thickness.
//
//   gmsh -nt 1 -2 -format msh22 curving.geo -o curving.msh
//
// The slope 0.3784 of the size field is tuned for gmsh 4.8.4 to give the count.
//
// Expected with gmsh 4.8.4: 697 nodes, 1368 triangles, wall 12, outer 14 edges,
// of these 43*12 = 516 nodes and 2*42*12 = 1008 triangles in the layers.

n_wall = 12;  r_wall = 1;
n_out = 14;   r_out = 21;
layers = 42;  h_wall = 1e-5;  ratio = 1.3;

// Point 1 + k*n_wall + i: layer k = 0 .. layers, direction i.
For k In {0 : layers}
  r = r_wall + h_wall*(ratio^k - 1)/(ratio - 1);
  For i In {0 : n_wall-1}
    Point(1 + k*n_wall + i) = {r*Cos(2*Pi*i/n_wall), r*Sin(2*Pi*i/n_wall), 0};
  EndFor
EndFor

// Line 1 + k*n_wall + i: radial side of layer k in direction i.
For k In {0 : layers-1}
  For i In {0 : n_wall-1}
    Line(1 + k*n_wall + i) = {1 + k*n_wall + i, 1 + (k+1)*n_wall + i};
  EndFor
EndFor

// Lines 1001 + i: wall. Lines 1101 + i: last ring. Lines 2001 + i: outer 14-gon.
ring = layers*n_wall;
For i In {0 : n_wall-1}
  Line(1001+i) = {1 + i, 1 + (i+1)%n_wall};
  Line(1101+i) = {ring + 1 + i, ring + 1 + (i+1)%n_wall};
EndFor
For i In {0 : n_out-1}
  Point(2001+i) = {r_out*Cos(2*Pi*i/n_out), r_out*Sin(2*Pi*i/n_out), 0};
EndFor
For i In {0 : n_out-1}
  Line(2001+i) = {2001+i, 2001 + (i+1)%n_out};
EndFor
Transfinite Curve{1:ring, 1001:1000+n_wall, 1101:1100+n_wall, 2001:2000+n_out} = 2;

// One structured strip per wall edge.
For i In {0 : n_wall-1}
  j = (i+1)%n_wall;
  up[] = {};  down[] = {};
  For k In {0 : layers-1}
    up[] += 1 + k*n_wall + i;
    down[] += -(1 + (layers-1-k)*n_wall + j);
  EndFor
  Curve Loop(1+i) = {up[], 1101+i, down[], -(1001+i)};
  Plane Surface(1+i) = {1+i};
  Transfinite Surface{1+i} = {1+i, 1+j, ring+1+j, ring+1+i} Left;
EndFor

Curve Loop(101) = {2001:2000+n_out};
Curve Loop(102) = {1101:1100+n_wall};
Plane Surface(101) = {101, 102};

Field[1] = MathEval;
Field[1].F = "0.5 + 0.3784*(Sqrt(x*x+y*y)-3)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 5;                             // Delaunay

Physical Curve("wall", 1) = {1001:1000+n_wall};
Physical Curve("outer", 2) = {2001:2000+n_out};
Physical Surface("domain", 3) = {1:n_wall, 101};

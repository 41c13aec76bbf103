// airfoil-quads.geo: NACA 0012 of chord 1 in a channel 4 x 2, with layers of quadrilaterals around it, the first 1e-4
// high, in triangles.
//
//   gmsh -nt 1 -2 -format msh41 airfoil-quads.geo -o airfoil-quads.msh

n = 20;  // edges on each side: the nodes are at x = (1 - cos(pi i/n))/2
For i In {0 : 2*n-1}
  x = (1 + Cos(Pi*i/n))/2;
  y = 0.6*(0.2969*Sqrt(x) - 0.1260*x - 0.3516*x^2 + 0.2843*x^3 - 0.1036*x^4);
  If (i > n)
    y = -y;
  EndIf
  Point(1+i) = {x, y, 0};
EndFor
For i In {0 : 2*n-1}
  Line(1+i) = {1+i, 1 + (i+1)%(2*n)};
EndFor
Transfinite Curve{1:2*n} = 2;

Point(101) = {-1.5, -1, 0};
Point(102) = {2.5, -1, 0};
Point(103) = {2.5, 1, 0};
Point(104) = {-1.5, 1, 0};
Line(101) = {101, 102};
Line(102) = {102, 103};
Line(103) = {103, 104};
Line(104) = {104, 101};
Curve Loop(1) = {101:104};
Curve Loop(2) = {1:2*n};
Plane Surface(1) = {1, 2};

Field[1] = BoundaryLayer;
Field[1].CurvesList = {1:2*n};
Field[1].Size = 1e-4;
Field[1].Ratio = 1.5;
Field[1].Thickness = 0.04;
Field[1].Quads = 1;
Field[1].FanPointsList = {1};
BoundaryLayer Field = 1;
Field[2] = Distance;
Field[2].CurvesList = {1:2*n};
Field[3] = MathEval;
Field[3].F = "0.05 + 0.2*F2";
Background Field = 3;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 5;  // Delaunay

Physical Curve("airfoil", 1) = {1:2*n};
Physical Curve("floor", 2) = {101};
Physical Curve("outlet", 3) = {102};
Physical Curve("ceiling", 4) = {103};
Physical Curve("inlet", 5) = {104};
Physical Surface("fluid", 6) = {1};

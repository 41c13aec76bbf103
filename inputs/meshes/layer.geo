// layer.geo: an ellipse with three layers of cells around it, a volume of its own, in a square.
//
//   gmsh -nt 1 -2 -format msh22 layer.geo -o layer.msh

n = 24;
For i In {0 : n-1}
  t = 2*Pi*i/n;
  Point(1+i) = {2*Cos(t), 0.6*Sin(t), 0, 1};
  Point(101+i) = {2.15*Cos(t), 0.75*Sin(t), 0, 1};
EndFor
For i In {0 : n-1}
  Line(1+i) = {1+i, 1 + (i+1)%n};
  Line(101+i) = {101+i, 101 + (i+1)%n};
  Line(201+i) = {1+i, 101+i};
EndFor
Transfinite Curve{1:n, 101:100+n} = 2;
Transfinite Curve{201:200+n} = 4;
For i In {0 : n-1}
  Curve Loop(1+i) = {1+i, 201 + (i+1)%n, -(101+i), -(201+i)};
  Plane Surface(1+i) = {1+i};
  Transfinite Surface(1+i);
EndFor
Point(1001) = {-6, -6, 0, 1.5};
Point(1002) = {6, -6, 0, 1.5};
Point(1003) = {6, 6, 0, 1.5};
Point(1004) = {-6, 6, 0, 1.5};
Line(1001) = {1001, 1002};
Line(1002) = {1002, 1003};
Line(1003) = {1003, 1004};
Line(1004) = {1004, 1001};
Curve Loop(1001) = {1001, 1002, 1003, 1004};
Curve Loop(1002) = {101:100+n};
Plane Surface(1001) = {1001, 1002};
Physical Curve("body", 1) = {1:n};
Physical Curve("far", 2) = {1001:1004};
Physical Surface("layer", 3) = {1:n};
Physical Surface("fluid", 4) = {1001};

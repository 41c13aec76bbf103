// sphere-layers.geo: tetrahedra in layers around the unit sphere, in a sphere of
// radius 10, straight-sided. For curving both boundaries onto their spheres.
//
//   gmsh -nt 1 -3 -format msh22 sphere-layers.geo -o sphere-layers.msh
//
// The first layer is 3e-4 high and the wall's edges are 0.34 to 0.74 long: more than
// 1 : 1000 everywhere. The wall is moved by up to 0.066, the distance of its flat faces
// from the sphere: 220 first layers, more than the lower eleven together.
//
// Other layers by -setnumber first 1e-4 -setnumber layers 18, a finer or coarser
// wall by -setnumber edges 6: edges on a quarter of a great circle. Layers of prisms by
// -setnumber prisms 1: sphere-prisms.msh.
//
// Expected with gmsh 4.8.4: 1146 nodes, 6344 tetrahedra, wall 118, farfield 100 faces.

SetFactory("Built-in");
DefineConstant[ first = 3e-4, ratio = 1.5, layers = 15, edges = 3, far = 6, prisms = 0 ];
r = 1;  R = 10;

Point(1) = {0, 0, 0};
Point(2) = {r, 0, 0};  Point(3) = {0, r, 0};  Point(4) = {-r, 0, 0};
Point(5) = {0, -r, 0}; Point(6) = {0, 0, r};  Point(7) = {0, 0, -r};
For i In {0 : 3}
  j = (i+1)%4;
  Circle(1+i) = {2+i, 1, 2+j};
  Circle(5+i) = {2+i, 1, 6};
  Circle(9+i) = {2+i, 1, 7};
EndFor
For i In {0 : 3}
  j = (i+1)%4;
  Curve Loop(1+i) = {1+i, 5+j, -(5+i)};
  Surface(1+i) = {1+i};
  Curve Loop(5+i) = {9+i, -(9+j), -(1+i)};
  Surface(5+i) = {5+i};
EndFor
Transfinite Curve{1:12} = edges + 1;

// Far field.
Point(102) = {R, 0, 0};  Point(103) = {0, R, 0};  Point(104) = {-R, 0, 0};
Point(105) = {0, -R, 0}; Point(106) = {0, 0, R};  Point(107) = {0, 0, -R};
For i In {0 : 3}
  j = (i+1)%4;
  Circle(101+i) = {102+i, 1, 102+j};
  Circle(105+i) = {102+i, 1, 106};
  Circle(109+i) = {102+i, 1, 107};
EndFor
For i In {0 : 3}
  j = (i+1)%4;
  Curve Loop(101+i) = {101+i, 105+j, -(105+i)};
  Surface(101+i) = {101+i};
  Curve Loop(105+i) = {109+i, -(109+j), -(101+i)};
  Surface(105+i) = {105+i};
EndFor

n[] = {};  d[] = {};
For k In {1 : layers}
  n[] += 1;
  d[] += first*(ratio^k - 1)/(ratio - 1);
EndFor
If (prisms)
  e[] = Extrude{ Surface{1:8}; Layers{ n[], d[] }; Recombine; Using Index[0]; };
Else
  e[] = Extrude{ Surface{1:8}; Layers{ n[], d[] }; Using Index[0]; };
EndIf
top[] = {};  cells[] = {};
For i In {0 : 7}
  top[] += e[5*i];
  cells[] += e[5*i + 1];
EndFor
Surface Loop(1) = {101:108};
Surface Loop(2) = {top[]};
Volume(1001) = {1, 2};

Field[1] = MathEval;
Field[1].F = Sprintf("0.52 + %g*(Sqrt(x*x+y*y+z*z)-1)", (far - 0.52)/(R - 1));
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 6;                             // frontal Delaunay on the spheres
Mesh.Algorithm3D = 1;                           // Delaunay
Mesh.Optimize = 1;

Physical Surface("wall", 1) = {1:8};
Physical Surface("farfield", 2) = {101:108};
Physical Volume("domain", 3) = {cells[], 1001};

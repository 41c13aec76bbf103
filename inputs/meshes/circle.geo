// circle.geo: annulus between a 32-gon of radius 1 and an 8-gon of radius 21.
// Paper section 4.1 (Figs. 1-3, Tables 1 and 2): the inner circle is moved by
// 8 units in a mesh of non-uniform size.
//
// Recipe: the paper gives 841 nodes, 1642 triangles, radii 1 and 21. With
// V - E + F = 0 on the annulus, 2*841 - 1642 = 40 boundary edges: 32 inner
// ones (2 pi / 0.2) and 8 outer ones (2 pi 21 / 16.5). One mesh edge per
// polygon side, Delaunay, and a size that grows linearly with the radius.
//
//   gmsh -nt 1 -2 -format msh22 circle.geo -o circle.msh
//
// Expected with gmsh 4.8.4: 841 nodes, 1642 triangles, inner 32, outer 8 edges.
// Another gmsh version may give other counts: the slope 0.14505 of the size
// field was tuned for this one.

n_in = 32;  r_in = 1;
n_out = 8;  r_out = 21;

For i In {0 : n_in-1}
  Point(1+i) = {r_in*Cos(2*Pi*i/n_in), r_in*Sin(2*Pi*i/n_in), 0};
EndFor
For i In {0 : n_in-1}
  Line(1+i) = {1+i, 1 + (i+1)%n_in};
EndFor

For i In {0 : n_out-1}
  Point(101+i) = {r_out*Cos(2*Pi*i/n_out), r_out*Sin(2*Pi*i/n_out), 0};
EndFor
For i In {0 : n_out-1}
  Line(101+i) = {101+i, 101 + (i+1)%n_out};
EndFor

Transfinite Curve{1:n_in, 101:100+n_out} = 2;   // two nodes: one edge per side

Curve Loop(1) = {101:100+n_out};
Curve Loop(2) = {1:n_in};
Plane Surface(1) = {1, 2};

Field[1] = MathEval;
Field[1].F = "0.2 + 0.14505*(Sqrt(x*x+y*y)-1)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 5;                             // Delaunay

Physical Curve("inner", 1) = {1:n_in};
Physical Curve("outer", 2) = {101:100+n_out};
Physical Surface("domain", 3) = {1};

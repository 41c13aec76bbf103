// bump.geo: a strip whose lower wall is a B-spline, 1 long and 0.24 high, in degree 3.
// The floor of square.msh slides along it.
//
//   gmsh -nt 1 -2 -order 3 -format msh41 bump.geo -o bump.msh
//
// Expected with gmsh 4.8.4: 91 nodes, 16 triangles; wall 4, sides 8 edges.

Point(1) = {0, 0, 0};
Point(2) = {0.3, 0, 0};
Point(3) = {0.4, 0.3, 0};
Point(4) = {0.7, 0.2, 0};
Point(5) = {0.8, 0, 0};
Point(6) = {1, 0, 0};
Point(7) = {1, 0.5, 0};
Point(8) = {0, 0.5, 0};
BSpline(1) = {1, 2, 3, 4, 5, 6};
Line(2) = {6, 7};
Line(3) = {7, 8};
Line(4) = {8, 1};
Transfinite Curve{1, 3} = 5;
Transfinite Curve{2, 4} = 3;
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Transfinite Surface{1} = {1, 6, 7, 8};

Physical Curve("wall", 1) = {1};
Physical Curve("sides", 2) = {2:4};
Physical Surface("domain", 3) = {1};

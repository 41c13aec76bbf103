// square.geo: the unit square, four named sides. For lessons and tests.
//
//   gmsh -nt 1 -2 -format msh41 square.geo -o square.msh
//
// Expected with gmsh 4.8.4: 65 nodes, 104 triangles, 6 edges on each side.

n = 6;                                          // edges per side
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {1, 1, 0};
Point(4) = {0, 1, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve{1:4} = n + 1;
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};

Mesh.Algorithm = 5;                             // Delaunay

Physical Curve("bottom", 1) = {1};
Physical Curve("right", 2) = {2};
Physical Curve("top", 3) = {3};
Physical Curve("left", 4) = {4};
Physical Surface("domain", 5) = {1};

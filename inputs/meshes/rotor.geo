// rotor.geo: hexahedra between a bar 1.6 x 0.3 x 1, the rotor, and a casing, a cylinder of radius 2.
//
//   gmsh -nt 1 -3 -format msh41 rotor.geo -o rotor.msh
//
// Expected with gmsh 4.8.4: 1168 nodes, 780 hexahedra.

SetFactory("Built-in");
R = 2;  a = 0.8;  b = 0.15;
Point(1) = {0, 0, 0};
Point(2) = {R, 0, 0};  Point(3) = {0, R, 0};  Point(4) = {-R, 0, 0};  Point(5) = {0, -R, 0};
Circle(1) = {2, 1, 3};  Circle(2) = {3, 1, 4};  Circle(3) = {4, 1, 5};  Circle(4) = {5, 1, 2};
Point(6) = {a, b, 0};  Point(7) = {-a, b, 0};  Point(8) = {-a, -b, 0};  Point(9) = {a, -b, 0};
Line(5) = {6, 7};  Line(6) = {7, 8};  Line(7) = {8, 9};  Line(8) = {9, 6};
Transfinite Curve{1:4} = 11;
Transfinite Curve{5, 7} = 11;
Transfinite Curve{6, 8} = 3;
Curve Loop(1) = {1:4};
Curve Loop(2) = {5:8};
Plane Surface(1) = {1, 2};
Recombine Surface{1};
Mesh.MeshSizeExtendFromBoundary = 1;
e[] = Extrude{0, 0, 1}{ Surface{1}; Layers{3}; Recombine; };

Physical Surface("floor", 1) = {1};
Physical Surface("ceiling", 2) = {e[0]};
Physical Surface("casing", 3) = {e[2], e[3], e[4], e[5]};
Physical Surface("rotor", 4) = {e[6], e[7], e[8], e[9]};
Physical Volume("fluid", 5) = {e[1]};

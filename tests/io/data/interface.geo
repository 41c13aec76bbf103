// Two curved triangles with a point, an interface between them and the centre of an arc, for tests of MSH files.
//   gmsh -nt 1 -2 -order 2 -format msh22 -bin interface.geo -o interface-22.msh     (40 without -bin, 41)
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0}; Point(5) = {0.5, 0.5, 0};
Line(1) = {1, 2}; Circle(2) = {2, 5, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Line(5) = {1, 3};
Curve Loop(1) = {1, 2, -5}; Curve Loop(2) = {5, 3, 4};
Plane Surface(1) = {1}; Plane Surface(2) = {2};
Physical Point("corner", 9) = {1}; Physical Point("centre", 8) = {5};
Physical Curve("wall", 1) = {1, 2, 3}; Physical Curve("inlet", 2) = {4}; Physical Curve("interface", 3) = {5};
Physical Surface("lower", 11) = {1}; Physical Surface("upper", 12) = {2};
Transfinite Curve {1, 2, 3, 4, 5} = 2;

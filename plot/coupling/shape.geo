// A circle of radius 1 in a box 20 x 20, for shape.py (gmsh 4.8).
edges = 32; // of a quarter of the circle
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0}; Point(3) = {0, 1, 0}; Point(4) = {-1, 0, 0}; Point(5) = {0, -1, 0};
Point(6) = {10, -10, 0}; Point(7) = {10, 10, 0}; Point(8) = {-10, 10, 0}; Point(9) = {-10, -10, 0};
For i In {0 : 3}
  Circle(1 + i) = {2 + i, 1, 2 + (i + 1) % 4};
  Line(5 + i) = {6 + i, 6 + (i + 1) % 4};
EndFor
Curve Loop(1) = {1 : 4};
Curve Loop(2) = {5 : 8};
Plane Surface(1) = {2, 1};
Transfinite Curve {1 : 4} = edges + 1;
Physical Curve("body", 1) = {1 : 4};
Physical Curve("box", 2) = {5 : 8};
Physical Surface("fluid", 1) = {1};
Mesh.MeshSizeMax = 2;
Mesh.MshFileVersion = 2.2;

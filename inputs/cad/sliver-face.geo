// sliver-face.geo: a cylinder that sticks out of a box by a five-hundredth of its radius, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 3 -bin -format msh41 sliver-face.geo -o sliver-face.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.5 ];
Box(1) = {-1.5, -1, 0, 3, 1.998, 1};
Cylinder(2) = {0, 0, -0.5, 0, 0, 2, 1};
v() = BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("solid") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h / 4; Mesh.MeshSizeMax = h;

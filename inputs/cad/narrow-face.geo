// narrow-face.geo: a disc on a wider one, whose ring between them is narrower than an element, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 2 -bin -format msh41 narrow-face.geo -o narrow-face.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.5 ];
Cylinder(1) = {0, 0, 0, 0, 0, 1, 1};
Cylinder(2) = {0, 0, 1, 0, 0, 1, 0.97};
v() = BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("solid") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h / 4; Mesh.MeshSizeMax = h;

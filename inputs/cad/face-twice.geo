// face-twice.geo: a thin rod in a block, with tetrahedra that have two faces on it, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 3 -bin -format msh41 face-twice.geo -o face-twice.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.35 ];
Box(1) = {-1, -1, -1, 2, 2, 1};
Cylinder(2) = {0, 0, -0.5, 0, 0, 3, 0.25};
v() = BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("solid") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

// cone-apex.geo: a box with a cone cut out, with its apex, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 3 -bin -format msh41 cone-apex.geo -o cone-apex.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.4 ];
Box(1) = {0.5, -0.8, -0.8, 1.6, 1.6, 1.6};
Cone(3) = {1.3, 0, -0.5, 0, 0, 1, 0.5, 0};
v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{3}; Delete; };
Physical Volume("solid") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h / 3; Mesh.MeshSizeMax = h;

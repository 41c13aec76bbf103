// tangent-faces.geo: a box with fillets, which meet its planes and each other without an edge, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 3 -bin -format msh41 tangent-faces.geo -o tangent-faces.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.5 ];
Box(1) = {0, 0, 0, 2, 1, 1};
v() = Fillet{1}{1:12}{0.3};
Physical Volume("solid") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

// concave-edge.geo: a box with two spherical hollows that meet in a sharp edge, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 2 -bin -format msh41 concave-edge.geo -o concave-edge.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.5 ];
Box(1) = {-1.5, -1.5, 0, 5, 3, 1};
Sphere(2) = {0, 0, 1, 1};
Sphere(3) = {1.9, 0, 1, 1};
v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Physical Volume("solid") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h / 4; Mesh.MeshSizeMax = h;

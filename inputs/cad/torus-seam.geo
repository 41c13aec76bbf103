// torus-seam.geo: a box with a torus cut out, with its seams, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 3 -bin -format msh41 torus-seam.geo -o torus-seam.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.4 ];
Box(1) = {-0.8, -0.8, -0.5, 1.6, 1.6, 1};
Torus(4) = {0, 0, 0, 0.4, 0.15};
v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{4}; Delete; };
Physical Volume("solid") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h / 3; Mesh.MeshSizeMax = h;

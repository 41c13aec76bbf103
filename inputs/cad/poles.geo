// poles.geo: a box with a sphere, a cone and a torus cut out, with their poles, apex and seams, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 2 -bin -format msh41 poles.geo -o poles.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.4 ];
Box(1) = {-2, -1, -1, 4, 2, 2};
Sphere(2) = {-1.3, 0, 0, 0.4};
Cone(3) = {1.3, 0, -0.5, 0, 0, 1, 0.5, 0};
Torus(4) = {0, 0, 0, 0.4, 0.15};
v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2, 3, 4}; Delete; };
Physical Volume("solid") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h / 3; Mesh.MeshSizeMax = h;

// sphere-pole.geo: a box with half a sphere on it, seven elements around, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 3 -bin -format msh41 sphere-pole.geo -o sphere-pole.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.4 ];
Box(1) = {-0.8, -0.8, 0, 1.6, 1.6, 0.8};
Sphere(2) = {0, 0, 0.8, 0.2};
v() = BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("solid") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

// ellipsoid.geo: a thin ellipsoid in a sphere, by OpenCASCADE, too coarse for its rim.
//
//   gmsh -nt 1 -3 -order 2 -bin -format msh41 ellipsoid.geo -o ellipsoid.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.4 ];
Sphere(1) = {0, 0, 0, 2};
Sphere(2) = {0, 0, 0, 1};
Dilate{ {0, 0, 0}, {1, 0.6, 0.25} }{ Volume{2}; }
v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("domain") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

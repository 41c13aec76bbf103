// torus-in-sphere.geo: a torus in a sphere, the space between them, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 2 -bin -format msh41 torus-in-sphere.geo -o torus-in-sphere.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.5 ];
Sphere(1) = {0, 0, 0, 3};
Torus(2) = {0, 0, 0, 1, 0.35};
v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; };
t() = Surface In BoundingBox{-1.5, -1.5, -0.5, 1.5, 1.5, 0.5};
all() = Surface{:};
all() -= t();
Physical Surface("torus") = {t()};
Physical Surface("sphere") = {all()};
Physical Volume("domain") = {v()};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

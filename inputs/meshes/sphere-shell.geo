// sphere-shell.geo: tetrahedra between concentric spheres of radius 1 and 3,
// straight-sided. For curving both boundaries onto their spheres.
//
//   gmsh -nt 1 -3 -format msh41 sphere-shell.geo -o sphere-shell.msh
//
// Expected with gmsh 4.8.4: 238 nodes, 922 tetrahedra, inner 122, outer 210 faces.

SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 3};
Sphere(2) = {0, 0, 0, 1};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };

Field[1] = MathEval;
Field[1].F = "0.52 + 0.35*(Sqrt(x*x+y*y+z*z)-1)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 6;                             // frontal Delaunay on the spheres
Mesh.Algorithm3D = 1;                           // Delaunay
Mesh.Optimize = 1;

e = 1.1;
inner() = Surface In BoundingBox{-e, -e, -e, e, e, e};
outer() = Surface{:};
outer() -= inner();
Physical Surface("inner", 1) = {inner()};
Physical Surface("outer", 2) = {outer()};
Physical Volume("domain", 3) = {3};

// cube.geo: the unit cube, six named sides. For lessons and tests.
//
//   gmsh -nt 1 -3 -format msh41 cube.geo -o cube.msh
//
// Expected with gmsh 4.8.4: 133 nodes, 378 tetrahedra, 40 faces on each side.

SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};

n = 4;                                          // edges per side
Transfinite Curve{:} = n + 1;
Mesh.MeshSizeMax = 1/n;
Mesh.Algorithm = 5;                             // Delaunay on the sides
Mesh.Algorithm3D = 1;                           // Delaunay
Mesh.Optimize = 1;

e = 1e-3;
Physical Surface("left", 1) = Surface In BoundingBox{-e, -e, -e, e, 1+e, 1+e};
Physical Surface("right", 2) = Surface In BoundingBox{1-e, -e, -e, 1+e, 1+e, 1+e};
Physical Surface("front", 3) = Surface In BoundingBox{-e, -e, -e, 1+e, e, 1+e};
Physical Surface("back", 4) = Surface In BoundingBox{-e, 1-e, -e, 1+e, 1+e, 1+e};
Physical Surface("bottom", 5) = Surface In BoundingBox{-e, -e, -e, 1+e, 1+e, e};
Physical Surface("top", 6) = Surface In BoundingBox{-e, -e, 1-e, 1+e, 1+e, 1+e};
Physical Volume("domain", 7) = {1};

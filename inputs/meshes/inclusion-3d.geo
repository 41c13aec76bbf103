// inclusion-3d.geo: a box 1.4 x 1.4 x 0.8 inside a cube of edge 4, two materials with a named surface between them.
//
//   gmsh -nt 1 -3 -format msh22 inclusion-3d.geo -o inclusion-3d.msh

SetFactory("OpenCASCADE");
Box(1) = {-2, -2, -2, 4, 4, 4};
Box(2) = {-0.7, -0.7, -0.4, 1.4, 1.4, 0.8};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
interface() = Boundary{ Volume{2}; };
all() = Boundary{ Volume{3}; };
all() -= {interface()};
Physical Surface("interface", 1) = {interface()};
Physical Surface("far", 2) = {all()};
Physical Volume("solid", 3) = {2};
Physical Volume("fluid", 4) = {3};
Mesh.MeshSizeMin = 0.8;
Mesh.MeshSizeMax = 0.8;

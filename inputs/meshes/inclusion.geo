// inclusion.geo: an ellipse of semi-axes 1.5 and 1 inside a disc of radius 4, two materials with a named curve between
// them: `interface` is inside the mesh.
//
//   gmsh -nt 1 -2 -format msh41 inclusion.geo -o inclusion.msh

SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, 4};
Disk(2) = {0, 0, 0, 1.5, 1};
BooleanFragments{ Surface{1}; Delete; }{ Surface{2}; Delete; }
Physical Curve("interface", 1) = Boundary{ Surface{2}; };
Physical Curve("far", 2) = {1};
Physical Surface("solid", 3) = {2};
Physical Surface("fluid", 4) = {3};
Mesh.MeshSizeMin = 0.5;
Mesh.MeshSizeMax = 0.5;

// piston.geo: a cylinder of radius 1 and height 2 between a head and a piston, tetrahedra.
//
//   gmsh -nt 1 -3 -format msh22 piston.geo -o piston.msh
//
// Expected with gmsh 4.8.4: 366 nodes, 1291 tetrahedra.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 2, 1};
Physical Surface("wall") = {1};
Physical Surface("head") = {2};
Physical Surface("piston") = {3};
Physical Volume("gas") = {1};
Mesh.MeshSizeMin = 0.3;
Mesh.MeshSizeMax = 0.3;

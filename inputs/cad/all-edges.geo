// all-edges.geo: a ring so thin that tetrahedra have all their nodes and edges on its surface, by OpenCASCADE.
//
//   gmsh -nt 1 -3 -order 2 -bin -format msh41 all-edges.geo -o all-edges.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.3 ];
Torus(1) = {0, 0, 0, 1, 0.12};
Physical Volume("solid") = {1};
b() = Boundary{ Volume{1}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

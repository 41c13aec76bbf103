// torus.geo: a solid torus by OpenCASCADE. Tetrahedra with two faces on it are folded in any degree.
//
//   gmsh -nt 1 -3 -order 2 -bin -format msh41 torus.geo -o torus.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.35 ];
Torus(1) = {0, 0, 0, 1, 0.35};
s() = Surface{:};
Physical Surface("torus") = {s()};
Physical Volume("solid") = {1};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

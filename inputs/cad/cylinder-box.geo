// cylinder-box.geo: a box around a cylinder from end to end, by OpenCASCADE, curved by gmsh in degree 3.
//
//   gmsh -nt 1 -3 -order 3 -format msh41 cylinder-box.geo -o cylinder-box.msh
//
// Expected with gmsh 4.8.4: 8533 nodes, 1504 tetrahedra.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.5 ];
Box(1) = {-2, -2, 0, 4, 4, 2};
Cylinder(2) = {0, 0, 0, 0, 0, 2, 0.5};
v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("domain") = {v()};
c() = Surface In BoundingBox{-0.6, -0.6, -0.1, 0.6, 0.6, 2.1};
all() = Surface{:};
all() -= c();
Physical Surface("cylinder") = {c()};
Physical Surface("box") = {all()};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

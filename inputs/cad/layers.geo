// layers.geo: layers of tetrahedra around a cylinder, extruded from a plane, by OpenCASCADE. The thin
// triangles of the end planes are folded by the arcs that gmsh curves them to.
//
//   gmsh -nt 1 -3 -order 3 -bin -format msh41 layers.geo -o layers.msh
//
// Made with gmsh 4.8.4.

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.5 ];
Rectangle(1) = {-2, -2, 0, 4, 4};
Disk(2) = {0, 0, 0, 0.5};
s() = BooleanDifference{ Surface{1}; Delete; }{ Surface{2}; Delete; };
c() = Curve In BoundingBox{-0.6, -0.6, -0.1, 0.6, 0.6, 0.1};
Field[1] = BoundaryLayer;
Field[1].CurvesList = {c()};
Field[1].Size = h / 50;
Field[1].Ratio = 2;
Field[1].Thickness = h / 3;
Field[1].Quads = 0;
BoundaryLayer Field = 1;
e() = Extrude{0, 0, 1}{ Surface{s()}; Layers{Ceil(1 / h)}; };
Physical Volume("domain") = {e(1)};
w() = Surface In BoundingBox{-0.6, -0.6, -0.1, 0.6, 0.6, 1.1};
all() = Surface{:};
all() -= w();
Physical Surface("cylinder") = {w()};
Physical Surface("box") = {all()};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.35 ];
Torus(1) = {0, 0, 0, 1, 0.35};
s() = Surface{:};
Physical Surface("torus") = {s()};
Physical Volume("solid") = {1};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

SetFactory("OpenCASCADE");
DefineConstant[ h = 0.4 ];
Sphere(1) = {0, 0, 0, 2};
Sphere(2) = {0, 0, 0, 1};
Dilate{ {0, 0, 0}, {1, 0.6, 0.25} }{ Volume{2}; }
v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("domain") = {v()};
b() = Boundary{ Volume{v()}; };
Physical Surface("all") = {b()};
Mesh.MeshSizeMin = h; Mesh.MeshSizeMax = h;

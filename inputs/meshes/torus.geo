// A torus with a hollow core: tubes of radius 1 and 0.6 around the circle of radius 2.
SetFactory("OpenCASCADE");
Torus(1) = {0,0,0, 2, 1}; Torus(2) = {0,0,0, 2, 0.6};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
s() = Abs(Boundary{ Volume{3}; });
Physical Surface("outer") = {s(0)}; Physical Surface("inner") = {s(1)}; Physical Volume("shell") = {3};
Mesh.MeshSizeMin = 0.7; Mesh.MeshSizeMax = 0.7;
Mesh.MshFileVersion = 2.2;

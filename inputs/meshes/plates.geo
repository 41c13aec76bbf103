// Two coaxial plates in a box, to be turned against each other about z.
SetFactory("OpenCASCADE");
Box(1) = {-4,-4,-4,8,8,8};
Box(2) = {-1.5,-0.3,0.4,3,0.6,0.2};
Box(3) = {-1.5,-0.3,-0.6,3,0.6,0.2};
BooleanDifference(4) = { Volume{1}; Delete; }{ Volume{2,3}; Delete; };
Physical Volume("fluid") = {4};
upper() = Surface In BoundingBox {-1.6,-0.4,0.3,1.6,0.4,0.7};
lower() = Surface In BoundingBox {-1.6,-0.4,-0.7,1.6,0.4,-0.3};
Physical Surface("upper") = upper();
Physical Surface("lower") = lower();
Physical Surface("box") = {1:6};
Field[1] = MathEval;
Field[1].F = "0.14+0.22*Sqrt(((Abs(x)-1.5+Abs(Abs(x)-1.5))/2)^2+((Abs(y)-0.3+Abs(Abs(y)-0.3))/2)^2+((Abs(z)-0.6+Abs(Abs(z)-0.6))/2)^2)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0; Mesh.MeshSizeFromCurvature = 0;
Mesh.MshFileVersion = 2.2;

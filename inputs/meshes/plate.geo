// Plate 5 x 0.2 in a box 20 x 20.
L = 2.5; H = 0.1; B = 10;
Point(1) = {-L,-H,0}; Point(2) = {L,-H,0}; Point(3) = {L,H,0}; Point(4) = {-L,H,0};
Point(5) = {-B,-B,0}; Point(6) = {B,-B,0}; Point(7) = {B,B,0}; Point(8) = {-B,B,0};
For i In {1:4}
  Line(i) = {i, i % 4 + 1};
  Line(4+i) = {4+i, 4 + i % 4 + 1};
EndFor
Curve Loop(1) = {1:4}; Curve Loop(2) = {5:8};
Plane Surface(1) = {2,1};
Physical Curve("plate") = {1:4};
Physical Curve("box") = {5:8};
Physical Surface("fluid") = {1};
Field[1] = MathEval;
Field[1].F = "0.1+0.25*Sqrt(((Abs(x)-2.5+Abs(Abs(x)-2.5))/2)^2+((Abs(y)-0.1+Abs(Abs(y)-0.1))/2)^2)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0; Mesh.MeshSizeFromCurvature = 0;
Mesh.Algorithm = 5; Mesh.MshFileVersion = 2.2;

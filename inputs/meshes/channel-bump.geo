// channel-bump.geo: channel of length 3 and height 1 whose lower wall has a
// circular bump, 1 long and 0.1 high, in degree 3. For curving with one file: the
// vertices are the straight mesh, the boundary nodes lie on the arc and are the
// target. The first layer at the lower wall is 0.008 thick and the arc departs
// from its chords by 0.006. This file has the boundary edges curved and nothing
// else, so the four elements at the bump are inverted, as gmsh warns: a solver
// that moves the inside along with the boundary mends them.
//
//   gmsh -nt 1 -2 -order 3 -format msh41 channel-bump.geo -o channel-bump.msh
//
// Expected with gmsh 4.8.4: 550 nodes, 112 triangles; bottom 4, bump 4, outlet 7,
// top 8, inlet 7 edges.

n_flat = 2;  n_bump = 4;                        // edges along the wall
layers = 7;  ratio = 2;                         // first layer 1/127 = 0.008

length = 3;  height = 1;  chord = 1;  bump = 0.1;
x1 = (length - chord)/2;
x2 = x1 + chord;
radius = (chord*chord/4 + bump*bump)/(2*bump);

Point(1) = {0, 0, 0};
Point(2) = {x1, 0, 0};
Point(3) = {x2, 0, 0};
Point(4) = {length, 0, 0};
Point(5) = {length, height, 0};
Point(6) = {x2, height, 0};
Point(7) = {x1, height, 0};
Point(8) = {0, height, 0};
Point(9) = {(x1+x2)/2, bump - radius, 0};       // centre of the arc

Line(1) = {1, 2};
Circle(2) = {2, 9, 3};
Line(3) = {3, 4};
Line(4) = {8, 7};
Line(5) = {7, 6};
Line(6) = {6, 5};
Line(7) = {1, 8};
Line(8) = {2, 7};
Line(9) = {3, 6};
Line(10) = {4, 5};
Transfinite Curve{1, 3, 4, 6} = n_flat + 1;
Transfinite Curve{2, 5} = n_bump + 1;
Transfinite Curve{7:10} = layers + 1 Using Progression ratio;
For i In {1 : 3}
  Curve Loop(i) = {i, 7+i, -(3+i), -(6+i)};
  Plane Surface(i) = {i};
EndFor
Transfinite Surface{1:3};

Physical Curve("bottom", 1) = {1, 3};
Physical Curve("bump", 2) = {2};
Physical Curve("outlet", 3) = {10};
Physical Curve("top", 4) = {4:6};
Physical Curve("inlet", 5) = {7};
Physical Surface("domain", 6) = {1:3};

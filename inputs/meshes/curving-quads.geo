// curving-quads.geo: the mesh of curving.geo with layers of quadrilaterals. The rest is of triangles.
//
//   gmsh -nt 1 -2 -format msh22 curving-quads.geo -o curving-quads.msh

Include "curving.geo";
Recombine Surface{1:n_wall};

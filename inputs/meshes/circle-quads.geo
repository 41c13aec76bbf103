// circle-quads.geo: the ring of circle.geo in quadrilaterals. Their opposite sides are not parallel.
//
//   gmsh -nt 1 -2 -format msh22 circle-quads.geo -o circle-quads.msh

Include "circle.geo";
Recombine Surface{1};

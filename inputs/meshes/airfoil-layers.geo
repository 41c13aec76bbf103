// The airfoil of airfoil.geo with a boundary layer of triangles, the first 1.3e-6 chords high.
Include "airfoil.geo";
Field[3] = BoundaryLayer;
Field[3].CurvesList = {1,2};
Field[3].Size = 1.3e-6;
Field[3].Ratio = 1.35;
Field[3].Thickness = 0.02;
Field[3].Quads = 0;
Field[3].FanPointsList = {61};
BoundaryLayer Field = 3;

#!/usr/bin/env python3
"""A grid of VTK in, a moved and certified one out, in memory: the top of a block of hexahedra and prisms turns by 90
degrees while its bottom stays and its sides are free. pyvista's grids are VTK's too. VTK reads what was written and
finds the same least scaled Jacobian of hexahedra. `make coupling`; Debian: python3-vtk9, python3-numpy."""
import clients

clients.need("python3-vtk9 python3-numpy", "vtkmodules", "numpy")

import almesh
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_HEXAHEDRON, VTK_WEDGE, vtkUnstructuredGrid
from vtkmodules.vtkFiltersVerdict import vtkMeshQuality
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

TYPES = {5: ("triangle", 3), 9: ("quadrilateral", 4), 10: ("tetrahedron", 4), 12: ("hexahedron", 8), 13: ("prism", 6),
         14: ("pyramid", 5)}  # linear cells: their nodes have the same order in VTK and here


def mesh_of(grid, dim, boundaries):
    """The mesh of a grid of linear cells. boundaries: {name: whether a face, by its nodes' positions, belongs to it}"""
    x, types = vtk_to_numpy(grid.GetPoints().GetData())[:, :dim], vtk_to_numpy(grid.GetCellTypesArray())
    start, nodes = (vtk_to_numpy(array) for array in (grid.GetCells().GetOffsetsArray(),
                                                      grid.GetCells().GetConnectivityArray()))
    cells = {TYPES[t][0]: nodes[start[:-1][types == t][:, None] + np.arange(TYPES[t][1])] for t in set(types.tolist())}
    named = {name: {} for name in boundaries}
    for part in almesh.from_arrays(x, cells).boundary.values():  # which faces there are
        for faces in part.faces:
            for name, belongs in boundaries.items():
                chosen = [face for face in faces.nodes if belongs(x[face])]
                if chosen:
                    named[name].setdefault(faces.type, []).extend(chosen)
    return almesh.from_arrays(x, cells, {name: {t: np.array(f) for t, f in of.items()} for name, of in named.items()})


def moved(grid, mesh):
    """A copy of the grid with the positions of the mesh."""
    copy, points, x = vtkUnstructuredGrid(), vtkPoints(), mesh.x
    copy.DeepCopy(grid)
    points.SetData(numpy_to_vtk(np.column_stack([x, np.zeros((len(x), 3 - mesh.dim))]), deep=True))
    copy.SetPoints(points)
    return copy


grid, points, n = vtkUnstructuredGrid(), vtkPoints(), 8
for k in range((n + 1) ** 3):
    points.InsertNextPoint(k % (n + 1) / n, k // (n + 1) % (n + 1) / n, k // (n + 1) ** 2 / n)
grid.SetPoints(points)
for i, j, k in np.ndindex(n, n, n):
    c = [i + a + (n + 1) * (j + b + (n + 1) * (k + d)) for d in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    if i < n // 2:
        grid.InsertNextCell(VTK_HEXAHEDRON, 8, c)
    else:
        for corners in ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)):
            grid.InsertNextCell(VTK_WEDGE, 6, [c[v] for v in corners])
mesh = mesh_of(grid, 3, {"bottom": lambda x: (x[:, 2] == 0).all(), "top": lambda x: (x[:, 2] == 1).all()})
mesh.boundary["bottom"].fix()
mesh.boundary["top"].rotate(90, about=(0.5, 0.5, 0), axis=(0, 0, 1))
mesh.boundary["rest"].free()
result = mesh.move()
path = clients.new_folder("grid") / "moved.vtu"
writer, reader, measure = vtkXMLUnstructuredGridWriter(), vtkXMLUnstructuredGridReader(), vtkMeshQuality()
writer.SetInputData(moved(grid, mesh))
writer.SetFileName(str(path))
writer.Write()
reader.SetFileName(str(path))
measure.SetInputConnection(reader.GetOutputPort())
measure.SetHexQualityMeasureToScaledJacobian()
measure.Update()
is_hexahedron = vtk_to_numpy(grid.GetCellTypesArray()) == VTK_HEXAHEDRON
by_vtk = vtk_to_numpy(measure.GetOutput().GetCellData().GetArray("Quality"))[is_hexahedron].min()
ours = mesh.quality()
print(f"VTK: {mesh.element_count} cells, {result.status}, certified: {'yes' if result.certified else 'no'}; least scaled "
      f"Jacobian {ours.min():.4f}, of hexahedra {ours[is_hexahedron].min():.4f}, {by_vtk:.4f} by VTK; eta up to {result.max_distortion:.3f}")

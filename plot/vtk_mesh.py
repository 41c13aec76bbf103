"""Meshes of the program's VTK files, and the points and outlines of curved simplices for drawing.

Simplices of any degree p in VTK order: of lines and triangles the vertices, the edges (01, 12, 20), then recursively
the inside. Of tetrahedra only the four vertices, first in any order, are of use here.
"""
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

import vtk_file

CELL_DIM = {3: 1, 21: 1, 68: 1, 5: 2, 22: 2, 69: 2, 10: 3, 24: 3, 71: 3}  # by VTK cell type


@dataclass
class VtkMesh:
    points: np.ndarray                              # nodes x 3
    cells: np.ndarray                               # cells x nodes of a cell, VTK order
    cell_dim: int
    point_data: dict = field(default_factory=dict)  # name: nodes, or nodes x 3
    cell_data: dict = field(default_factory=dict)   # name: cells

    @property
    def degree(self):
        """p, from the node count (p + 1)...(p + d)/d! of a cell."""
        return next(p for p in range(1, 32) if len(lattice(self.cell_dim, p)) == self.cells.shape[1])


def read_vtk(path):
    """The mesh in a file of the program (one cell type). ValueError where the file is something else."""
    vtk = vtk_file.read(path)
    points = np.array(vtk.points).reshape(-1, 3)
    cells = np.array(vtk.cells).reshape(len(vtk.types), -1)[:, 1:]
    point_data = {name: np.array(value) if len(value) == len(points) else np.array(value).reshape(-1, 3)
                  for name, value in vtk.point_data.items()}
    return VtkMesh(points, cells, CELL_DIM[vtk.types[0]], point_data,
                   {name: np.array(value) for name, value in vtk.cell_data.items()})


# ---------------------------------------------------------------------------------------------------- Lagrange cells

@lru_cache
def lattice(dim, p):
    """Barycentric multi-indices (sum p) of the nodes of a simplex, VTK order: nodes x (dim + 1). dim 3: any order."""
    if dim == 1:
        return np.array([(p - s, s) for s in (0, p, *range(1, p))])
    if dim == 2:
        return np.array([(p - u - v, u, v) for u, v in vtk_file.triangle_nodes(p)])
    return np.array([(i, j, k, p - i - j - k)
                     for i in range(p + 1) for j in range(p + 1 - i) for k in range(p + 1 - i - j)])


def shape_functions(dim, p, barycentric):
    """N_a = prod_k prod_{s < a_k} (p l_k - s)/(s + 1) at the points: points x nodes."""
    values = np.ones((len(barycentric), len(lattice(dim, p))))
    for a, index in enumerate(lattice(dim, p)):
        for k, order in enumerate(index):
            for s in range(order):
                values[:, a] *= (p * barycentric[:, k] - s) / (s + 1)
    return values


def touches(points, window, margin=0.0):
    """Whether the box of each group of points (groups x points x 2), grown by margin of its size, meets the window."""
    low, high = points.min(axis=1), points.max(axis=1)
    grow = margin * (high - low).max(axis=1, keepdims=True)
    x0, x1, y0, y1 = window
    low, high = low - grow, high + grow
    return (low[:, 0] < x1) & (high[:, 0] > x0) & (low[:, 1] < y1) & (high[:, 1] > y0)


def pieces(mesh, window, levels):
    """Parts of the triangles near the window: edges halved `levels` times, the parts outside dropped each time.

    Returns the cell of each part and its corners in the cell's barycentric coordinates (parts x 3 x 3).
    """
    # Corners of the quarters of a triangle in its own barycentric coordinates.
    quarters = 0.5 * np.array([[[2, 0, 0], [1, 1, 0], [1, 0, 1]], [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
                               [[1, 0, 1], [0, 1, 1], [0, 0, 2]], [[0, 1, 1], [1, 0, 1], [1, 1, 0]]])
    cells = touching(mesh, window)
    corners = np.tile(np.eye(3), (len(cells), 1, 1))
    for _ in range(levels):
        corners = np.einsum("qij,cjk->cqik", quarters, corners).reshape(-1, 3, 3)
        cells = np.repeat(cells, 4)
        near = touches(positions(mesh, cells, corners, mesh.points[:, :2]), window, margin=0.1)
        cells, corners = cells[near], corners[near]
    return cells, corners


def positions(mesh, cells, barycentric, nodal):
    """Nodal values (nodes x k) interpolated at barycentric points (cells x points x 3): cells x points x k."""
    count = barycentric.shape[1]
    basis = shape_functions(2, mesh.degree, barycentric.reshape(-1, 3)).reshape(-1, count, mesh.cells.shape[1])
    return np.einsum("cga,cak->cgk", basis, nodal[mesh.cells[cells]])


def refined_triangles(mesh, name, window, n, levels=0):
    """The triangles near the window split finely.

    Returns points (count x 2), the point data `name` there, triangles (count x 3). Every part of `levels` halvings
    gets n^2 triangles: in all, an edge has n 2^levels straight segments.
    """
    grid = [(i, j, n - i - j) for j in range(n + 1) for i in range(n + 1 - j)]
    at = {index[:2]: place for place, index in enumerate(grid)}
    small = [(at[i, j], at[i + 1, j], at[i, j + 1]) for i, j, rest in grid if rest >= 1]
    small += [(at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]) for i, j, rest in grid if rest >= 2]
    cells, corners = pieces(mesh, window, levels)
    barycentric = np.einsum("gk,ckj->cgj", np.array(grid) / n, corners)
    nodal = np.column_stack([mesh.points[:, :2], mesh.point_data[name]])
    sampled = positions(mesh, cells, barycentric, nodal).reshape(-1, 3)
    offsets = len(grid) * np.arange(len(cells))[:, None, None]
    return sampled[:, :2], sampled[:, 2], (np.array(small)[None] + offsets).reshape(-1, 3)


def outlines(mesh, chosen, n):
    """Boundaries of triangles as polygons, n segments per (curved) edge: triangles x 3n x 2."""
    t = np.arange(n)[:, None] / n
    corner = np.eye(3)
    barycentric = np.vstack([(1 - t) * corner[a] + t * corner[(a + 1) % 3] for a in range(3)])
    basis = shape_functions(2, mesh.degree, barycentric)
    return np.einsum("ga,cax->cgx", basis, mesh.points[mesh.cells[chosen]][..., :2])


def curves(mesh, n):
    """Line cells as polylines of n segments: cells x (n + 1) x 2."""
    t = np.linspace(0, 1, n + 1)
    basis = shape_functions(1, mesh.degree, np.column_stack([1 - t, t]))
    return np.einsum("ga,cax->cgx", basis, mesh.points[mesh.cells][..., :2])


def boundary_edges(mesh):
    """Edges of one triangle only, straight from vertex to vertex: edges x 2 x 2."""
    edges = np.concatenate([mesh.cells[:, [a, (a + 1) % 3]] for a in range(3)])
    edges, count = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    return mesh.points[edges[count == 1]][..., :2]


def touching(mesh, window):
    """Cells whose nodes' box meets the window (x0, x1, y0, y1)."""
    return np.flatnonzero(touches(mesh.points[mesh.cells][..., :2], window))


def thickness(mesh, chosen):
    """Least height of the straight triangle on the vertices of each chosen cell."""
    vertices = mesh.points[mesh.cells[chosen, :3]]
    sides = vertices - np.roll(vertices, 1, axis=1)
    doubled_area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return doubled_area / np.linalg.norm(sides, axis=2).max(axis=1)


def inner_faces(boundary):
    """Faces of the boundary that the others surround: the moved circle, the wall, the aircraft."""
    label = boundary.cell_data["boundary"]
    extent = {b: np.ptp(boundary.points[boundary.cells[label == b]].reshape(-1, 3), axis=0).max()
              for b in np.unique(label)}
    return boundary.cells[label == min(extent, key=extent.get)]

"""Cells and their Lagrange bases, derived from the vertices alone: nodes in Gmsh's order, det J, distortion.

Coordinates of nodes are whole numbers, those of a cell of degree p between 0 and p. Functions are products
of powers of 2 a - 1, 2 b - 1 and 2 c - 1, of the pyramid also of (1 - c) / 2 (Bergot, Cohen, Durufle 2010), whose
coordinates a, b in [0, 1] run across its layer at height c, and whose derivatives by a and b are divided by 1 - c.
"""
import functools
import itertools

import numpy as np


class Cell:
    def __init__(self, name, dim, vertices, edges, faces, interior, types):
        self.name, self.dim, self.vertices, self.edges, self.types = name, dim, vertices, edges, types
        self.faces = faces if dim == 3 else edges if dim == 2 else []  # outward where det J > 0
        self.interior_faces, self.interior = (faces if dim == 3 else []), interior

    def on_face(self, k):
        return {2: LINE, 3: TRIANGLE, 4: QUADRILATERAL}[len(self.faces[k])]


def plus_one(points):
    return [tuple(c + 1 for c in point) for point in points]


def inner(shift):
    """The nodes inside are those of a cell of a lower degree."""
    return lambda cell, p: plus_one(nodes(cell, p - shift)) if p >= shift else []


def inner_prism(_, p):
    return plus_one(t + s for t in nodes(TRIANGLE, p - 3) for s in nodes(LINE, p - 2)) if p >= 3 else []


LINE = Cell("line", 1, [(0,), (1,)], [(0, 1)], [], lambda cell, p: [], [1, 8, 26, 27, 28, 62, 63])
TRIANGLE = Cell("triangle", 2, [(0, 0), (1, 0), (0, 1)], [(0, 1), (1, 2), (2, 0)], [], inner(3),
                [2, 9, 21, 23, 25, 42, 43])
QUADRILATERAL = Cell("quadrilateral", 2, [(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1), (1, 2), (2, 3), (3, 0)], [],
                     inner(2), [3, 10, 36, 37, 38, 47, 48])
TETRAHEDRON = Cell("tetrahedron", 3, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
                   [(0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (3, 1, 2)],
                   inner(4), [4, 11, 29, 30, 31, 71, 72])
HEXAHEDRON = Cell("hexahedron", 3, [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0),
                                    (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
                  [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)],
                  [(0, 3, 2, 1), (0, 1, 5, 4), (0, 4, 7, 3), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7)],
                  inner(2), [5, 12, 92, 93, 94, 95, 96])
PRISM = Cell("prism", 3, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
             [(0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)],
             [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (0, 3, 5, 2), (1, 2, 5, 4)], inner_prism,
             [6, 13, 90, 91, 106, 107, 108])
PYRAMID = Cell("pyramid", 3, [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1)],
               [(0, 1), (0, 3), (0, 4), (1, 2), (1, 4), (2, 3), (2, 4), (3, 4)],
               [(0, 1, 4), (3, 0, 4), (1, 2, 4), (2, 3, 4), (0, 3, 2, 1)], inner(3),
               [7, 14, 118, 119, 120, 121, 122])
CELLS = [LINE, TRIANGLE, QUADRILATERAL, TETRAHEDRON, HEXAHEDRON, PRISM, PYRAMID]
OF_TYPE = {kind: (cell, p) for cell in CELLS for p, kind in enumerate(cell.types, 1)}


def between(p, corners, weights):
    """first + sum of weight / p times the way from the first to another: whole numbers."""
    first = np.array(corners[0])
    return tuple(int(c) for c in first + sum(w * (np.array(v) - first) // p for v, w in zip(corners[1:], weights)))


@functools.lru_cache(None)
def nodes(cell, p):
    """Vertices, edges, inside of faces, inside of the cell: Gmsh's order in every degree."""
    if p == 0:
        return [(0,) * cell.dim]
    corner = [tuple(p * c for c in v) for v in cell.vertices]
    found = list(corner)
    for a, b in cell.edges:
        found += [between(p, [corner[a], corner[b]], [s]) for s in range(1, p)]
    for face in cell.interior_faces:
        of = TRIANGLE if len(face) == 3 else QUADRILATERAL
        found += [between(p, [corner[face[0]], corner[face[1]], corner[face[-1]]], uv) for uv in of.interior(of, p)]
    return found + cell.interior(cell, p)


def reference(cell, p):
    """Reference coordinates of the nodes."""
    at = np.array(nodes(cell, p), float)
    if cell is PYRAMID:
        at[:, :2] /= np.maximum(p - at[:, 2:], 1)
        return at / [1, 1, p]
    return at / max(p, 1)


@functools.lru_cache(None)
def face_nodes(cell, k, p):
    """Local numbers of the nodes of a face, in the order of the face's own nodes."""
    at = {node: number for number, node in enumerate(nodes(cell, p))}
    corner = [tuple(p * c for c in cell.vertices[v]) for v in cell.faces[k]]
    return np.array([at[between(p, [corner[0], corner[1], corner[-1]], uv)] for uv in nodes(cell.on_face(k), p)])


def powers(cell, p):
    of = itertools.product(range(p + 1), repeat=cell.dim)
    if cell is PYRAMID:
        return np.array([(i, j, k, max(i, j)) for i, j, k in of if max(i, j) + k <= p])
    simplex = {LINE: 1, TRIANGLE: 2, TETRAHEDRON: 3, PRISM: 2}.get(cell, 1)
    return np.array([(*e, *[0] * (4 - cell.dim)) for e in of if sum(e[:simplex]) <= p])


def functions(cell, p, points, by=None):
    """Of all products at the points; `by`: their derivatives by this coordinate."""
    x = np.zeros((len(points), 4))
    x[:, :cell.dim], e = 2 * points - 1, powers(cell, p)
    x[:, 3] = (1 - x[:, 2]) / 4

    def product(lower=(), factor=1):
        less = e.copy()
        for k in lower:
            factor = factor * less[:, k]
            less[:, k] -= 1
        return factor * np.prod(x[:, None] ** np.maximum(less, 0), axis=2)
    if by is None:
        return product()
    if cell is PYRAMID and by < 2:  # over 1 - c = 2 x_3
        m = e[:, 3]
        return product([by, 3]) / np.maximum(m, 1)
    return product([by], 2) - (product([3], 0.5) if cell is PYRAMID else 0)


@functools.lru_cache(None)
def coefficients(cell, p):
    return np.linalg.inv(functions(cell, p, reference(cell, p)))


def values(cell, p, points):
    return functions(cell, p, points) @ coefficients(cell, p)  # point x node


def gradients(cell, p, points):
    return np.stack([functions(cell, p, points, by) for by in range(cell.dim)], axis=1) @ coefficients(cell, p)


def lattice(cell, n):
    """Points all over the cell, its corners among them; of the pyramid all but the apex."""
    ticks = np.arange(n + 1) / n
    simplex = {TRIANGLE: 2, TETRAHEDRON: 3, PRISM: 2}.get(cell, 1)
    points = np.array([e for e in itertools.product(ticks, repeat=cell.dim) if sum(e[:simplex]) < 1 + 1e-9])
    return points * [1, 1, 0.999] if cell is PYRAMID else points


@functools.lru_cache(None)
def gauss(cell, n):
    """Points and weights; collapsed in simplices, and with the weight (1 - c)^2 in the pyramid."""
    t, w = np.polynomial.legendre.leggauss(n)
    t, w = (1 + t) / 2, w / 2
    points = np.array(list(itertools.product(t, repeat=cell.dim)))
    weights = np.prod(list(itertools.product(w, repeat=cell.dim)), axis=1)
    collapsed = {TRIANGLE: [(1, 0)], PRISM: [(1, 0)], TETRAHEDRON: [(1, 0), (2, 0), (2, 1)]}.get(cell, [])
    for to, from_ in collapsed:
        weights = weights * (1 - points[:, from_])
    square = points.copy()
    for to in {to for to, _ in collapsed}:
        for before in range(to):
            points[:, to] *= 1 - square[:, before]
    return points, weights * (1 - points[:, 2]) ** 2 if cell is PYRAMID else weights


def jacobians(cell, p, x, points):
    """x: element x node x dim. Element x point x derivative x coordinate: the transpose of J."""
    slopes = gradients(cell, p, points)
    return (slopes.reshape(-1, slopes.shape[2]) @ x).reshape(len(x), len(points), cell.dim, -1)


def det(J):
    if J.shape[-1] == 2:
        return J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
    a, b, c = J[..., 0, :], J[..., 1, :], J[..., 2, :]
    return (a[..., 0] * (b[..., 1] * c[..., 2] - b[..., 2] * c[..., 1])
            + a[..., 1] * (b[..., 2] * c[..., 0] - b[..., 0] * c[..., 2])
            + a[..., 2] * (b[..., 0] * c[..., 1] - b[..., 1] * c[..., 0]))

"""Meshes as arrays: gmsh's MSH 2.2 and 4.1 read as text (all else by meshio), 2.2 written, boundary nodes, and the
scaled Jacobian of every cell. numpy.

The scaled Jacobian of a cell is the least, over its corners, of the determinant of the edges there over the product of
their lengths, divided by that of the regular cell: 1 for a regular cell, not above 0 for an inverted one. The apex of a
pyramid has four corners, each of three edges side by side. In a curved triangle or tetrahedron it is the least over a
grid of points of the same with the edges J e of the straight element for the Jacobian matrix J at the point.
"""
import collections
import contextlib
import io
import itertools
from pathlib import Path

import numpy as np

GRID = 6  # points along the edge of a curved element


class Type:
    """A cell of gmsh: its number there, dimension, vertices, faces, and corners: a vertex and the ends of its edges."""

    def __init__(self, number, dim, vertices, corners, faces, regular=1.0, degree=1):
        self.number, self.dim, self.vertices, self.corners, self.faces = number, dim, vertices, corners, faces
        self.regular, self.degree = regular, degree  # regular: determinant over lengths of the regular cell
        self.nodes = vertices if degree == 1 else vertices * (vertices + 1) // 2


TRI = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
TET = [(0, 1, 2, 3), (1, 0, 3, 2), (2, 0, 1, 3), (3, 0, 2, 1)]
TET_FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
SIN60, TET_REGULAR = 0.75 ** 0.5, 0.5 ** 0.5
TYPES = {t.number: t for t in (
    Type(15, 0, 1, [], []), Type(1, 1, 2, [], []), Type(8, 1, 3, [], []),
    Type(2, 2, 3, TRI, [(0, 1), (1, 2), (2, 0)], SIN60),
    Type(9, 2, 3, TRI, [(0, 1), (1, 2), (2, 0)], SIN60, 2),
    Type(3, 2, 4, [(i, (i + 1) % 4, (i + 3) % 4) for i in range(4)], [(i, (i + 1) % 4) for i in range(4)]),
    Type(4, 3, 4, TET, TET_FACES, TET_REGULAR),
    Type(11, 3, 4, TET, TET_FACES, TET_REGULAR, 2),
    Type(5, 3, 8, [(0, 1, 3, 4), (1, 2, 0, 5), (2, 3, 1, 6), (3, 0, 2, 7),
                   (4, 7, 5, 0), (5, 4, 6, 1), (6, 5, 7, 2), (7, 6, 4, 3)],
         [(0, 3, 2, 1), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)]),
    Type(6, 3, 6, [(0, 1, 2, 3), (1, 2, 0, 4), (2, 0, 1, 5), (3, 5, 4, 0), (4, 3, 5, 1), (5, 4, 3, 2)],
         [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)], SIN60),
    Type(7, 3, 5, [(0, 1, 3, 4), (1, 2, 0, 4), (2, 3, 1, 4), (3, 0, 2, 4),
                   (4, 0, 2, 1), (4, 1, 3, 2), (4, 2, 0, 3), (4, 3, 1, 0)],
         [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)], TET_REGULAR))}
# The order of the nodes of the same cell, seen in a mirror.
MIRRORED = {2: [0, 2, 1], 9: [0, 2, 1, 5, 4, 3], 3: [0, 3, 2, 1], 4: [0, 2, 1, 3], 11: [0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
            5: [0, 3, 2, 1, 4, 7, 6, 5], 6: [0, 2, 1, 3, 5, 4], 7: [0, 3, 2, 1, 4]}
MESHIO = {"vertex": 15, "line": 1, "line3": 8, "triangle": 2, "triangle6": 9, "quad": 3, "tetra": 4, "tetra10": 11,
          "hexahedron": 5, "wedge": 6, "pyramid": 7}
FACE = {2: 1, 3: 2, 4: 3}  # type of a face by its vertices
# The nodes of degree 2 in gmsh's order: vertices, then middles of edges.
POINTS = {9: np.array([(0, 0), (1, 0), (0, 1), (.5, 0), (.5, .5), (0, .5)]),
          11: np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (.5, 0, 0), (.5, .5, 0), (0, .5, 0), (0, 0, .5),
                        (0, .5, .5), (.5, 0, .5)])}


class CellMesh:
    """x: n x 3. blocks: {gmsh's type: (entity of each, its nodes from 0)}."""

    def __init__(self, x, blocks):
        if unknown := set(blocks) - set(TYPES):
            raise ValueError(f"no measure for cells of gmsh's types {', '.join(map(str, sorted(unknown)))}")
        self.x, self.blocks = np.array(x, float), blocks
        self.dim = max(TYPES[t].dim for t in blocks)

    def cells(self):
        return [(TYPES[t], nodes) for t, (_, nodes) in self.blocks.items() if TYPES[t].dim == self.dim]

    def boundary(self, entity=None):
        """Whether a node is on the boundary (of this entity)."""
        on = np.zeros(len(self.x), bool)
        for t, (entities, nodes) in self.blocks.items():
            if TYPES[t].dim == self.dim - 1:
                on[nodes[entities == entity] if entity is not None else nodes] = True
        return on

    def outer_faces(self):
        """{gmsh's type: nodes} of the faces of one cell alone, straight."""
        found = {}
        for cell, nodes in self.cells():
            for face in cell.faces:
                for row in nodes[:, face].tolist():
                    found.setdefault(tuple(sorted(row)), []).append(row)
        outer = collections.defaultdict(list)
        for rows in found.values():
            if len(rows) == 1:
                outer[FACE[len(rows[0])]].append(rows[0])
        return {t: np.array(rows) for t, rows in outer.items()}

    def add_boundary(self):
        """The faces of one cell alone, as entity 1."""
        for t, rows in self.outer_faces().items():
            self.blocks[t] = (np.ones(len(rows), int), rows)

    def turn(self):
        """Numbers the cells of an entity the other way round where their volume, with sign, is negative: how many."""
        turned = 0
        for cell, nodes in self.cells():
            volumes = sum(determinant(edges) for edges in corner_edges(self.x[nodes], cell))
            entities = self.blocks[cell.number][0]
            for entity in np.unique(entities):
                if volumes[entities == entity].sum() < 0:
                    nodes[entities == entity] = nodes[entities == entity][:, MIRRORED[cell.number]]
                    turned += (entities == entity).sum()
        return turned

    def scaled_jacobians(self):
        return np.concatenate([scaled_jacobians(self.x[nodes], cell) for cell, nodes in self.cells()])


def scaled_jacobians(x, cell):
    """Of cells of one type; x: cells x nodes x 3."""
    if cell.degree == 1:
        return np.min([ratio(edges) for edges in corner_edges(x, cell)], axis=0) / cell.regular
    points = np.array([p for p in itertools.product(range(GRID + 1), repeat=cell.dim) if sum(p) <= GRID]) / GRID
    reference = POINTS[cell.number][:cell.vertices]
    least = np.full(len(x), np.inf)
    for gradient in gradients(POINTS[cell.number], points):
        jacobian = np.einsum("nk,enc->eck", gradient, x)
        for at, *ends in cell.corners:
            edges = [jacobian @ (reference[end] - reference[at]) for end in ends]
            least = np.minimum(least, ratio(edges) / cell.regular)
    return least


def corner_edges(x, cell):
    """For each corner the edges there, of cells of one type; x: cells x nodes x 3."""
    return [[x[:, end] - x[:, at] for end in ends] for at, *ends in cell.corners]


def gradients(nodes, points):
    """Of the quadratic Lagrange polynomials of the nodes: points x nodes x dim."""
    dim = nodes.shape[1]
    powers = [p for p in itertools.product(range(3), repeat=dim) if sum(p) <= 2]
    inverse = np.linalg.inv([[np.prod(node ** p) for p in powers] for node in nodes])
    lowered = [[p[k] * np.prod([points[:, a] ** max(0, p[a] - (a == k)) for a in range(dim)], axis=0) for p in powers]
               for k in range(dim)]
    return np.einsum("kmp,mn->pnk", np.array(lowered), inverse)


def ratio(edges):
    """Determinant over lengths; 0 where an edge is a point."""
    lengths = np.prod([np.linalg.norm(e, axis=1) for e in edges], axis=0)
    return np.where(lengths > 0, determinant(edges) / np.where(lengths > 0, lengths, 1), 0)


def determinant(edges):
    normal = np.cross(edges[0], edges[1])
    return normal[:, 2] if len(edges) == 2 else np.einsum("ij,ij->i", normal, edges[2])


def read(path):
    """Raises ValueError where the file cannot be read."""
    head = Path(path).read_bytes()[:64].split()
    if head[:1] != [b"$MeshFormat"] or head[2:3] != [b"0"] or head[1] not in (b"2.2", b"4.1"):
        return read_by_meshio(path)
    lines = [line.strip() for line in Path(path).read_text(errors="replace").split("\n")]
    part = lambda name: (line.split() for line in lines[lines.index(name) + 1:])
    try:
        ids, x, rows = (read_2 if head[1] == b"2.2" else read_4)(part("$Nodes"), part("$Elements"))
    except (StopIteration, RuntimeError, IndexError, ValueError) as error:
        raise ValueError(f"no mesh that ends as it should: {error!r}")
    number = np.full(max(ids) + 1, -1)
    number[ids] = np.arange(len(ids))
    blocks = {t: np.array(of_type, int) for t, of_type in rows.items()}
    return CellMesh(np.array(x, float), {t: (table[:, 0], number[table[:, 1:]]) for t, table in blocks.items()})


def read_2(nodes, elements):
    """(ids of nodes, their coordinates as text, {type: rows of entity and nodes}). nodes, elements: lines of words, of
    which the first has the count."""
    table = [next(nodes) for _ in range(int(next(nodes)[0]))]
    rows = {}
    for words in (next(elements) for _ in range(int(next(elements)[0]))):
        tags = int(words[2])
        rows.setdefault(int(words[1]), []).append([words[4] if tags > 1 else 0, *words[3 + tags:]])
    return [int(words[0]) for words in table], [words[1:4] for words in table], rows


def read_4(nodes, elements):
    """The same of MSH 4.1, in which there are blocks of nodes, and of elements, of one entity."""
    ids, x, rows = [], [], {}
    for _ in range(int(next(nodes)[0])):
        count = int(next(nodes)[3])
        ids += [int(next(nodes)[0]) for _ in range(count)]
        x += [next(nodes)[:3] for _ in range(count)]
    for _ in range(int(next(elements)[0])):
        _, entity, kind, count = map(int, next(elements))
        rows.setdefault(kind, []).extend([entity, *next(elements)[1:]] for _ in range(count))
    return ids, x, rows


def read_by_meshio(path):
    import meshio
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):  # its remarks
        try:
            mesh = meshio.read(path)
        except (Exception, SystemExit) as error:
            raise ValueError(f"meshio cannot read it: {error!r}")
    if unknown := {block.type for block in mesh.cells} - set(MESHIO):
        raise ValueError(f"no measure for cells of meshio's types {', '.join(sorted(unknown))}")
    rows = collections.defaultdict(list)
    for block in mesh.cells:
        order = [*range(8), 9, 8] if block.type == "tetra10" else slice(None)  # of VTK's
        rows[MESHIO[block.type]].append(block.data[:, order])
    blocks = {t: np.concatenate(parts) for t, parts in rows.items()}
    x = np.zeros((len(mesh.points), 3))
    x[:, :mesh.points.shape[1]] = mesh.points
    return CellMesh(x, {t: (np.ones(len(nodes), int), nodes) for t, nodes in blocks.items()})


def write(mesh, path):
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(mesh.x))]
    lines += [f"{i} {p[0]!r} {p[1]!r} {p[2]!r}" for i, p in enumerate(mesh.x.tolist(), 1)]
    elements = [f"{t} 2 {entity} {entity} " + " ".join(map(str, row))
                for t, (entities, nodes) in mesh.blocks.items()
                for entity, row in zip(entities.tolist(), (nodes + 1).tolist())]
    lines += ["$EndNodes", "$Elements", str(len(elements)), *(f"{i} {e}" for i, e in enumerate(elements, 1))]
    Path(path).write_text("\n".join(lines + ["$EndElements", ""]))

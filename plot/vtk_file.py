"""Reader of the program's legacy VTK files, ASCII and binary, and the nodes on the faces of their cells. Standard
library only.

Nodes of a cell in VTK's order: the vertices, those inside each edge, those inside each face row by row (in triangles
and tetrahedra as the nodes of a triangle of degree p - 3), then the rest (vtkLagrangeTetra, vtkHigherOrderHexahedron,
vtkHigherOrderWedge, vtkQuadraticPyramid). A face or an edge begins at the first vertex that the tables below name.
"""
import sys
from array import array
from dataclasses import dataclass, field
from urllib.parse import unquote

QUAD_EDGES = [(0, 1), (1, 2), (3, 2), (0, 3)]
PLANE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
TRIANGLE = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]


def lifted(corners):
    return [(x, y, 1) for x, y, z in corners]


# Corners on the unit cell, edges, faces; a cell of the plane is its only face.
TRIANGLES = (TRIANGLE, [(0, 1), (1, 2), (2, 0)], [(0, 1, 2)])
QUADRILATERALS = (PLANE, QUAD_EDGES, [(0, 1, 2, 3)])
TETRAHEDRA = (TRIANGLE + [(0, 0, 1)], [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
              [(0, 1, 3), (2, 3, 1), (0, 3, 2), (0, 2, 1)])
HEXAHEDRA = (PLANE + lifted(PLANE),
             QUAD_EDGES + [(a + 4, b + 4) for a, b in QUAD_EDGES] + [(k, k + 4) for k in range(4)],
             [(0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)])
PRISMS = (TRIANGLE + lifted(TRIANGLE), [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
          [(0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)])
PYRAMIDS = (PLANE + [(0, 0, 1)], [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)],
            [(0, 1, 4), (3, 0, 4), (1, 2, 4), (2, 3, 4), (0, 1, 2, 3)])
CELLS = {vtk_type: cell for cell, types in [
    (TRIANGLES, (5, 22, 69)), (QUADRILATERALS, (9, 28, 70)), (TETRAHEDRA, (10, 24, 71)), (HEXAHEDRA, (12, 29, 72)),
    (PRISMS, (13, 32, 73)), (PYRAMIDS, (14, 27))] for vtk_type in types}


@dataclass
class VtkFile:
    title: str = ""
    points: array = None                            # x, y, z of each node
    cells: array = None                             # of each cell the number of its nodes, and these
    types: array = None                             # VTK's cell types
    point_data: dict = field(default_factory=dict)  # name: an array
    cell_data: dict = field(default_factory=dict)


# --------------------------------------------------------------------------------------------------------------- reader

class Reader:
    """The bytes of a file, taken from the front."""

    def __init__(self, path):
        self.path, self.data, self.at, self.number, self.binary = path, path.read_bytes(), 0, 0, False

    def fail(self, what):
        raise ValueError(f"{self.path}: {what}: not a whole VTK file of this program")

    def line(self):
        """The next line; None at the end of the file."""
        if self.at >= len(self.data):
            return None
        end = self.data.find(b"\n", self.at) % (len(self.data) + 1)
        line, self.at = self.data[self.at:end].decode("utf-8", "replace"), end + 1
        return line

    def array(self, kind, rows, count):
        """The next numbers, which in text are so many lines."""
        start = self.at
        if self.binary:
            values = array(kind)
            self.at += count * values.itemsize
            values.frombytes(self.data[start:self.at])
            if sys.byteorder == "little":
                values.byteswap()
        else:
            for _ in range(rows):
                self.at = self.data.find(b"\n", self.at) + 1
                if self.at == 0:
                    self.fail("ends early")
            values = array(kind, map(int if kind == "i" else float, self.data[start:self.at].split()))
        if len(values) != count:
            self.fail(f"has {len(values)} numbers in place of {count}")
        return values

    def string(self):
        """A name of the field data; a binary one has its length in front of it, in six bits or fourteen."""
        if not self.binary:
            return self.line()
        first = self.data[self.at]
        start, length = self.at + 1, first & 63
        if first < 0xc0:
            start, length = self.at + 2, 256 * length + self.data[self.at + 1]
        self.at = start + length + 1
        return self.data[start:start + length].decode("utf-8", "replace")


def read(path):
    """The VtkFile at the path. Raises ValueError where the file is something else, or ends early."""
    reader, vtk = Reader(path), VtkFile()
    if not (reader.line() or "").startswith("# vtk DataFile"):
        reader.fail("does not begin with `# vtk DataFile`")
    vtk.title = reader.line() or ""
    reader.binary = reader.line() == "BINARY"
    data, count = {}, 0
    while (line := reader.line()) is not None:
        words = line.split()
        match words[:1]:
            case [] | ["DATASET"]:
                pass
            case ["FIELD"]:
                for _ in range(int(words[2])):
                    reader.line(), reader.string()
            case ["POINTS"]:
                vtk.points = reader.array("d", int(words[1]), 3 * int(words[1]))
            case ["CELLS"]:
                vtk.cells = reader.array("i", int(words[1]), int(words[2]))
            case ["CELL_TYPES"]:
                vtk.types = reader.array("i", int(words[1]), int(words[1]))
            case ["POINT_DATA" | "CELL_DATA"]:
                data, count = vtk.point_data if words[0] == "POINT_DATA" else vtk.cell_data, int(words[1])
            case ["SCALARS"]:
                reader.line()  # LOOKUP_TABLE
                data[unquote(words[1])] = reader.array("d", count, count)
            case ["VECTORS"]:
                data[unquote(words[1])] = reader.array("d", count, 3 * count)
            case _:
                reader.fail(f"`{line[:40]}` is not expected")
    if vtk.points is None or vtk.cells is None or vtk.types is None:
        reader.fail("ends early")
    return vtk


# ---------------------------------------------------------------------------------------------------- nodes on faces

def triangle_nodes(p):
    """(u, v) of the nodes of a triangle of degree p, at (u/p, v/p), in VTK's order."""
    if p < 1:
        return [(0, 0)] * (p == 0)
    inside = range(1, p)
    edges = [(s, 0) for s in inside] + [(p - s, s) for s in inside] + [(0, p - s) for s in inside]
    return [(0, 0), (p, 0), (0, p)] + edges + [(u + 1, v + 1) for u, v in triangle_nodes(p - 3)]


def lattice(corners, p):
    """(u, v) of the nodes of a face with 3 or 4 corners, row by row."""
    return [(u, v) for v in range(p + 1) for u in range(p + 1 - v if corners == 3 else p + 1)]


def degree_of(vtk_type, count):
    """p of a cell with so many nodes. A pyramid of degree 2 has no node in the middle of its base."""
    formula = {id(TRIANGLES): lambda p: (p + 1) * (p + 2) // 2, id(QUADRILATERALS): lambda p: (p + 1) ** 2,
               id(TETRAHEDRA): lambda p: (p + 1) * (p + 2) * (p + 3) // 6, id(HEXAHEDRA): lambda p: (p + 1) ** 3,
               id(PRISMS): lambda p: (p + 1) ** 2 * (p + 2) // 2, id(PYRAMIDS): lambda p: 8 * p - 3}
    return next(p for p in range(1, 32) if formula[id(CELLS[vtk_type])](p) == count)


def faces_of(vtk_type, count):
    """The faces of a cell with so many nodes, and its degree. Of each face: how many corners it has, and the places of
    its nodes in the cell, in the order of lattice(); a node that the cell does not have is left out."""
    corners, edges, faces = CELLS[vtk_type]
    p = degree_of(vtk_type, count)
    if vtk_type == 72:  # those of VTK 8, in files before version 5
        edges = edges[:10] + [edges[11], edges[10]]

    def at(a, b, c, u, v):  # p a + u (b - a) + v (c - a) of the corners
        return tuple((p - u - v) * x + u * y + v * z for x, y, z in zip(corners[a], corners[b], corners[c]))

    nodes = [at(k, k, k, 0, 0) for k in range(len(corners))]
    nodes += [at(a, b, b, s, 0) for a, b in edges for s in range(1, p)]
    for face in faces:
        if CELLS[vtk_type] is PYRAMIDS:
            continue
        inside = [(u, v) for v in range(1, p) for u in range(1, p - v if len(face) == 3 else p)]
        if len(face) == 3 and vtk_type != 73:
            inside = [(u + 1, v + 1) for u, v in triangle_nodes(p - 3)]
        nodes += [at(face[0], face[1], face[-1], u, v) for u, v in inside]
    place = {position: k for k, position in enumerate(nodes)}
    on_face = [[at(face[0], face[1], face[-1], u, v) for u, v in lattice(len(face), p)] for face in faces]
    return [(len(face), [place[q] for q in positions if q in place]) for face, positions in zip(faces, on_face)], p

#!/usr/bin/python3
"""Tests plot/to_msh.py: two cells of each type, in each of its formats, simplices and quadrilaterals of degree 1 and 2,
must come out with the same named parts, the nodes in Gmsh's order and quadrilaterals of 8 nodes with a centre. Exit code 1
where one does not. Needs Debian's python3-meshio.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import meshio
import netCDF4
import numpy as np

PROGRAM = Path(__file__).resolve().parent.parent / "plot" / "to_msh.py"
TRIANGLE, QUADRILATERAL, TETRAHEDRON = (2, 3), (2, 4), (3, 4)  # dimension and number of corners
HEXAHEDRON, PRISM, PYRAMID = (3, 8), (3, 6), (3, 5)
CORNERS = {TRIANGLE: [[0, 1, 2], [1, 3, 2]], QUADRILATERAL: [[0, 1, 3, 2], [1, 4, 5, 3]],
           TETRAHEDRON: [[0, 1, 2, 3], [1, 4, 2, 3]],
           HEXAHEDRON: [[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]],
           PRISM: [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]], PYRAMID: [[0, 1, 2, 3, 12], [0, 4, 5, 1, 12]]}  # of `solid` and `fluid`, which share a side
EDGES = {(1, 2): [(0, 1)], TRIANGLE: [(0, 1), (1, 2), (2, 0)], QUADRILATERAL: [(0, 1), (1, 2), (2, 3), (3, 0)],
         TETRAHEDRON: [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],  # VTK's order
         HEXAHEDRON: [], PRISM: [], PYRAMID: []}
GMSH_EDGES = {**EDGES, TETRAHEDRON: [(0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1)]}
ABAQUS_SIDES = {**EDGES, TETRAHEDRON: [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
                HEXAHEDRON: [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
                PRISM: [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)],
                PYRAMID: [(0, 1, 2, 3), (0, 4, 1), (1, 4, 2), (2, 4, 3), (3, 4, 0)]}
EXODUS_SIDES = {**EDGES, TETRAHEDRON: [(0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 2, 1)],
                HEXAHEDRON: [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 4, 7, 3), (0, 3, 2, 1), (4, 5, 6, 7)],
                PRISM: [(0, 1, 4, 3), (1, 2, 5, 4), (0, 3, 5, 2), (0, 2, 1), (3, 4, 5)],
                PYRAMID: [(0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3), (0, 3, 2, 1)]}
ABAQUS_TYPES = {(1, 2): ("T3D2", "T3D3"), TRIANGLE: ("CPE3", "CPS6"), QUADRILATERAL: ("CPE4R", "CPS8"),
                TETRAHEDRON: ("C3D4", "C3D10"), HEXAHEDRON: ("C3D8R",), PRISM: ("C3D6",), PYRAMID: ("C3D5",)}
EXODUS_TYPES = {TRIANGLE: "TRI", QUADRILATERAL: "QUAD", TETRAHEDRON: "TETRA",
                HEXAHEDRON: "HEX8", PRISM: "WEDGE", PYRAMID: "PYRAMID5"}
MESHIO_TYPES = {(1, 2): ("line", "line3"), TRIANGLE: ("triangle", "triangle6"), QUADRILATERAL: ("quad", "quad8"),
                TETRAHEDRON: ("tetra", "tetra10"), HEXAHEDRON: ("hexahedron",), PRISM: ("wedge",),
                PYRAMID: ("pyramid",)}


class Example:
    def __init__(self, kind, degree):
        self.kind, self.dim, self.degree = kind, kind[0], degree
        is_simplex = kind[1] == self.dim + 1
        self.side = (self.dim - 1, self.dim) if self.dim == 2 or is_simplex else QUADRILATERAL  # the kind of its sides
        square = [[0, 0], [1, 0], [1, 1], [0, 1]]
        self.points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [2, 0, 0], [2, 1, 0]] if self.dim == 2 else
                               [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]] if is_simplex else
                               [[*xy, z] for z in (0, 1, 2) for xy in square] + [[0.5, 0.5, 0.5]], float)
        self.middle = {}
        self.elements = [self.with_middles(corners, kind) for corners in CORNERS[kind]]
        # A side on the boundary lies in one element. Those of `fluid` are the wall, those of `solid` the inflow.
        self.faces = {name: [self.with_middles([own[i] for i in side], self.side) for side in EXODUS_SIDES[kind]
                             if not {own[i] for i in side} <= set(CORNERS[kind][1 - k])]
                      for k, (name, own) in enumerate(zip(("inflow", "wall"), CORNERS[kind]))}

    def with_middles(self, corners, kind):
        nodes = list(corners)
        for a, b in EDGES[kind] if self.degree == 2 else []:
            edge = frozenset((corners[a], corners[b]))
            if edge not in self.middle:
                self.middle[edge] = len(self.points)
                self.points = np.vstack([self.points, self.points[list(edge)].mean(axis=0)])
            nodes.append(self.middle[edge])
        return nodes

    def sides(self, name, table):
        """(element, side from 1) of the faces of a boundary."""
        return [(k, s) for k, corners in enumerate(CORNERS[self.kind]) for s, side in enumerate(table[self.kind], 1)
                if {corners[i] for i in side} in [set(face[:len(side)]) for face in self.faces[name]]]


def abaqus(mesh, path, how):
    def rows(first, cells):
        return [", ".join(map(str, [10 * (first + k), *[n + 100 for n in nodes]])) for k, nodes in enumerate(cells)]
    text = ["*Heading", "** a comment", "*Node"]
    text += [f"{k + 100}, " + ", ".join(map(repr, map(float, point))) for k, point in enumerate(mesh.points)]
    text += [f"*Element, type={ABAQUS_TYPES[mesh.kind][mesh.degree - 1]}", *rows(1, mesh.elements),
             "*ELSET, ELSET=all", "10, 20", "*Elset, elset=solid", "10", "*Elset, elset=fluid, generate", "20, 20"]
    if how == "cells":
        first = 3
        for name, faces in mesh.faces.items():
            faces = [[f[0], f[2], f[1]] if mesh.dim == mesh.degree == 2 else f for f in faces]
            text += [f"*Element, type={ABAQUS_TYPES[mesh.side][mesh.degree - 1]}, elset=of_{name}", *rows(first, faces)]
            for k in range(first, first + len(faces)):
                text += [f"*Elset, elset={name}", f"{10 * k}"]
            first += len(faces)
    elif how == "surfaces":
        text += ["*Elset, elset=one, internal", "solid"]
        for name in mesh.faces:
            text += [f"*Surface, type=ELEMENT, name={name}"]
            text += [f"{('one', 20)[k]}, S{side}" for k, side in mesh.sides(name, ABAQUS_SIDES)]
    else:
        for name, faces in mesh.faces.items():  # as Abaqus does it, with the elements there
            nodes = sorted({node + 100 for face in faces for node in face})
            text += [f"*Elset, elset={name}", "10, 20", f"*Nset, nset={name}", ",\n".join(map(str, nodes))]
    path.write_text("\n".join(text + ["*End Part", ""]))


def exodus(mesh, path, how):
    with netCDF4.Dataset(path, "w") as file:
        def put(name, values, kind="i4"):
            values = np.asarray(values)
            sizes = [f"{name}_{k}" for k in range(values.ndim)]
            for size, count in zip(sizes, values.shape):
                file.createDimension(size, count)
            file.createVariable(name, kind, sizes)[:] = values
            return file[name]

        def put_names(name, names):
            put(name, np.array(list(names), "S33").view("S1").reshape(-1, 33), "S1")
        for k, axis in enumerate("xyz"[:mesh.dim]):
            put(f"coord{axis}", mesh.points[:, k], "f8")
        put("eb_prop1", [10, 20])
        put_names("eb_names", ["solid", "fluid"])
        for k, nodes in enumerate(mesh.elements, 1):
            put(f"connect{k}", [np.add(nodes, 1)]).elem_type = EXODUS_TYPES[mesh.kind]
        kind = {"sides": "ss", "nodes": "ns"}[how]
        put(f"{kind}_prop1", [1, 2])
        put_names(f"{kind}_names", mesh.faces)
        for k, (name, faces) in enumerate(mesh.faces.items(), 1):
            sides = np.array(mesh.sides(name, EXODUS_SIDES))
            if how == "sides":
                put(f"elem_ss{k}", sides[:, 0] + 1)
                put(f"side_ss{k}", sides[:, 1])
            else:
                put(f"node_ns{k}", np.unique(np.concatenate(faces)) + 1)


def by_number(mesh, path, how):
    """Medit and VTU: the parts are 1 to 4."""
    element, side = (MESHIO_TYPES[kind][mesh.degree - 1] for kind in (mesh.kind, mesh.side))
    cells = [(side, faces) for faces in mesh.faces.values()] + [(element, [nodes]) for nodes in mesh.elements]
    parts = [np.full(len(nodes), part) for (_, nodes), part in zip(cells, (1, 2, 3, 4))]
    meshio.write(path, meshio.Mesh(mesh.points, cells, cell_data={"part": parts}))


def parts_of(path):
    """{(dimension, name): [nodes of cells]} of an MSH file, and its points."""
    words = [line.split() for line in path.read_text().splitlines()]
    at = {line[0]: k for k, line in enumerate(words) if line[0][0] == "$"}
    rows = words[at["$PhysicalNames"] + 2:at["$EndPhysicalNames"]]
    names = {tag: (int(dim), name.strip(chr(34))) for dim, tag, name in rows}
    parts = {}
    for line in words[at["$Elements"] + 2:at["$EndElements"]]:
        parts.setdefault(names[line[3]], []).append([int(word) - 1 for word in line[5:]])
    return parts, np.array([line[1:] for line in words[at["$Nodes"] + 2:at["$EndNodes"]]], float)


def cell_sets(parts):
    return {part: sorted(map(sorted, cells)) for part, cells in parts.items()}


def failure(mesh, write, suffix, how):
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / f"in{suffix}", Path(folder) / "out.msh"
        write(mesh, source, how)
        run = subprocess.run([sys.executable, PROGRAM, source, target], capture_output=True, text=True)
        if run.returncode:
            return run.stdout + run.stderr
        parts, points = parts_of(target)
    names = ["inflow", "wall", "solid", "fluid"] if write is not by_number else ["1", "2", "3", "4"]
    if centred := mesh.dim == 2 and len(mesh.elements[0]) == 8:
        mesh.elements = [[*nodes, len(mesh.points) + k] for k, nodes in enumerate(mesh.elements)]
    expected = dict(zip([(mesh.dim - 1 + (k > 1), name) for k, name in enumerate(names)],
                        [*mesh.faces.values(), mesh.elements[:1], mesh.elements[1:]]))
    if cell_sets(parts) != cell_sets(expected):
        return f"{parts}\n  instead of {expected}"
    for (dim, name), cells in parts.items():
        for nodes in cells:
            kind = mesh.kind if dim == mesh.dim else mesh.side
            edges = GMSH_EDGES[kind] if mesh.degree == 2 else []
            middles = [points[[nodes[a], nodes[b]]].mean(axis=0) for a, b in edges]
            middles += [points[nodes[:4]].mean(axis=0)] * centred
            if any((points[node] != middle).any() for node, middle in zip(nodes[kind[1]:], middles)):
                return f"the nodes {nodes} of {name} are not in Gmsh's order"
    return ""


def main():
    cases = [(kind, degree, *how) for kind in (TRIANGLE, QUADRILATERAL, TETRAHEDRON) for degree in (1, 2) for how in (
        (abaqus, ".inp", "cells"), (abaqus, ".inp", "surfaces"), (abaqus, ".inp", "nodes"), (exodus, ".e", "sides"),
        (exodus, ".e", "nodes"), (by_number, ".vtu", "cells"), (by_number, ".mesh", "cells"))
        if degree == 1 or how[1] != ".mesh"]
    cases += [(kind, 1, *how) for kind in (HEXAHEDRON, PRISM, PYRAMID) for how in (
        (abaqus, ".inp", "surfaces"), (abaqus, ".inp", "nodes"), (exodus, ".e", "sides"), (exodus, ".e", "nodes"))]
    cases += [(HEXAHEDRON, 1, abaqus, ".inp", "cells"), (HEXAHEDRON, 1, by_number, ".vtu", "cells"),
              (HEXAHEDRON, 1, by_number, ".mesh", "cells")]
    failures = 0
    for kind, degree, write, suffix, how in cases:
        if message := failure(Example(kind, degree), write, suffix, how):
            failures += 1
            print(f"{suffix}, {how}, {EXODUS_TYPES[kind]}, degree {degree}: {message}", file=sys.stderr)
    read = f"{len(cases) - failures} of {len(cases)} files of all types of cells"
    print(f"{read} come out with their parts")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

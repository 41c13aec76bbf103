"""Mesh files as they are: MSH 2.2 and 4.1, text and binary, and SU2. Nothing is mended, turned or left out."""
import collections
import re
import struct

import numpy as np

from cells import CELLS, OF_TYPE, QUADRILATERAL, face_nodes, values, reference

SU2_CELLS = {3: 1, 5: 2, 9: 3, 10: 4, 12: 5, 13: 6, 14: 7}  # type of VTK -> type of Gmsh, both linear


class Block:
    """Elements of one type: ids, nodes as numbers in Mesh.x, names of the groups of each."""

    def __init__(self, cell, degree, ids, nodes, groups):
        self.cell, self.degree = cell, degree
        self.ids, self.nodes, self.groups = np.array(ids), np.array(nodes), groups


class Mesh:
    def __init__(self, ids, x, elements, names, is_su2=False):
        """elements: rows (id, type of Gmsh, physical groups as (dim, tag), nodes by their ids)."""
        self.ids, self.x, self.is_su2, self.names = np.array(ids), np.array(x, float), is_su2, names
        at = {node: k for k, node in enumerate(self.ids.tolist())}
        by_type = collections.defaultdict(list)
        for row in elements:
            by_type[row[1]].append(row)
        self.blocks = []
        for kind, rows in sorted(by_type.items()):
            if kind in OF_TYPE:  # points have no type here
                merged = {}  # an element that stands once for each of its groups is one
                for number, _, physical, of in rows:
                    merged.setdefault(tuple(of), (number, set()))[1].update(physical)
                self.blocks.append(Block(*OF_TYPE[kind], [number for number, _ in merged.values()],
                                         [[at[i] for i in of] for of in merged],
                                         [frozenset(g) for _, g in merged.values()]))
        self.dim = max(b.cell.dim for b in self.blocks)
        self.cells = [b for b in self.blocks if b.cell.dim == self.dim]
        self.degree = self.cells[0].degree

    def name(self, group):
        return self.names.get(group, str(group[1]))

    def groups(self, dim):
        """name -> list of (block, rows)"""
        found = collections.defaultdict(list)
        for block in self.blocks:
            if block.cell.dim == dim:
                rows = collections.defaultdict(list)
                for k, groups in enumerate(block.groups):
                    for group in groups:
                        rows[self.name(group)].append(k)
                for name, of in rows.items():
                    found[name].append((block, np.array(of)))
        return found

    def outer_faces(self):
        """Faces that one cell has: rows (block, number of the face in its cell, rows of these cells)."""
        keys, places = [], []
        for block in self.cells:
            for k, face in enumerate(block.cell.faces):
                key = np.full((len(block.nodes), 4), -1)
                key[:, :len(face)] = np.sort(block.nodes[:, list(face)], axis=1)
                keys.append(key)
                places.append((block, k))
        _, number, count = np.unique(np.concatenate(keys), axis=0, return_inverse=True, return_counts=True)
        once, first, found = count[number.ravel()] == 1, 0, []
        for block, k in places:
            rows = np.flatnonzero(once[first:first + len(block.nodes)])
            first += len(block.nodes)
            if len(rows):
                found.append((block, k, rows))
        return found


def raised(source, at, mesh, own=None):
    """Where the nodes of a mesh are that has the cells of another, by their ids, in any degree, where the other's nodes
    are at `at`. NaN where that is not told. own: ids that mean the same node in both; None: all."""
    x = np.full((len(mesh.ids), at.shape[1]), np.nan)
    for block in mesh.cells:
        for other in source.cells:
            if other.cell is block.cell:
                of = {number: k for k, number in enumerate(other.ids.tolist())}
                rows = np.array([k for k, number in enumerate(block.ids.tolist()) if number in of], int)
                if not len(rows):
                    continue
                there = np.array([of[number] for number in block.ids[rows].tolist()])
                corners = slice(0, len(block.cell.vertices))
                same = np.all(mesh.ids[block.nodes[rows, corners]] == source.ids[other.nodes[there, corners]], axis=1)
                rows, there = rows[same], there[same]  # not those that were divided
                N = values(block.cell, other.degree, reference(block.cell, block.degree))
                x[block.nodes[rows]] = np.einsum("pn,ena->epa", N, at[other.nodes[there]])
    number = {node: k for k, node in enumerate(source.ids.tolist()) if own is None or node in own}
    known = np.array([number.get(node, -1) for node in mesh.ids.tolist()])
    x[known >= 0] = at[known[known >= 0]]  # to the last bit
    return x


class Scanner:
    """Numbers of a section, text or binary."""

    def __init__(self, data, binary):
        self.data, self.binary, self.at = (data if binary else data.split()), binary, 0

    def take(self, kind, count):
        begin = self.at
        if not self.binary:
            self.at += count
            return np.array(self.data[begin:self.at]).astype(float if kind == "d" else np.int64)
        self.at += count * struct.calcsize("=" + kind)
        return np.frombuffer(self.data[begin:self.at], dtype={"i": "<i4", "Q": "<u8", "d": "<f8"}[kind]).astype(
            float if kind == "d" else np.int64)

    def one(self, kind):
        return int(self.take(kind, 1)[0])


def msh_sections(data):
    """name -> bytes of the section, in the order of the file."""
    found, at = {}, 0
    while (begin := re.compile(rb"^\$(\w+)[ \r]*\n", re.M).search(data, at)):
        name = begin[1]
        end = re.compile(rb"\$End" + name + rb"\b").search(data, begin.end())
        found[name.decode()], at = data[begin.end():end.start()], end.end()
    return found


def read_msh(data):
    sections = msh_sections(data)
    version, binary = sections["MeshFormat"].split()[:2]
    binary = int(binary) == 1
    names = {}
    for line in sections.get("PhysicalNames", b"").decode().splitlines()[1:]:
        row = re.match(r'\s*(\d+)\s+(\d+)\s+"(.*)"', line)
        if row:
            names[int(row[1]), int(row[2])] = row[3]
    read = read_msh2 if version.startswith(b"2") else read_msh41 if version == b"4.1" else None
    if not read:
        raise ValueError(f"MSH {version.decode()} is not read here")
    return Mesh(*read(sections, binary), names)


def read_msh2(sections, binary):
    if binary:
        count, rest = sections["Nodes"].split(b"\n", 1)
        table = np.frombuffer(rest, dtype=[("id", "<i4"), ("x", "<f8", 3)], count=int(count))
        ids, x = table["id"].astype(int), table["x"]
        count, rest = sections["Elements"].split(b"\n", 1)
        scan, elements = Scanner(rest, True), []
        while len(elements) < int(count):
            kind, rows, tags = scan.take("i", 3).tolist()
            size = 1 if kind == 15 else len(reference(*OF_TYPE[kind]))
            for row in scan.take("i", rows * (1 + tags + size)).reshape(rows, -1).tolist():
                elements.append((row[0], kind, row[1:2], row[1 + tags:]))
    else:
        rows = np.array(sections["Nodes"].split()[1:]).reshape(-1, 4)
        ids, x = rows[:, 0].astype(int), rows[:, 1:].astype(float)
        elements = []
        for line in sections["Elements"].splitlines()[1:]:
            row = [int(word) for word in line.split()]
            if row:
                elements.append((row[0], row[1], row[3:4] if row[2] else [], row[3 + row[2]:]))
    dims = {kind: OF_TYPE[kind][0].dim if kind in OF_TYPE else 0 for kind in {e[1] for e in elements}}
    return ids, x, [(number, kind, [(dims[kind], tag) for tag in tags if tag], of)
                    for number, kind, tags, of in elements]


def read_msh41(sections, binary):
    physical = collections.defaultdict(list)  # (dim, entity) -> groups
    if "Entities" in sections:
        scan = Scanner(sections["Entities"], binary)
        counts = scan.take("Q", 4)
        for dim in range(4):
            for _ in range(counts[dim]):
                tag = scan.one("i")
                scan.take("d", 6 if dim else 3)
                physical[dim, tag] = [(dim, abs(p)) for p in scan.take("i", scan.one("Q")).tolist()]
                if dim:
                    scan.take("i", scan.one("Q"))
    scan = Scanner(sections["Nodes"], binary)
    ids, x = [], []
    for _ in range(scan.take("Q", 4)[0]):
        dim, _, parametric = scan.take("i", 3)
        count = scan.one("Q")
        ids.append(scan.take("Q", count))
        x.append(scan.take("d", count * (3 + dim * parametric)).reshape(count, 3 + dim * parametric)[:, :3])
    scan, elements = Scanner(sections["Elements"], binary), []
    for _ in range(scan.take("Q", 4)[0]):
        dim, entity, kind = scan.take("i", 3).tolist()
        count = scan.one("Q")
        size = 1 if kind == 15 else len(reference(*OF_TYPE[kind]))
        for row in scan.take("Q", count * (1 + size)).reshape(count, 1 + size).tolist():
            elements.append((row[0], kind, physical[dim, entity], row[1:]))
    return np.concatenate(ids), np.concatenate(x), elements


def read_su2(text):
    """Points and elements have the ids 0, 1, ...; elements of markers come after the others."""
    lines = [line.split("%")[0].strip() for line in text.splitlines()]
    names, elements, x, dim, tag, at = {}, [], [], 0, 0, 0
    while at < len(lines):
        key, _, value = (part.strip() for part in lines[at].partition("="))
        at += 1
        if key == "NDIME":
            dim = int(value)
        elif key == "NPOIN":
            count = int(value.split()[0])
            x = [[float(w) for w in line.split()[:dim]] + [0.0] * (3 - dim) for line in lines[at:at + count]]
            at += count
        elif key == "MARKER_TAG":
            tag += 1
            names[dim - 1, tag] = value
        elif key in ("NELEM", "MARKER_ELEMS"):
            group = [(dim - 1, tag)] if key == "MARKER_ELEMS" else []
            for line in lines[at:at + int(value)]:
                row = [int(word) for word in line.split()]
                size = len(reference(*OF_TYPE[SU2_CELLS[row[0]]]))
                elements.append((len(elements), SU2_CELLS[row[0]], group, row[1:1 + size]))
            at += int(value)
    return Mesh(range(len(x)), x, elements, names, True)


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    return read_msh(data) if data.lstrip().startswith(b"$") else read_su2(data.decode())


def write_msh(path, x, elements, names):
    """MSH 2.2 for generated meshes; elements: rows (type of Gmsh, tag, nodes from 0); names: (dim, tag) -> name."""
    rows = [f"{i + 1} " + " ".join(map(repr, (*p, 0.0, 0.0)[:3])) for i, p in enumerate(np.array(x, float).tolist())]
    text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names)),
            *(f'{dim} {tag} "{name}"' for (dim, tag), name in names.items()), "$EndPhysicalNames", "$Nodes",
            str(len(rows)), *rows, "$EndNodes", "$Elements", str(len(elements)),
            *(f"{k + 1} {kind} 2 {tag} {tag} " + " ".join(str(i + 1) for i in of)
              for k, (kind, tag, of) in enumerate(elements)), "$EndElements", ""]
    with open(path, "w") as file:
        file.write("\n".join(text))

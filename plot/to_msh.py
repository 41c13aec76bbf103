#!/usr/bin/python3
"""Writes meshes, of degree 1 of any cells, in Abaqus (.inp), Exodus (.e), Medit (.mesh), VTU or another format of
meshio as MSH; triangles, quadrilaterals and tetrahedra also of degree 2 and 3.

  plot/to_msh.py IN OUT.msh [NAME ...]     NAME: sets that go before smaller ones; for VTU the array of parts' numbers

A cell has the name of its smallest set. A boundary face that is no named cell has the name of its surface or side set,
else of the smallest node set with all its nodes, else `untagged`. Nodes keep their order; quadrilaterals of 8 nodes get
their centres after them. Needs meshio, for Exodus netCDF4 (Debian: both with python3-meshio).
"""
import re
import sys
from collections import Counter, defaultdict
from pathlib import Path

KINDS = ["vertex|sphere", "line|[tb][23]|bar|beam|edge|truss|vtk_lagrange_curve",  # of cells of dimension 0 to 3
         "tri|quad|cp[es]|cax|s[3468]|stri|[mr]3d|sfm3d|dc2d|vtk_lagrange_(tri|quad)",
         "tet|hex|wedge|prism|pyr|d?c3d(4|5|6|8|10)|vtk_lagrange_tet"]
TETRAHEDRA = "tet|d?c3d(4|10)|vtk_lagrange_tet"
MSH_TYPE = {(0, 1): 15, (1, 2): 1, (1, 3): 8, (1, 4): 26, (2, 3): 2, (2, 6): 9, (2, 10): 21,
            (2, 4): 3, (2, 8): 10, (2, 9): 10, (2, 16): 36,
            (3, 4): 4, (3, 10): 11, (3, 20): 29, (3, 8): 5, (3, 6): 6, (3, 5): 7}  # by dimension and number of nodes
MSH_ORDER = {(3, 10): [*range(8), 9, 8], (3, 20): [*range(10), 11, 10, 15, 14, 13, 12, 19, 16, 18, 17],
             (2, 16): [*range(8), 9, 8, 11, 10, 12, 13, 15, 14]}  # of VTK's cells
SIDES = {(2, 3): [[0, 1, 3], [1, 2, 4], [2, 0, 5]],  # as Exodus numbers them; nodes of degree 2 in VTK's order
         (2, 4): [[0, 1, 4], [1, 2, 5], [2, 3, 6], [3, 0, 7]],
         (3, 4): [[0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6], [0, 2, 1, 6, 5, 4]],
         (3, 8): [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [0, 4, 7, 3], [0, 3, 2, 1], [4, 5, 6, 7]],
         (3, 6): [[0, 1, 4, 3], [1, 2, 5, 4], [0, 3, 5, 2], [0, 2, 1], [3, 4, 5]],
         (3, 5): [[0, 1, 4], [1, 2, 4], [2, 3, 4], [0, 4, 3], [0, 3, 2, 1]]}
SIDES |= {(2, 6): SIDES[2, 3], (2, 9): SIDES[2, 4], (3, 10): SIDES[3, 4]}
SIDE_NODES = {(2, 3): 2, (2, 6): 3, (2, 4): 2, (2, 9): 3, (3, 4): 3, (3, 10): 6, (3, 8): 4, (3, 6): 4, (3, 5): 4}
FIRST_SIDE = {4: 3, 10: 3, 8: 4, 6: 3, 5: 4}  # of a solid with so many nodes: what Abaqus begins with
points, cells = [], []  # a cell: [dimension, nodes in VTK's order, name]
sets, node_sets, sides = defaultdict(list), defaultdict(list), defaultdict(list)  # by name: cells, nodes, (cell, side)


def add(kind, nodes_of_cells, name=None):
    dim = next((d for d, names in enumerate(KINDS) if re.match(names, kind, re.I)), None)
    is_linear_solid = dim == 3 and not re.match(TETRAHEDRA, kind, re.I)
    if any((dim, len(nodes)) not in MSH_TYPE or is_linear_solid and len(nodes) > 8 for nodes in nodes_of_cells):
        sys.exit(f"cells `{kind}`: save the mesh with cells of degree 1, or triangles, quadrilaterals or tetrahedra of "
                 "degree 1 to 3, alone")
    for k, nodes in enumerate(nodes_of_cells):
        if (dim, len(nodes)) == (2, 8):  # the centre where the other nodes say that it is
            nodes_of_cells[k] = [*nodes, len(points)]
            points.append([sum(x[4:]) / 2 - sum(x[:4]) / 4 for x in zip(*(points[node] for node in nodes))])
    if name:
        sets[name] += range(len(cells), len(cells) + len(nodes_of_cells))
    cells.extend([dim, nodes, ""] for nodes in nodes_of_cells)


def read_abaqus(path):  # meshio gives element sets to wrong elements and leaves surfaces out
    nodes, elements, internal = {}, {}, set()
    for section in re.split(r"(?m)^\*", re.sub(r"(?m)^\*\*.*\n", "", path.read_text()))[1:]:
        head, _, body = section.partition("\n")
        keyword, *words = [word.strip() for word in head.split(",")]
        keyword = keyword.upper()
        option = {key.strip().upper(): value.strip() for key, _, value in (word.partition("=") for word in words)}
        rows = [re.findall(r"[^,\s]+", row) for row in re.sub(r",\s*\n", ",", body).split("\n") if row.strip()]
        if keyword == "INCLUDE" or (keyword == "PART" and nodes):
            sys.exit(f"*{keyword}: save the mesh as one part in one file")
        if keyword == "NODE":
            nodes |= {row[0]: len(points) + k for k, row in enumerate(rows)}
            points.extend([float(x) for x in row[1:4]] for row in rows)
        elif keyword == "ELEMENT":
            elements |= {row[0]: len(cells) + k for k, row in enumerate(rows)}
            add(option["TYPE"], [[nodes[node] for node in row[1:]] for row in rows], option.get("ELSET"))
        elif keyword in ("ELSET", "NSET"):
            index, named = (elements, sets) if keyword == "ELSET" else (nodes, node_sets)
            if "GENERATE" in option:
                rows = [map(str, range(int(a), int(b) + 1, *map(int, step))) for a, b, *step in rows]
            for word in [word for row in rows for word in row]:
                named[option[keyword]] += [index[word]] if word in index else named[word]
            internal |= {option[keyword]} if "INTERNAL" in option else set()
        elif keyword == "SURFACE":
            for of, *side in rows:
                number = int(re.sub(r"\D", "", "".join(side)) or 1) - 1
                for cell in [elements[of]] if of in elements else sets[of]:
                    dim, nodes, _ = cells[cell]
                    shift = FIRST_SIDE[len(nodes)] if dim == 3 else 0
                    sides[option["NAME"]].append((cell, (number + shift) % len(SIDES[dim, len(nodes)])))
    for name in [name for name in sets if name in node_sets]:  # Abaqus gives elements and nodes, of a face those at it
        of_cells = {node for cell in sets[name] for node in cells[cell][1]}
        del (node_sets if of_cells == set(node_sets[name]) else sets)[name]
    for name in internal:
        sets.pop(name, None)


def read_exodus(path):  # meshio leaves side sets and the names of blocks out
    import netCDF4
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        data = file.variables
        if any("nod_var" in name or "elem_var" in name for name in data):
            print("lost: fields and time steps")
        axes = data["coord"] if "coord" in data else [data[name][:] for name in data if re.match("coord[xyz]", name)]
        points.extend([float(x) for x in point] for point in zip(*axes))
        for kind in ("eb", "ss", "ns"):
            for k, number in enumerate(data.get(f"{kind}_prop1", []), 1):
                text = b"".join(data[f"{kind}_names"][k - 1]) if f"{kind}_names" in data else b""
                name = text.split(b"\0")[0].decode().strip() or str(number)
                if kind == "eb":
                    add(data[f"connect{k}"].elem_type, (data[f"connect{k}"][:] - 1).tolist(), name)
                elif kind == "ss":
                    sides[name] += zip(data[f"elem_ss{k}"][:] - 1, data[f"side_ss{k}"][:] - 1)
                else:
                    node_sets[name] += (data[f"node_ns{k}"][:] - 1).tolist()


def read_other(path, array):
    import meshio
    if path.suffix == ".vtu" and path.read_bytes().count(b"<Piece ") > 1:  # meshio takes the cells of the last one
        sys.exit(f"{path} is in several pieces: save it as one")
    mesh = meshio.read(path)
    points.extend(mesh.points.tolist())
    for block in mesh.cells:
        add(block.type, block.data.tolist())
    whole = [name for name, of in mesh.cell_data.items() if all(a.ndim == 1 and a.dtype.kind in "iu" for a in of)]
    if array not in [None, *whole] or (not array and len(whole) > 1):
        sys.exit(f"say which array of whole numbers names the parts: {' or '.join(whole) or 'the cells have none'}")
    array = array or "".join(whole)
    for cell, number in enumerate(number for of_block in mesh.cell_data.get(array, []) for number in of_block):
        sets[str(number)].append(cell)
    for name in sorted({*mesh.point_data, *mesh.cell_data} - {array, "medit:ref"}):
        print(f"lost: data {name}")


def name_parts(first):
    """Gives each cell one name, and adds the faces that only a side, a node set or nothing names."""
    for name, members in sorted(sets.items(), key=lambda item: (item[0] in first, -len(item[1]))):
        for cell in members:
            cells[cell][2] = name
    for name, members in sets.items():
        if other := Counter(cells[cell][2] for cell in members if cells[cell][2] != name):
            print(f"lost: name {name} of {sum(other.values())} cells of {', '.join(other)}")
    dim = max(cell[0] for cell in cells)
    faces = {cell: [[nodes[k] for k in side[:SIDE_NODES[dim, len(nodes)]]] for side in SIDES[dim, len(nodes)]]
             for cell, (d, nodes, _) in enumerate(cells) if d == dim and (dim, len(nodes)) in SIDE_NODES}
    every = [face for of_cell in faces.values() for face in of_cell]
    count = Counter(map(frozenset, every))
    outer = [face for face in every if count[frozenset(face)] == 1]
    named = [(name, nodes) for d, nodes, name in cells if d == dim - 1 and name]
    named += [(name, faces[cell][side] if cell in faces else cells[cell][1])
              for name, of in sides.items() for cell, side in of]
    for name, members in sorted(node_sets.items(), key=lambda item: len(item[1])):
        inside = set(members)
        named += [(name, face) for face in outer if inside.issuperset(face)]
    named.sort(key=lambda item: item[0] not in first)
    named += [("untagged", face) for face in outer if named]
    ordered = {frozenset(face): face for face in every}  # Abaqus's lines of degree 2 have the middle in the middle
    cells[:] = [cell for cell in cells if cell[0] != dim - 1]
    done = set()
    for name, face in named:
        key = frozenset(face)
        if key not in done:
            cells.append([dim - 1, ordered.get(key, face), name])
        done.add(key)
    for name in sorted({*sides, *node_sets} - {name for _, _, name in cells}):
        print(f"lost: set {name}, as its faces have other names, or no boundary face has only nodes of it")


def write(path):
    tags = {part: k for k, part in enumerate(sorted({(dim, name) for dim, _, name in cells if name}), 1)}
    rows = [["$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames"], [len(tags)]]
    rows += [[dim, tag, f'"{name}"'] for (dim, name), tag in tags.items()]
    rows += [["$EndPhysicalNames\n$Nodes"], [len(points)], *([k, *point, 0.0][:4] for k, point in enumerate(points, 1))]
    rows += [["$EndNodes\n$Elements"], [len(cells)]]
    for k, (dim, nodes, name) in enumerate(cells, 1):
        order = MSH_ORDER.get((dim, len(nodes)), range(len(nodes)))
        tag = tags.get((dim, name), 0)
        rows.append([k, MSH_TYPE[dim, len(nodes)], 2, tag, tag, *(nodes[n] + 1 for n in order)])
    path.write_text("".join(" ".join(map(str, row)) + "\n" for row in [*rows, ["$EndElements"]]))
    for (dim, name), number in sorted(Counter((dim, name) for dim, _, name in cells).items()):
        print(f"{['points', 'curve', 'surface', 'volume'][dim]} {name or 'without a name'}: {number} cells")


def main(source, target, *names):
    try:
        if source.suffix == ".inp":
            read_abaqus(source)
        elif source.suffix in (".e", ".exo", ".ex2", ".g"):
            read_exodus(source)
        else:
            read_other(source, *(names or [None]))
        name_parts(names)
    except ImportError as error:
        sys.exit(f"{error} (Debian: apt-get install python3-meshio, and run with /usr/bin/python3)")
    except Exception as error:
        sys.exit(f"{source} is no mesh that can be read: {error!r}")
    write(target)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), Path(sys.argv[2]), *sys.argv[3:])

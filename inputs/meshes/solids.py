#!/usr/bin/env python3
"""Meshes of hexahedra, prisms, pyramids and tetrahedra from a grid of boxes.

    python3 inputs/meshes/solids.py        writes twist.msh, body.msh and kinds.msh beside this file

A box of the grid is a hexahedron, two prisms (cut along z), or a star: around its centre a pyramid on each face,
two tetrahedra where a face is cut in two. A face is cut where the neighbour is a prism or a star without
pyramids, along the diagonal from its lowest corner, which both sides see.
"""
import itertools
import os

HERE = os.path.dirname(os.path.abspath(__file__))
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
FACES = {(0, 0, -1): (0, 3, 2, 1), (0, -1, 0): (0, 1, 5, 4), (-1, 0, 0): (0, 4, 7, 3),
         (1, 0, 0): (1, 2, 6, 5), (0, 1, 0): (2, 3, 7, 6), (0, 0, 1): (4, 5, 6, 7)}
MSH_TYPE = {"triangle": 2, "quadrilateral": 3, "tetrahedron": 4, "hexahedron": 5, "prism": 6, "pyramid": 7}


def is_cut(kind, other, direction):
    """Whether the face of a box of this kind is two triangles, `other` being behind it."""
    if "prism" in (kind, other) and direction[2] != 0:
        return True
    return kind == "tetrahedra" and other in ("tetrahedra", None)


def write(name, x, y, z, kind_of, boundary_of):
    """x, y, z: coordinates of the grid. kind_of(i, j, k): of a box, None: it is no part of the mesh.
    boundary_of(centre, direction): name of the boundary of a face whose neighbour is no part of it."""
    size = [len(x) - 1, len(y) - 1, len(z) - 1]
    nodes, cells, faces, number = [], [], {}, {}

    def node(key, position):
        if key not in number:
            number[key] = len(nodes) + 1
            nodes.append(position)
        return number[key]

    def kind(box):
        inside = all(0 <= b < s for b, s in zip(box, size))
        return kind_of(*box) if inside else None

    for box in itertools.product(*(range(s) for s in reversed(size))):
        box = box[::-1]
        here = kind(box)
        if here is None:
            continue
        grid = [tuple(b + c for b, c in zip(box, corner)) for corner in CORNERS]
        v = [node(g, (x[g[0]], y[g[1]], z[g[2]])) for g in grid]
        middle = [sum(nodes[n - 1][a] for n in v) / 8 for a in range(3)]
        if here == "hexahedron":
            cells.append((here, v))
        elif here == "prism":
            cells.append((here, [v[0], v[1], v[2], v[4], v[5], v[6]]))
            cells.append((here, [v[0], v[2], v[3], v[4], v[6], v[7]]))
        else:
            centre = node(box + ("centre",), tuple(middle))
        for direction, local in FACES.items():
            other = kind(tuple(b + d for b, d in zip(box, direction)))
            lowest = min(range(4), key=lambda c: grid[local[c]])
            a, b, c, d = (v[local[(lowest + s) % 4]] for s in range(4))
            cut = is_cut(here, other, direction)
            if here in ("star", "tetrahedra"):
                if cut:
                    cells += [("tetrahedron", [a, c, b, centre]), ("tetrahedron", [a, d, c, centre])]
                else:
                    cells.append(("pyramid", [a, d, c, b, centre]))
            if other is None:
                at = [sum(nodes[n - 1][s] for n in (a, b, c, d)) / 4 for s in range(3)]
                parts = [("triangle", [a, b, c]), ("triangle", [a, c, d])] if cut else [("quadrilateral", [a, b, c, d])]
                faces.setdefault(boundary_of(at, direction), []).extend(parts)
    groups = list(faces) + ["domain"]
    elements = [(t, g + 1, n) for g, group in enumerate(faces) for t, n in faces[group]]
    elements += [(t, len(groups), n) for t, n in cells]
    with open(os.path.join(HERE, name), "w") as out:
        out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%d\n" % len(groups))
        for g, group in enumerate(groups):
            out.write('%d %d "%s"\n' % (3 if group == "domain" else 2, g + 1, group))
        out.write("$EndPhysicalNames\n$Nodes\n%d\n" % len(nodes))
        for i, p in enumerate(nodes):
            out.write("%d %.16g %.16g %.16g\n" % (i + 1, *p))
        out.write("$EndNodes\n$Elements\n%d\n" % len(elements))
        for i, (t, g, n) in enumerate(elements):
            out.write("%d %d 2 %d %d %s\n" % (i + 1, MSH_TYPE[t], g, g, " ".join(map(str, n))))
        out.write("$EndElements\n")
    counts = {t: sum(1 for c in cells if c[0] == t) for t in dict.fromkeys(c[0] for c in cells)}
    print(name, len(nodes), "nodes", counts, {g: len(faces[g]) for g in faces})


def even(low, high, n):
    return [low + (high - low) * i / n for i in range(n + 1)]


def ends_or_sides(at, direction):
    return {-1: "bottom", 0: "sides", 1: "top"}[direction[2]]


def twist():
    """A bar of hexahedra, 1 x 1 x 2."""
    write("twist.msh", even(0, 1, 6), even(0, 1, 6), even(0, 2, 12), lambda i, j, k: "hexahedron", ends_or_sides)


def kinds():
    """All four types with every kind of face between them: from below hexahedra, stars, prisms, stars, hexahedra."""
    kind = ["hexahedron", "star", "prism", "star", "hexahedron"]
    write("kinds.msh", even(0, 1, 2), even(0, 1, 2), even(0, 2.5, 5), lambda i, j, k: kind[k], ends_or_sides)


def body():
    """A flat body 1 x 1/2 x 1/8 in a box 6 x 4 x 6: hexahedra around it, a layer of stars, columns of prisms above and
    below, tetrahedra elsewhere."""
    x = [-3, -1.9, -1.2, -0.8] + even(-0.5, 0.5, 4) + [0.8, 1.2, 1.9, 3]
    y = [-2, -1.2, -0.7, -0.4] + even(-0.25, 0.25, 2) + [0.4, 0.7, 1.2, 2]
    z = [-3, -1.9, -1.1, -0.5, -0.2] + even(-0.0625, 0.0625, 1) + [0.2, 0.5, 1.1, 1.9, 3]

    def kind(i, j, k):
        away = [max(low - b, b - high, 0) for b, low, high in ((i, 4, 7), (j, 4, 5), (k, 5, 5))]
        if 4 <= i <= 7 and 4 <= j <= 5 and k == 5:
            return None
        if max(away) <= 2:
            return "hexahedron"
        if max(away) == 3:
            return "star"
        return "prism" if away[2] > 3 and max(away[:2]) <= 3 else "tetrahedra"

    write("body.msh", x, y, z, kind, lambda at, d: "far" if max(abs(at[0]) / 3, abs(at[1]) / 2, abs(at[2]) / 3) > 0.999
          else "body")


if __name__ == "__main__":
    twist()
    kinds()
    body()

"""Small meshes and decks, made here, each with what has to come of it."""
import itertools
import math

import numpy as np

from cells import CELLS, HEXAHEDRON, PRISM, PYRAMID, QUADRILATERAL, TETRAHEDRON, TRIANGLE, reference, face_nodes, values
from meshes import write_msh

OF_NAME = {cell.name: cell for cell in CELLS}


def divided(cell, box):
    """A rectangle or cube, given by its vertices, in cells of this type: rows of vertices, positively oriented."""
    q = [np.array(v, float) for v in box]
    if cell in (QUADRILATERAL, HEXAHEDRON):
        return [q]
    if cell is TRIANGLE:
        return [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]
    if cell is PRISM:
        return [[q[k] for k in (0, 1, 2, 4, 5, 6)], [q[k] for k in (0, 2, 3, 4, 6, 7)]]
    if cell is PYRAMID:
        middle = sum(q) / 8
        return [[*(q[k] for k in reversed(face)), middle] for face in HEXAHEDRON.faces]
    found = []
    for order in itertools.permutations(range(3)):
        corner, path = np.zeros(3, int), [0]
        for axis in order:
            corner[axis] = 1
            path.append([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1),
                         (0, 1, 1)].index(tuple(corner)))
        v = [q[k] for k in path]
        found.append(v if np.linalg.det(np.array(v[1:]) - v[0]) > 0 else [v[1], v[0], *v[2:]])
    return found


def grid(cell, shape, size=None):
    """Cells of a grid over [0, size]."""
    step = [s / n for s, n in zip(size or shape, shape)]
    unit = QUADRILATERAL if len(shape) == 2 else HEXAHEDRON
    return [(cell, v) for at in itertools.product(*map(range, shape))
            for v in divided(cell, [[(a + c) * s for a, c, s in zip(at, corner, step)] for corner in unit.vertices])]


class Made:
    """A mesh of these cells in a degree; move: of all nodes; name: of a boundary face by its centre before that."""

    def __init__(self, cells, degree=1, move=None, name=lambda centre: "rest", apart=lambda centre: 0):
        self.number, self.x, self.elements, self.names = {}, [], [], {}
        dim, faces = cells[0][0].dim, {}
        for cell, vertices in cells:
            vertices = np.array(vertices)
            at = values(cell, 1, reference(cell, degree)) @ vertices
            side = apart(vertices.mean(axis=0))  # cells with different numbers share nodes where it says so
            of = [self.node(x, side(x) if callable(side) else side) for x in at]
            self.elements.append((cell.types[degree - 1], self.tag(dim, "domain"), of))
            for k in range(len(cell.faces)):
                face = [of[i] for i in face_nodes(cell, k, degree)]
                corners = vertices[list(cell.faces[k])]
                faces.setdefault(frozenset(face), []).append((cell.on_face(k), face, corners.mean(axis=0)))
        for rows in faces.values():
            if len(rows) == 1:
                cell, face, centre = rows[0]
                self.elements.append((cell.types[degree - 1], self.tag(dim - 1, name(centre)), face))
        self.x = np.array(self.x)
        if move:
            self.x = np.array([move(x) for x in self.x])

    def node(self, x, side):
        key = (*np.round(x, 9).tolist(), side)
        if key not in self.number:
            self.number[key] = len(self.x)
            self.x.append(x)
        return self.number[key]

    def tag(self, dim, name):
        tag = next((t for (d, t), n in self.names.items() if d == dim and n == name), None)
        if tag is None:
            tag = len(self.names) + 1
            self.names[dim, tag] = name
        return tag

    def write(self, path):
        write_msh(path, self.x, self.elements, self.names)


def write_su2(made, path):
    """Of a linear mesh."""
    kinds, dim = {1: 3, 2: 5, 3: 9, 4: 10, 5: 12, 6: 13, 7: 14}, len(made.x[0])
    of = {name: [e for e in made.elements if e[1] == tag] for (_, tag), name in made.names.items()}
    row = lambda e: " ".join(map(str, [kinds[e[0]], *e[2]]))
    lines = [f"NDIME= {dim}", f"NELEM= {len(of['domain'])}", *map(row, of.pop("domain")), f"NPOIN= {len(made.x)}",
             *(" ".join(map(repr, map(float, x))) + f" {i}" for i, x in enumerate(made.x)), f"NMARK= {len(of)}"]
    for name, rows in of.items():
        lines += [f"MARKER_TAG= {name}", f"MARKER_ELEMS= {len(rows)}", *map(row, rows)]
    path.write_text("\n".join(lines) + "\n")


def top_of(size):
    return lambda centre: "top" if abs(centre[-1] - size) < 1e-9 else "rest"


BULGE = {2: 'expression "x" "y + 0.4*x*(2 - x)"', 3: 'expression "x" "y" "z + 0.4*x*(2 - x)*y*(2 - y)"'}


def bulge(cell, degree, suffix=".msh"):
    """A top that bulges, beside a rest that is fixed."""
    made = Made(grid(OF_NAME[cell], (2,) * OF_NAME[cell].dim), degree, name=top_of(2))
    return made, [f"boundary top = {BULGE[OF_NAME[cell].dim]}", "boundary rest = fixed"], suffix


def crack(cell, shift=0.0, motion="fixed"):
    """Two by two squares or cubes with a slit from the left to the middle, its nodes doubled; shift: of its upper lip
    downwards."""
    dim = OF_NAME[cell].dim
    is_lip = lambda x: abs(x[dim - 1] - 1) < 1e-9 and x[0] < 1 - 1e-9
    cells = grid(OF_NAME[cell], (2,) * dim)
    made = Made(cells, 1, name=lambda c: "lips" if is_lip(c) else "outer",
                apart=lambda centre: lambda x: int(is_lip(x) and centre[dim - 1] > 1))
    upper = [i for key, i in made.number.items() if key[-1] == 1]
    made.x[upper, dim - 1] -= shift
    return made, [f"boundary outer = {motion}", f"boundary lips = {motion}"], ".msh"


def blocks(edges, gap=0.0):
    """Two blocks that touch along a line with 2 and with `edges` edges, as a mortar interface does."""
    upper = [(QUADRILATERAL, [v + [0, 1 + gap] for v in q]) for _, q in grid(QUADRILATERAL, (edges, 2), (2, 1))]
    name = lambda c: "interface" if abs(c[1] - 1) < 1e-3 else "outer"
    made = Made(grid(QUADRILATERAL, (2, 2), (2, 1)) + upper, 1, name=name, apart=lambda centre: int(centre[1] > 1))
    return made, ["boundary outer = fixed", "boundary interface = fixed"], ".msh"


def flat_corners(line="boundary all = translate 1 0"):
    """Two quadrilaterals have two edges in one line: their corners of 180 degrees are on the boundary."""
    cells = grid(QUADRILATERAL, (3, 3))
    drawn = {(0, 0): [0.5, 0.5], (3, 3): [2.5, 2.5]}
    return Made(cells, 1, move=lambda x: drawn.get(tuple(np.round(x).astype(int)), x)), [line], ".msh"


def ring(cell, degree, line):
    """A ring, 1 < r < 3, curved in its degree."""
    def round_(x):
        angle = 2 * math.pi * x[0] / 16
        return [(1 + x[1]) * math.cos(angle), (1 + x[1]) * math.sin(angle)]
    cells = [(c, v) for c, v in grid(OF_NAME[cell], (16, 4), (16, 2))]
    made = Made(cells, degree, name=lambda c: "inner" if c[1] < 1e-9 else "outer" if c[1] > 2 - 1e-9 else "seam")
    closed = {i: made.number[(0.0, *key[1:])] for key, i in made.number.items() if key[0] == 16.0}
    keep = [i for i in range(len(made.x)) if i not in closed]
    at = {old: new for new, old in enumerate(keep)}
    seam = made.tag(1, "seam")
    made.elements = [(kind, tag, [at[closed.get(i, i)] for i in of]) for kind, tag, of in made.elements if tag != seam]
    del made.names[1, seam]
    made.x = np.array([round_(x) for x in made.x[keep]])
    return made, [f"boundary inner = {line}", "boundary outer = slide", "objective = minimax"], ".msh"


def layer(degree):
    """Thin layers of hexahedra around a quarter of a cylinder, of which the wall alone is curved: it inverts elements
    and the planes beside it. What lies in the planes has to give way, and the wall to stay."""
    heights = [0, 0.01, 0.05, 0.4]
    cells = [(HEXAHEDRON, [np.array([a + u, h[w], c + v], float) for u, w, v in
                           [(0, 0, 1), (1, 0, 1), (1, 0, 0), (0, 0, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0), (0, 1, 0)]])
             for a in range(2) for h in zip(heights, heights[1:]) for c in range(1)]

    def bent(x):
        k = min(int(x[0] + 1e-9), 1)
        polar = lambda a, r: np.array([r * math.cos(a * math.pi / 4), r * math.sin(a * math.pi / 4)])
        straight = (1 + k - x[0]) * polar(k, 1 + x[1]) + (x[0] - k) * polar(k + 1, 1 + x[1])
        return [*(polar(x[0], 1) if x[1] < 1e-9 else straight), x[2]]
    name = lambda c: "wall" if c[1] < 1e-9 else "outer" if c[1] > 0.4 - 1e-9 else "planes"
    return Made(cells, degree, move=bent, name=name), ["boundary all = fixed"], ".msh"


def nose(line):
    """A triangle at the end of a strip is inverted: its tip is on the wrong side of the edge across."""
    made = Made([(TRIANGLE, v) for x in range(3) for v in divided(TRIANGLE, [[x, 0], [x + 1, 0], [x + 1, 1], [x, 1]])]
                + [(TRIANGLE, [[3, 0], [4, 0.5], [3, 1]])], name=lambda c: "nose" if c[0] > 3 else "far")
    tip = int(np.argmax(made.x[:, 0]))
    made.x[tip] = [2.7, 0.5]
    return made, ["ideal = regular", f"boundary nose = {line}", "boundary far = fixed"], ".msh"


def shuffled(cell, degree):
    """A node of the lower side is pushed along it past its neighbour: nodes of fixed boundaries have to give way."""
    push = lambda x: [2.4, 0.0] if abs(x[0] - 1) < 1e-9 and x[1] < 1e-9 else x
    made = Made(grid(OF_NAME[cell], (3, 3)), degree, move=push)
    return made, ["ideal = regular", "boundary all = fixed"], ".msh"


def pressed(count, degree=1):
    """Triangles that stand outward on a wall, of which the motion presses the tips of `count` into the wall."""
    made = Made(grid(TRIANGLE, (14, 1)) + [(TRIANGLE, [[x, 1], [x + 1, 1], [x + 0.5, 1.5]]) for x in range(14)], degree)
    return made, [f'boundary all = expression "x" "y - 0.7*max(y - 1, 0)*2*max(0, min(1, {count} - x))"'], ".msh"


def certified(check, result):
    if check.code != 0:
        last = check.console.strip().splitlines()[-1]
        check.say(f"exit code {check.code} where a certified mesh exists: {last[:120]}")


def refused(check, result):
    if check.code == 0:
        check.say("certified, but the boundary crosses itself by construction")


def wall_stays(check, result):
    certified(check, result)
    nodes = np.unique(np.concatenate([b.nodes[rows].ravel() for b, rows in check.mesh.groups(2)["wall"]]))
    at = {node: k for k, node in enumerate(result.ids.tolist())} if result else {}
    moved = [i for i in nodes if at and np.any(result.x[at[int(check.mesh.ids[i])]] != check.mesh.x[i])]
    if moved:
        far = max(np.linalg.norm(result.x[at[int(check.mesh.ids[i])]] - check.mesh.x[i]) for i in moved)
        check.say(f"{len(moved)} nodes of the wall have moved, by up to {far:.3g}, where nodes in planes could have")


def any_end(check, result):
    pass


# name -> (made, lines of the deck, suffix), what has to come of it, seconds or more: not in the quick part
CASES = {
    **{f"bulge-{cell}-{p}": (lambda cell=cell, p=p: bulge(cell, p), certified)
       for cell in ("triangle", "quadrilateral", "tetrahedron", "hexahedron", "prism", "pyramid") for p in (1, 2, 3, 4)
       if p <= 2 or OF_NAME[cell].dim == 2},
    "bulge-su2": (lambda: bulge("quadrilateral", 1, ".su2"), certified),
    **{f"crack-{cell}": (lambda cell=cell: crack(cell), certified) for cell in
       ("triangle", "quadrilateral", "hexahedron", "tetrahedron")},
    "crack-moved": (lambda: crack("triangle", 0, "rotate 20"), certified),
    "crack-crossing": (lambda: crack("triangle", 1e-5), refused),
    "blocks-3": (lambda: blocks(3), certified),
    "blocks-crossing": (lambda: blocks(3, -1e-4), refused),
    "flat-corners": (flat_corners, any_end),
    "flat-corners-improved": (lambda: flat_corners("ideal = regular\nboundary all = fixed"), any_end),
    "nose-free": (lambda: nose("free"), certified),
    "nose-slides": (lambda: nose("slide"), any_end),
    "nose-fixed": (lambda: nose("fixed"), any_end),
    "nose-all-slides": (lambda: (*nose("slide")[:1], ["ideal = regular", "boundary all = slide"], ".msh"), any_end),
    **{f"shuffled-{cell}-{p}": (lambda cell=cell, p=p: shuffled(cell, p), any_end)
       for cell in ("triangle", "quadrilateral") for p in (1, 2)},
    "pressed-3": (lambda: pressed(3), any_end),
    "pressed-12": (lambda: pressed(12), any_end),
    "ring-slides": (lambda: ring("triangle", 2, "rotate 30; translate 0.5 0"), certified),
    "ring-of-quadrilaterals": (lambda: ring("quadrilateral", 1, "rotate 40; translate 0.4 0"), certified),
    "layer-3": (lambda: layer(3), wall_stays),
}

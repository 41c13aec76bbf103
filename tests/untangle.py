#!/usr/bin/env python3
"""Meshes with inverted elements, made by disturbing grids, and whether `almesh improve` makes them valid.

    tests/untangle.py [--keep] [--seed=N] [NAME ...]  all cases, or those whose name contains one of these, with other
                                              random numbers; --keep: the meshes and results in the folder untangle

Every case has a solution: the grid itself, or what it was before. Prints a line for each case that fails, and the count.
Exit code 1 unless all come out certified."""
import itertools
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

ALMESH = Path(__file__).resolve().parent.parent / "almesh"
KUHN = list(itertools.permutations(range(3)))
TYPES = {"tri": 2, "quad": 3, "tet": 4, "hex": 5, "prism": 6, "pyramid": 7}


class Grid:
    """Cells of one kind on a box of n cells in each direction; nodes are indices of the lattice, mapped by `place`."""

    def __init__(self, kind, n, hole=0):
        self.kind, self.dim = kind, 2 if kind in ("tri", "quad") else 3
        self.x, self.cells, self.number = [], [], {}
        for corner in itertools.product(range(n), repeat=self.dim):
            if all(hole <= c < n - hole for c in corner) and hole:
                continue
            at = [tuple(c + s for c, s in zip(corner, step)) for step in itertools.product((0, 1), repeat=self.dim)]
            getattr(self, kind)(corner, at)
        self.of_hole = [i for p, i in self.number.items() if hole and all(hole <= c <= n - hole for c in p)]
        self.inner = [i for p, i in self.number.items() if all(0 < c < n for c in p) and i not in self.of_hole]
        # Nodes that slide along a side or face of the box, or along one of its edges, and in which directions.
        ways = {i: [k for k, c in enumerate(p) if 0 < c < n] for p, i in self.number.items() if i not in self.of_hole}
        self.sliding = {i: way for i, way in ways.items() if 0 < len(way) < self.dim}
        self.size = 1 / n
        for p, i in self.number.items():
            self.x[i] = [c / n for c in p] + [0] * (3 - self.dim)

    def node(self, p):
        if p not in self.number:
            self.number[p] = len(self.x)
            self.x.append(None)
        return self.number[p]

    def add(self, *points):
        self.cells.append([self.node(p) for p in points])

    def tri(self, corner, at):
        a, d, b, c = at
        for cell in ([(a, b, c), (a, c, d)] if sum(corner) % 2 else [(a, b, d), (b, c, d)]):
            self.add(*cell)

    def quad(self, _, at):
        self.add(at[0], at[2], at[3], at[1])

    def tet(self, corner, _):
        for path in KUHN:
            points = [corner]
            for axis in path:
                points.append(tuple(c + (k == axis) for k, c in enumerate(points[-1])))
            even = sum(path[i] > path[j] for i in range(3) for j in range(i + 1, 3)) % 2 == 0
            self.add(*(points if even else [points[0], points[2], points[1], points[3]]))

    def hex(self, _, at):
        self.add(*(at[k] for k in (0, 4, 6, 2, 1, 5, 7, 3)))

    def prism(self, _, at):
        for ring in ((0, 4, 6), (0, 6, 2)):
            self.add(*(at[k] for k in ring), *(at[k + 1] for k in ring))

    def pyramid(self, corner, at):
        top = tuple(c + 0.5 for c in corner)
        for base in ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)):
            self.add(*(at[k] for k in base), top)

    def text(self):
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(self.x))]
        lines += [f"{i + 1} {p[0]!r} {p[1]!r} {p[2]!r}" for i, p in enumerate(self.x)]
        lines += ["$EndNodes", "$Elements", str(len(self.cells))]
        lines += [f"{k + 1} {TYPES[self.kind]} 2 1 1 " + " ".join(str(i + 1) for i in cell)
                  for k, cell in enumerate(self.cells)]
        return "\n".join(lines + ["$EndElements", ""])


def turned(p, centre=0.5):
    """By 180 degrees in the plane of x and y around the middle, within the half of the box; outside linearly less."""
    r = max(abs(p[0] - centre), abs(p[1] - centre)) / centre
    s = 1 if r <= 0.5 else 2 - 2 * r
    return [centre + (1 - 2 * s) * (p[0] - centre), centre + (1 - 2 * s) * (p[1] - centre), p[2]]


def bend(x, angle):
    for p in x:
        r, a = 0.4 + p[0], angle * math.pi * p[1]
        p[:2] = [r * math.cos(a), r * math.sin(a)]


def slide(grid, how, rnd):
    """Nodes of the boundary along it: one past its neighbours, some onto others, or all to random places."""
    x, nodes = grid.x, list(grid.sliding)
    if "pushed" in how:
        i = rnd.choice(nodes)
        for k in grid.sliding[i]:
            by = (1.3 + rnd.random()) * grid.size
            x[i][k] += by if x[i][k] < 0.5 else -by
    elif "doubled" in how:
        for i in rnd.sample(nodes, max(1, len(nodes) // 8)):
            k = rnd.choice(grid.sliding[i])
            x[i][k] += grid.size if x[i][k] < 0.5 else -grid.size
    elif "shuffled" in how:
        for i in nodes:
            for k in grid.sliding[i]:
                x[i][k] = grid.size + (1 - 2 * grid.size) * rnd.random()
    if "random" in how:
        for i in grid.inner:
            x[i] = [rnd.random() if k < grid.dim else 0 for k in range(3)]


def shaped(p, dim, twist):
    """The box as a rounder one with four lobes, in 3D with bumps; twisted around z."""
    u = [2 * c - 1 for c in p[:dim]]
    r = math.hypot(*u)
    if r == 0:
        return [0, 0, 0]
    d = [c / r for c in u]
    wave = 0.1 * math.sin(4 * d[0]) * math.cos(5 * d[1] + d[-1]) if dim == 3 else -0.3 * math.cos(4 * math.atan2(*u))
    m = max(map(abs, u))  # a fifth as round as the disc: the corners stay corners
    x = [(0.8 * a + 0.2 * c * m) * (1 + m * wave) for a, c in zip(u, d)] + [0] * (3 - dim)
    a = twist * x[2]
    return [x[0] * math.cos(a) - x[1] * math.sin(a), x[0] * math.sin(a) + x[1] * math.cos(a), x[2]]


def tutte(grid):
    """Nodes inside at the mean of those that they share cells with."""
    around = {i: set() for i in grid.inner}
    for cell in grid.cells:
        for i in set(cell) & set(around):
            around[i] |= set(cell) - {i}
    for _ in range(300):
        for i, others in around.items():
            grid.x[i] = [sum(grid.x[j][k] for j in others) / len(others) for k in range(3)]


def disturb(grid, how, rnd):
    x, dim = grid.x, grid.dim
    inside = lambda: [rnd.random() if k < dim else 0 for k in range(3)]
    if how == "pushed":
        i = rnd.choice(grid.inner)
        for k in range(dim):
            x[i][k] += rnd.choice((-1, 1)) * (1.3 + rnd.random()) * grid.size
    elif how == "random":
        for i in grid.inner:
            x[i] = inside()
    elif how == "point":
        at = inside()
        for i in grid.inner:
            x[i] = list(at)
    elif how == "doubled":
        for i in rnd.sample(grid.inner, max(1, len(grid.inner) // 5)):
            x[i] = list(x[rnd.choice(grid.inner)])
    elif how == "noise":
        for i in grid.inner:
            for k in range(dim):
                x[i][k] += rnd.gauss(0, 0.7 * grid.size)
    elif how == "turned":
        for i in grid.inner:
            x[i] = turned(x[i])
    elif how.startswith("hole"):
        angle = math.radians(float(how[4:]))
        for i in grid.of_hole:
            u, v = x[i][0] - 0.5, x[i][1] - 0.5
            c, s = math.cos(angle), math.sin(angle)
            x[i][:2] = [0.5 + u * c - v * s, 0.5 + u * s + v * c]
    elif how.startswith("shape"):
        x[:] = [shaped(p, dim, 1.2 * ("twisted" in how)) for p in x]
        low, high = [min(p[k] for p in x) for k in range(3)], [max(p[k] for p in x) for k in range(3)]
        at = [rnd.uniform(0.2, 0.3) for _ in range(dim)] + [0] * (3 - dim)
        for i in grid.inner:
            x[i] = list(at) if "point" in how else [rnd.uniform(l, h) for l, h in zip(low, high)]
        if "tutte" in how:
            tutte(grid)
    elif how.startswith("side"):
        slide(grid, how, rnd)
        if "arc" in how:
            bend(x, 0.5)
    elif how.startswith("bent"):
        bend(x, 1.6)
        at = list(x[grid.inner[0]])
        for i in grid.inner:
            x[i] = list(at) if how == "bent-point" else [c + (k < dim) * rnd.gauss(0, 0.5) for k, c in enumerate(x[i])]
    elif how == "mirrored":
        for i in grid.inner:
            x[i][0] = 1 - x[i][0]


def curved(path, degree, rnd, scatter, share):
    """The mesh raised to this degree, this share of its nodes inside scattered."""
    out = path.parent / "raised"
    deck = path.parent / "raise.deck"
    deck.write_text(f"mesh = {path.name}\nboundary rest = fixed\ndegree = {degree}\nfinal = msh\nvtk = none\n"
                    f"output = {out}\nideal = given\n")
    subprocess.run([ALMESH, deck], capture_output=True, check=True)
    lines = (out / "final.msh").read_text().split("\n")
    start = lines.index("$Nodes") + 2
    for k in range(start, lines.index("$EndNodes")):
        i, *p = lines[k].split()
        p = [float(c) for c in p]
        dim = 2 if all(float(line.split()[3]) == 0 for line in lines[start:lines.index("$EndNodes")]) else 3
        if all(1e-9 < c < 1 - 1e-9 for c in p[:dim]) and rnd.random() < share:
            p = [c + rnd.gauss(0, scatter) if a < dim else c for a, c in enumerate(p)]
        lines[k] = " ".join([i] + [repr(c) for c in p])
    path.write_text("\n".join(lines))


def cases():
    for kind, sizes in (("tri", (5, 9)), ("tet", (3, 5)), ("quad", (4, 8)), ("hex", (3, 4)), ("prism", (3, 4)),
                        ("pyramid", (3,))):
        for how in ("pushed", "random", "point", "doubled", "noise", "turned", "mirrored"):
            for n in sizes:
                yield f"{kind}-{how}-{n}", kind, how, n, 1
    for kind, sizes in (("tri", (6, 9)), ("quad", (6, 9)), ("tet", (4,)), ("hex", (4,)), ("prism", (4,))):
        for how in ("bent-point", "bent-random"):
            for n in sizes:
                yield f"{kind}-{how}-{n}", kind, how, n, 1
    for kind, sizes in (("tri", (5, 9)), ("quad", (4, 8)), ("tet", (3, 5)), ("hex", (3, 4)), ("prism", (4,)),
                        ("pyramid", (3,))):
        for how in ("pushed", "doubled", "shuffled", "shuffled-random", "pushed-arc", "shuffled-arc"):
            for n in sorted({max(n, 4 * ("arc" in how)) for n in sizes}):  # three tangled rows tell no cylinder
                yield f"{kind}-side-{how}-{n}", kind, f"side-{how}", n, 1
    for kind, sizes in (("tri", (10, 16)), ("quad", (10, 16)), ("tet", (6,)), ("hex", (6,))):
        twists = ("", "twisted-") if kind in ("tet", "hex") else ("",)
        for how in itertools.product(twists, ("tutte", "random", "point")):
            for n in sizes:
                yield f"{kind}-shape-{''.join(how)}-{n}", kind, f"shape-{''.join(how)}", n, 1
    for kind, n in (("tri", 12), ("quad", 12), ("tet", 9), ("hex", 9)):
        for angle in (45, 90, 180):
            yield f"{kind}-hole-{angle}", kind, f"hole{angle}", n, 1
    for kind in ("tri", "quad", "tet", "hex"):
        for degree in (2, 3):
            for seed in (1, 2, 3):
                yield f"{kind}-scattered-{degree}-{seed}", kind, "none", 3 if kind in ("tri", "quad") else 2, degree
                yield f"{kind}-thrown-{degree}-{seed}", kind, "thrown", 8 if kind in ("tri", "quad") else 3, degree


def main():
    names = [a for a in sys.argv[1:] if not a.startswith("--")]
    seed = "".join(a[7:] for a in sys.argv[1:] if a.startswith("--seed="))
    chosen = [c for c in cases() if not names or any(n in c[0] for n in names)]
    certified = 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) if "--keep" not in sys.argv else Path("untangle")
        folder.mkdir(exist_ok=True)
        for name, kind, how, n, degree in chosen:
            rnd = random.Random(name + seed)
            grid = Grid(kind, n, n // 3 if how.startswith("hole") else 0)
            disturb(grid, how, rnd)
            path = folder / f"{name}.msh"
            path.write_text(grid.text())
            if degree > 1:
                curved(path, degree, rnd, *((0.3, 0.05) if how == "thrown" else (0.3 * grid.size, 1)))
            run = subprocess.run([ALMESH, "improve", path, f"output={folder / name}", "vtk=none", "threads=1"],
                                 capture_output=True, text=True)
            certified += run.returncode == 0
            if run.returncode != 0:
                print(f"{name}: exit code {run.returncode}: {(run.stderr or run.stdout).strip().splitlines()[-1]}")
    print(f"{certified} of {len(chosen)} cases certified")
    return 0 if certified == len(chosen) else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Closed surfaces (STL) and start meshes (MSH 2.2) that do not lie on them yet, for `onto`: numpy alone.

  plot/scan_surfaces.py FOLDER [NAME ...]    NAME: ellipsoid, bracket, vessel, staircase; default: all
  plot/scan_surfaces.py --coarse FOLDER      smaller ones

ellipsoid  tetrahedra of the unit ball; an ellipsoid with half axes 1, 1, 3
bracket    hexahedra of a cube; a rounded box. And of an L; a rounded bracket of that shape
vessel     hexahedra of a straight tube; a bent one with a bulge, both with flat ends
staircase  hexahedra cut from a grid, with a layer of cells around them; a smooth body of two balls that merge
"""
import argparse
import itertools
from pathlib import Path

import numpy as np

import cell_mesh

HEX = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])


def write_stl(path, x, triangles):
    """Binary, with normals of zero, which readers compute anew."""
    rows = np.zeros(len(triangles), np.dtype([("normal", "<3f4"), ("corner", "<9f4"), ("rest", "<u2")]))
    rows["corner"] = x[triangles].reshape(-1, 9)
    path.write_bytes(b"made by scan_surfaces.py".ljust(80) + np.uint32(len(triangles)).tobytes() + rows.tobytes())


def hexes(x, cells):
    mesh = cell_mesh.CellMesh(x, {5: (np.ones(len(cells), int), np.array(cells))})
    mesh.add_boundary()
    return mesh


def of_grid(inside, h, low):
    """The hexahedra of a grid that an array of truths chooses."""
    cells = np.argwhere(inside)
    corner = cells[:, None, :] + HEX[None]
    keys, number = np.unique(corner.reshape(-1, 3), axis=0, return_inverse=True)
    return hexes(np.array(low) + h * keys, number.reshape(-1, 8))


def tetrahedra(mesh):
    """Six of each hexahedron, around its diagonal."""
    nodes = mesh.blocks[5][1]
    steps = list(itertools.permutations(range(3)))
    index = {tuple(c): k for k, c in enumerate(HEX.tolist())}
    rows = []
    for order in steps:
        path, at = [0], [0, 0, 0]
        for axis in order:
            at[axis] = 1
            path.append(index[tuple(at)])
        even = np.linalg.det(np.eye(3)[list(order)]) > 0
        rows.append(nodes[:, path if even else [path[0], path[2], path[1], path[3]]])
    tets = np.concatenate(rows)
    result = cell_mesh.CellMesh(mesh.x, {4: (np.ones(len(tets), int), tets)})
    result.add_boundary()
    return result


def grid_box(low, high, n):
    """n: cells along each axis."""
    low, high = np.array(low, float), np.array(high, float)
    mesh = of_grid(np.ones(n, bool), 1.0, (0, 0, 0))
    mesh.x = low + mesh.x * (high - low) / n
    return mesh


def ball(n):
    """Tetrahedra of the unit ball: of a cube, each point taken along its ray to the sphere of its layer."""
    mesh = tetrahedra(grid_box((-1, -1, -1), (1, 1, 1), (n, n, n)))
    x = mesh.x
    largest = np.abs(x).max(axis=1)
    # Equal angles on the faces of the cube.
    tangent = np.tan(np.pi / 4 * np.divide(x, largest[:, None], out=np.zeros_like(x), where=largest[:, None] > 0))
    norm = np.linalg.norm(tangent, axis=1)
    round_ = np.divide(tangent, norm[:, None], out=np.zeros_like(x), where=norm[:, None] > 0) * largest[:, None]
    w = largest[:, None]
    mesh.x = w * round_ + (1 - w) * x / np.sqrt(3) * 1.2
    return mesh


def triangles_of(mesh):
    """Of its boundary; quadrilaterals as two."""
    if 2 in mesh.blocks:
        return mesh.blocks[2][1]
    q = mesh.blocks[3][1]
    return np.concatenate([q[:, [0, 1, 2]], q[:, [0, 2, 3]]])


def gradient(f, x):
    e = 1e-5
    return np.stack([(f(x + e * d) - f(x - e * d)) / (2 * e) for d in np.eye(3)], axis=1)


def to_zero(f, x, steps=8):
    """Points onto f = 0 along its gradient."""
    for _ in range(steps):
        g = gradient(f, x)
        x = x - (f(x) / np.maximum((g * g).sum(axis=1), 1e-12))[:, None] * g
    return x


def surface_of(f, low, high, h, rounds=30):
    """Triangles of f = 0: the faces of the grid's cells in f < 0, smoothed and taken to f = 0."""
    low, high = np.array(low, float), np.array(high, float)
    n = np.ceil((high - low) / h).astype(int)
    centre = low + h * (np.stack(np.meshgrid(*map(np.arange, n), indexing="ij"), -1) + 0.5)
    mesh = of_grid(f(centre.reshape(-1, 3)).reshape(n) < 0, h, low)
    triangles = triangles_of(mesh)
    used, triangles = np.unique(triangles, return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    x = mesh.x[used]
    edges = np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    edges = np.unique(np.sort(edges), axis=0)
    count = np.bincount(edges.ravel(), minlength=len(x))[:, None]
    for _ in range(rounds):
        mean = np.zeros_like(x)
        np.add.at(mean, edges[:, 0], x[edges[:, 1]])
        np.add.at(mean, edges[:, 1], x[edges[:, 0]])
        x = to_zero(f, 0.5 * x + 0.5 * mean / count, 2)
    return to_zero(f, x), triangles


def rounded(distance, r):
    return lambda x: distance(x) - r


def to_box(x, low, high):
    """Distance from a box; smooth outside alone."""
    d = np.maximum(np.maximum(np.array(low) - x, x - np.array(high)), 0)
    return np.linalg.norm(d, axis=1)


def smooth_min(a, b, k):
    h = np.maximum(k - np.abs(a - b), 0) / k
    return np.minimum(a, b) - h * h * h * k / 6


def rounded_box(x):
    return to_box(x, (-0.6, -0.4, -0.3), (0.6, 0.4, 0.3)) - 0.3


def rounded_l(x):
    return smooth_min(to_box(x, (0.3, 0.3, 0.3), (2.7, 0.7, 0.7)),
                      to_box(x, (0.3, 0.3, 0.3), (0.7, 2.2, 0.7)), 0.4) - 0.3


def two_balls(x):
    return smooth_min(np.linalg.norm(x - (-0.5, 0, 0), axis=1) - 1,
                      np.linalg.norm(x - (0.9, 0.2, 0.1), axis=1) - 0.7, 0.5)


def disc_of(n, layers):
    """Points of the unit disc and quadrilaterals: a square of n x n cells, and layers of cells around it."""
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, n + 1)] * 2, indexing="ij"), -1)
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], -1).reshape(-1, 4)
    rim = np.concatenate([number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]])
    core = 0.5 * grid.reshape(-1, 2)
    angle = -0.75 * np.pi + 2 * np.pi * np.arange(len(rim)) / len(rim)
    circle = np.stack([np.cos(angle), np.sin(angle)], 1)
    x, last = [core], rim
    for layer in range(1, layers + 1):
        w = layer / layers
        x.append((1 - w) * core[rim] + w * circle)
        ring = len(core) + (layer - 1) * len(rim) + np.arange(len(rim))
        quads = np.concatenate([quads, np.stack([last, ring, np.roll(ring, -1), np.roll(last, -1)], 1)])
        last = ring
    return np.concatenate(x), quads


def tube(centre, radius, stations, n, layers):
    """A disc of hexahedra, swept: centre(t) and radius(t, angle) for t in [0, 1]."""
    disc, quads = disc_of(n, layers)
    x = []
    for s in np.linspace(0, 1, stations + 1):
        along = centre(s + 1e-4) - centre(s - 1e-4)
        along /= np.linalg.norm(along)
        side = np.cross((0, 0, 1), along)
        side /= np.linalg.norm(side)
        r = radius(s, np.arctan2(disc[:, 1], disc[:, 0]))[:, None]
        x.append(centre(s) + r * (disc[:, :1] * side + disc[:, 1:] * np.cross(along, side)))
    steps = len(disc) * np.arange(stations)[:, None, None]
    return hexes(np.concatenate(x), np.concatenate([quads + steps, quads + steps + len(disc)], 2).reshape(-1, 8))


def with_layer(mesh, h):
    """One layer of cells around: nodes of the boundary are doubled, the inner ones go inward."""
    quads = mesh.blocks[3][1]
    normal = np.zeros_like(mesh.x)
    a, b, c, d = (mesh.x[quads[:, k]] for k in range(4))
    n = np.cross(c - a, d - b)
    for k in range(4):
        np.add.at(normal, quads[:, k], n)
    on = np.unique(quads)
    normal[on] /= np.linalg.norm(normal[on], axis=1)[:, None]
    outer = np.full(len(mesh.x), -1)
    outer[on] = len(mesh.x) + np.arange(len(on))
    height = np.full(len(mesh.x), float(h))
    cells = np.concatenate([mesh.blocks[5][1], np.hstack([quads, outer[quads]])])
    while True:
        result = hexes(np.concatenate([mesh.x, mesh.x[on] + height[on, None] * normal[on]]), cells)
        poor = result.scaled_jacobians()[-len(quads):] < 0.05
        if not poor.any():
            return result
        height[np.unique(quads[poor])] *= 0.7


def cells_inside(f, low, high, h, by):
    """Whether cells of a grid are inside f < -by; those that touch others at an edge or corner alone are filled."""
    n = np.ceil((np.array(high) - low) / h).astype(int)
    centre = np.array(low) + h * (np.stack(np.meshgrid(*map(np.arange, n), indexing="ij"), -1) + 0.5)
    inside = f(centre.reshape(-1, 3)).reshape(n) < -by
    while True:
        before = inside.sum()
        for axes in itertools.combinations(range(3), 2):  # two across an edge: fill both others
            pair = np.moveaxis(inside, axes, (0, 1))
            a, b, c, d = pair[:-1, :-1], pair[1:, :-1], pair[:-1, 1:], pair[1:, 1:]
            cross_, other = a & d & ~b & ~c, b & c & ~a & ~d
            b |= cross_
            c |= cross_
            a |= other
            d |= other
        if inside.sum() == before:
            return inside


def ellipsoid(folder, coarse):
    cell_mesh.write(ball(4 if coarse else 8), folder / "ellipsoid.msh")
    x = ball(10 if coarse else 20)
    write_stl(folder / "ellipsoid.stl", x.x * (1, 1, 3), triangles_of(x))


def bracket(folder, coarse):
    n = 4 if coarse else 8
    cell_mesh.write(grid_box((-0.8, -0.8, -0.8), (0.8, 0.8, 0.8), (n, n, n)), folder / "box.msh")
    write_stl(folder / "box.stl", *surface_of(rounded_box, (-1, -1, -1), (1, 1, 1), 0.1 if coarse else 0.05))
    inside = np.ones((3 * n // 2 + n // 2, 3 * n // 4 + n // 2, n // 2), bool)
    inside[n // 2:, n // 2:] = False
    mesh = of_grid(inside, 2 / n, (0, 0, 0))
    mesh.x *= np.array((3, 2.5, 1)) / mesh.x.max(axis=0)
    cell_mesh.write(mesh, folder / "bracket.msh")
    write_stl(folder / "bracket.stl", *surface_of(rounded_l, (0, 0, 0), (3, 2.5, 1), 0.1 if coarse else 0.05))


def vessel(folder, coarse):
    n, stations = (2, 12) if coarse else (4, 30)
    straight = tube(lambda t: np.array((4 * t, 0.1, 0.2)), lambda t, a: 0.5 + 0 * a, stations, n, n // 2)
    cell_mesh.write(straight, folder / "vessel.msh")
    bent = tube(lambda t: np.array((5 * np.sin(0.8 * t), 5 * (1 - np.cos(0.8 * t)), 0.3 * np.sin(3 * t))),
                lambda t, a: 0.45 + 0.2 * np.exp(-30 * (t - 0.6) ** 2) * (1 + 0.4 * np.cos(a)), 4 * stations, 2 * n, n)
    write_stl(folder / "vessel.stl", bent.x, triangles_of(bent))


def staircase(folder, coarse):
    h = 0.4 if coarse else 0.2
    low, high = (-1.7, -1.3, -1.3), (1.9, 1.3, 1.3)
    inside = cells_inside(two_balls, low, high, h, h)
    cell_mesh.write(with_layer(of_grid(inside, h, low), 0.5 * h), folder / "staircase.msh")
    write_stl(folder / "staircase.stl", *surface_of(two_balls, (-2, -2, -2), (2, 2, 2), h / 4))


CASES = {"ellipsoid": ellipsoid, "bracket": bracket, "vessel": vessel, "staircase": staircase}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--coarse", action="store_true")
    parser.add_argument("folder", type=Path)
    parser.add_argument("name", nargs="*", choices=[[], *CASES], default=[])
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    for name in arguments.name or CASES:
        CASES[name](arguments.folder, arguments.coarse)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Tests what measures meshes beside almesh: scaled Jacobians, corners and distances from faces, in plot/. numpy, scipy.

  tests/measures.py      exit code 1 where one is wrong
"""
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "plot"))
import cell_mesh  # noqa: E402
import corners  # noqa: E402
import face_distance  # noqa: E402

SQUARE, HIGH = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], 0.5 ** 0.5
TRIANGLE = [(0, 0, 0), (1, 0, 0), (0.5, 0.75 ** 0.5, 0)]
up = lambda base: [(x, y, 1) for x, y, _ in base]
REGULAR = {2: TRIANGLE, 3: SQUARE, 4: [*TRIANGLE, (0.5, 0.75 ** 0.5 / 3, (2 / 3) ** 0.5)], 5: SQUARE + up(SQUARE),
           6: TRIANGLE + up(TRIANGLE), 7: [*SQUARE, (0.5, 0.5, HIGH)]}  # by gmsh's types
RANDOM = np.random.default_rng(1)
FAULTS = []


def expect(what, error, most):
    if not error <= most:
        FAULTS.append(f"{what}: off by {error:.3g}")


def mesh_of(kind, x):
    return cell_mesh.CellMesh(x, {kind: (np.ones(1, int), np.arange(len(x))[None])})


def check_cell(kind, x):
    """A regular cell has 1, and its mirror image -1, which turn() makes 1; derivatives are those of differences."""
    mesh, name = mesh_of(kind, x), f"gmsh's type {kind}"
    expect(f"{name}, regular", abs(mesh.scaled_jacobians() - 1).max(), 1e-12)
    mirrored = mesh_of(kind, mesh.x * (-1, 1, 1))
    expect(f"{name}, mirrored", abs(mirrored.scaled_jacobians() + 1).max(), 1e-12)
    mirrored.turn()
    expect(f"{name}, turned", abs(mirrored.scaled_jacobians() - 1).max(), 1e-12)
    nodes, regular = corners.corners_of(mesh)
    of = corners.Corners(nodes, regular, mesh.x)
    y = mesh.x.copy()
    y[:, :mesh.dim] += 0.2 * RANDOM.normal(size=(len(y), mesh.dim))
    s, gradient = of.scaled(y)
    expect(f"{name}, least corner", abs(s.min() - mesh_of(kind, y).scaled_jacobians()[0]), 1e-12)
    weights, move = RANDOM.normal(size=len(s)), np.zeros_like(y)
    move[:, :mesh.dim] = 1e-6 * RANDOM.normal(size=(len(y), mesh.dim))
    difference = weights @ (of.scaled(y + move)[0] - of.scaled(y - move)[0]) / 2
    expect(f"{name}, derivative", abs(difference - (gradient(weights) * move).sum()) / 1e-6, 1e-7)


def check_improve():
    """A node of a grid of squares that is off its place comes back to it."""
    x = np.array([(i, j, 0) for j in range(3) for i in range(3)], float)
    x[4] = 1.6, 1.3, 0
    squares = np.array([(0, 1, 4, 3), (1, 2, 5, 4), (3, 4, 7, 6), (4, 5, 8, 7)])
    mesh = cell_mesh.CellMesh(x, {3: (np.ones(4, int), squares)})
    corners.improve(mesh)
    expect("improve", np.linalg.norm(mesh.x[4] - (1, 1, 0)), 0.02)


def check_distance(vertices):
    """Beside dense samples of warped faces, and on them."""
    q = np.stack(np.meshgrid(*[np.linspace(0, 1, 51)] * 2), axis=2).reshape(-1, 2)
    q = q[q.sum(axis=1) <= 1 + 1e-12] if vertices == 3 else q
    base = np.array({2: SQUARE[:2], 3: TRIANGLE, 4: SQUARE}[vertices], float)
    faces = base + (2, 0, 0) * RANDOM.integers(0, 9, (40, 1, 1)) + 0.1 * RANDOM.normal(size=(40, vertices, 3))
    if vertices == 2:
        q[:, 1] = 0
    samples = np.array([face_distance.surface(np.broadcast_to(f, (len(q), *f.shape)), q)[0] for f in faces])
    points = faces.mean(axis=1) + 0.3 * RANDOM.normal(size=(40, 3))
    sampled = np.linalg.norm(points[:, None] - samples.reshape(1, -1, 3), axis=2).min(axis=1)
    off = sampled - face_distance.distances(points, [faces])
    expect(f"distance from faces of {vertices} vertices", max(-off.min(), off.max() / 100), 2e-4)
    on = face_distance.distances(samples[:, ::97].reshape(-1, 3), [faces])
    expect("distance of points of such faces", on.max(), 1e-7)


def check_formats(folder):
    """Two triangles of two entities, whose nodes have gaps in their ids, in MSH 4.1 and 2.2."""
    x = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 2, 0)], float)
    mesh = cell_mesh.CellMesh(x, {2: (np.array([1, 2]), np.array([(0, 1, 2), (0, 2, 3)]))})
    cell_mesh.write(mesh, folder / "2.msh")
    (folder / "4.msh").write_text(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
        "$Nodes\n2 4 3 9\n0 1 0 1\n9\n0 2 0\n2 1 0 3\n3\n4\n7\n0 0 0\n1 0 0\n1 1 0\n"
        "$EndNodes\n$Elements\n2 2 1 2\n2 1 2 1\n1 3 4 7\n2 2 2 1\n2 3 7 9\n$EndElements\n")
    for name in ("2.msh", "4.msh"):
        read = cell_mesh.read(folder / name)
        expect(f"{name}, cells", abs(read.scaled_jacobians() - mesh.scaled_jacobians()).max(), 1e-12)
        expect(f"{name}, entities", abs(read.blocks[2][0] - (1, 2)).max(), 0)


def main():
    for kind, x in REGULAR.items():
        check_cell(kind, np.array(x, float))
    for vertices in (2, 3, 4):
        check_distance(vertices)
    check_improve()
    with tempfile.TemporaryDirectory() as folder:
        check_formats(Path(folder))
    print("\n".join(FAULTS) or "scaled Jacobians, corners and distances are what they should be")
    return 1 if FAULTS else 0


if __name__ == "__main__":
    sys.exit(main())

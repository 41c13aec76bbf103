"""Meshes that are inverted or poor, for compare_improve.py: grids of tests/untangle.py, meshes of gmsh that are disturbed,
gmsh's unoptimised ones, its hexahedra (four of each tetrahedron) and quadrilaterals (of pairs of triangles), and curved
ones of degree 2. Every case but the curved has a valid mesh with the same boundary.

  plot/improve_cases.py FOLDER NAME...   writes NAME.msh for those whose names contain one of the words
"""
import math
import sys
from pathlib import Path

import numpy as np

import cad
import cell_mesh

sys.path.insert(0, str(cad.ROOT / "tests"))
import random  # noqa: E402
import untangle  # noqa: E402


def grid(kind, how, n, seed):
    """A grid of tests/untangle.py, disturbed as there."""
    cells = untangle.Grid(kind, n, n // 3 if how.startswith("hole") else 0)
    untangle.disturb(cells, how, random.Random(seed))
    number = untangle.TYPES[kind]
    nodes = np.array(cells.cells)
    mesh = cell_mesh.CellMesh(cells.x, {number: (np.ones(len(nodes), int), nodes)})
    mesh.add_boundary()
    return mesh


def jittered(kind, n, seed, by=0.4):
    """A grid with every inner node moved by up to `by` of the edges, and less until the mesh is valid."""
    mesh = grid(kind, "none", n, seed)
    inner = ~mesh.boundary()
    x, move = mesh.x.copy(), np.random.default_rng(seed).uniform(-by / n, by / n, mesh.x.shape)
    move[~inner] = 0
    move[:, mesh.dim:] = 0
    while True:
        mesh.x = x + move
        if mesh.scaled_jacobians().min() > 0.01:
            return mesh
        for cell, nodes in mesh.cells():
            bad = cell_mesh.scaled_jacobians(mesh.x[nodes], cell) <= 0.01
            move[np.unique(nodes[bad])] *= 0.8


def meshed(shape, h, folder, order=1):
    """By gmsh (Delaunay), not optimised."""
    gmsh = cad.start_gmsh(h=h)
    occ = gmsh.model.occ
    dim = 2 if shape in ("disc", "plate", "ring") else 3
    if shape in ("torus", "ellipsoid"):
        gmsh.open(str(cad.ROOT / "inputs" / "cad" / f"{shape}.geo"))
    elif shape == "box":
        occ.addBox(0, 0, 0, 1, 1, 1)
    elif shape == "ball":
        occ.addSphere(0, 0, 0, 0.6)
    elif shape == "pipe":
        occ.cut([(3, occ.addCylinder(0, 0, 0, 0, 0, 2, 0.5))], [(3, occ.addCylinder(0, 0, 0, 0, 0, 2, 0.35))])
    elif shape == "cavity":
        occ.cut([(3, occ.addBox(-0.5, -0.5, -0.5, 1, 1, 1))], [(3, occ.addSphere(0, 0, 0, 0.2))])
    elif shape == "disc":
        occ.addDisk(0, 0, 0, 0.5, 0.5)
    elif shape == "plate":
        occ.cut([(2, occ.addRectangle(-0.5, -0.5, 0, 1, 1))], [(2, occ.addDisk(0, 0, 0, 0.2, 0.2))])
    elif shape == "ring":
        occ.cut([(2, occ.addDisk(0, 0, 0, 0.5, 0.5))], [(2, occ.addDisk(0, 0, 0, 0.46, 0.46))])
    if shape not in ("torus", "ellipsoid"):
        occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", h)
    for option in ("Optimize", "OptimizeNetgen", "HighOrderOptimize"):
        gmsh.option.setNumber("Mesh." + option, 0)
    return generated(gmsh, dim, folder, order)


def generated(gmsh, dim, folder, order=1):
    """The mesh of the model in gmsh, which ends."""
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    gmsh.model.mesh.generate(dim)
    gmsh.model.mesh.setOrder(order)
    gmsh.write(str(folder / "meshed.msh"))
    gmsh.finalize()
    mesh = cell_mesh.read(folder / "meshed.msh")
    (folder / "meshed.msh").unlink()
    mesh.blocks = {t: block for t, block in mesh.blocks.items() if cell_mesh.TYPES[t].dim >= dim - 1}
    used = np.unique(np.concatenate([nodes.ravel() for _, nodes in mesh.cells()]))
    number = np.zeros(len(mesh.x), int)
    number[used] = np.arange(len(used))
    return cell_mesh.CellMesh(mesh.x[used], {t: (e, number[nodes]) for t, (e, nodes) in mesh.blocks.items()})


def bracket(occ):
    angle = occ.cut([(3, occ.addBox(0, 0, 0, 4, 1, 3))], [(3, occ.addBox(1, -1, 1, 4, 3, 3))])[0]
    occ.cut(angle, [(3, occ.addCylinder(2.8, 0.5, -1, 0, 0, 3, 0.25)),
                    (3, occ.addCylinder(-1, 0.5, 2.2, 4, 0, 0, 0.25))])


def branch(occ):
    """A pipe with a stub."""
    outside = occ.fuse([(3, occ.addCylinder(0, 0, 0, 0, 0, 3, 1))],
                       [(3, occ.addCylinder(0, 0, 1.5, 2.5, 0, 0, 0.6))])[0]
    occ.cut(outside, [(3, occ.addCylinder(0, 0, -1, 0, 0, 5, 0.6))])


def drilled(occ):
    holes = ((1, 0.6, 0.3), (2.1, 1.3, 0.35), (3.2, 0.6, 0.25), (3.3, 1.45, 0.2))  # x, y, radius
    occ.cut([(3, occ.addBox(0, 0, 0, 4, 2, 0.5))], [(3, occ.addCylinder(x, y, -1, 0, 0, 3, r)) for x, y, r in holes])


def corner(occ):
    occ.cut([(3, occ.addBox(0, 0, 0, 2, 2, 1))], [(3, occ.addBox(0.8, 0.7, -1, 2, 2, 3))])


def polygon(occ, points):
    tags = [occ.addPoint(x, y, 0) for x, y in points]
    return occ.addPlaneSurface([occ.addCurveLoop([occ.addLine(a, b) for a, b in zip(tags, tags[1:] + tags[:1])])])


def pierced(occ):
    occ.cut([(2, occ.addRectangle(-1, -0.5, 0, 2, 1))],
            [(2, occ.addDisk(-0.3, 0.1, 0, 0.22, 0.22)), (2, occ.addDisk(0.5, -0.1, 0, 0.3, 0.12))])


def gear(occ):
    flank = ((0.1, 0.75), (0.4, 0.75), (0.5, 1), (0.9, 1))  # of a tooth: part of its turn, radius
    turns = [(2 * math.pi * (tooth + part) / 12, r) for tooth in range(12) for part, r in flank]
    occ.cut([(2, polygon(occ, [(r * math.cos(t), r * math.sin(t)) for t, r in turns]))],
            [(2, occ.addDisk(0, 0, 0, 0.3, 0.3))])


def sharp(occ):
    """A corner of 18 degrees, and one that enters."""
    polygon(occ, [(0, 0), (2, 0), (2, 1), (1.2, 0.62), (0.9, 0.9), (0.75, 0.25)])


def without_simplices(build, h, folder, **options):
    """By gmsh: hexahedra, four of each tetrahedron, or, with a RecombinationAlgorithm, quadrilaterals made of triangles
    of Delaunay's method, not smoothed. RecombinationAlgorithm: 1 blossom, 2 full-quad, 3 full-quad by blossom."""
    gmsh = cad.start_gmsh()
    build(gmsh.model.occ)
    gmsh.model.occ.synchronize()
    plane = {"RecombineAll": 1, "RecombineOptimizeTopology": 0, "Algorithm": 5, "Smoothing": 0}
    for option, value in {"MeshSizeMax": h, "MeshSizeMin": h / 2,
                          **(plane if options else {"SubdivisionAlgorithm": 2}), **options}.items():
        gmsh.option.setNumber("Mesh." + option, value)
    return generated(gmsh, 2 if options else 3, folder)


def disturbed(mesh, how, h, amount, seed):
    rng = np.random.default_rng(seed)
    inner = np.flatnonzero(~mesh.boundary())
    x, dim = mesh.x, mesh.dim
    if how == "pushed":  # so many nodes, by 1 to 2 h
        chosen = rng.choice(inner, amount, replace=False)
        move = rng.normal(size=(amount, dim))
        x[chosen, :dim] += h * rng.uniform(1, 2, (amount, 1)) * move / np.linalg.norm(move, axis=1, keepdims=True)
    elif how == "noise":
        x[inner, :dim] += rng.normal(0, amount * h, (len(inner), dim))
    elif how == "collapsed":  # all in a small ball, at random
        x[inner, :dim] = rng.normal(0, amount, (len(inner), dim))
    elif how == "turned":  # the inner boundary, by degrees; what is inside stays
        on = mesh.boundary() & (np.linalg.norm(x, axis=1) < 0.3)
        a, b = x[on, 0].copy(), x[on, 1].copy()
        c, s = np.cos(np.radians(amount)), np.sin(np.radians(amount))
        x[on, 0], x[on, 1] = c * a - s * b, s * a + c * b
    elif how == "compressed":  # the boundary; what is inside stays
        x[mesh.boundary(), dim - 1] *= amount
    return mesh


# name: (in the quick table, how it is made)
CASES = {
    "tri-random": (0, lambda folder: grid("tri", "random", 9, 1)),
    "tri-hole-180": (1, lambda folder: grid("tri", "hole180", 12, 1)),
    "quad-bent-random": (0, lambda folder: grid("quad", "bent-random", 9, 1)),
    "tet-random": (1, lambda folder: grid("tet", "random", 5, 1)),
    "tet-hole-90": (0, lambda folder: grid("tet", "hole90", 9, 1)),
    "hex-noise": (0, lambda folder: grid("hex", "noise", 4, 1)),
    "prism-noise": (0, lambda folder: grid("prism", "noise", 4, 1)),
    "disc-noise": (1, lambda folder: disturbed(meshed("disc", 0.025, folder), "noise", 0.025, 0.5, 1)),
    "plate-turned": (0, lambda folder: disturbed(meshed("plate", 0.03, folder), "turned", 0.03, 120, 1)),
    "box-pushed": (1, lambda folder: disturbed(meshed("box", 0.1, folder), "pushed", 0.1, 30, 1)),
    "ball-noise": (0, lambda folder: disturbed(meshed("ball", 0.08, folder), "noise", 0.08, 0.4, 1)),
    "ball-collapsed": (0, lambda folder: disturbed(meshed("ball", 0.1, folder), "collapsed", 0.1, 0.05, 1)),
    "cavity-turned": (0, lambda folder: disturbed(meshed("cavity", 0.08, folder), "turned", 0.08, 60, 1)),
    "box-compressed": (0, lambda folder: disturbed(meshed("box", 0.08, folder), "compressed", 0.08, 0.4, 1)),
    "box-pushed-large": (0, lambda folder: disturbed(meshed("box", 0.037, folder), "pushed", 0.037, 240, 1)),
    "box-poor": (1, lambda folder: meshed("box", 0.1, folder)),
    "ball-poor": (0, lambda folder: meshed("ball", 0.055, folder)),
    "pipe-poor": (0, lambda folder: meshed("pipe", 0.06, folder)),
    "cavity-poor": (0, lambda folder: meshed("cavity", 0.06, folder)),
    "tet-jittered": (1, lambda folder: jittered("tet", 12, 1)),
    "hex-jittered": (1, lambda folder: jittered("hex", 12, 1)),
    "tri-jittered": (0, lambda folder: jittered("tri", 40, 1)),
    "quad-jittered": (0, lambda folder: jittered("quad", 30, 1)),
    "bracket-hexes": (1, lambda folder: without_simplices(bracket, 0.35, folder)),
    "pipe-hexes": (0, lambda folder: without_simplices(branch, 0.35, folder)),
    "torus-hexes": (0, lambda folder: without_simplices(lambda occ: occ.addTorus(0, 0, 0, 1, 0.4), 0.3, folder)),
    "drilled-hexes": (0, lambda folder: without_simplices(drilled, 0.3, folder)),
    "corner-hexes": (0, lambda folder: without_simplices(corner, 0.3, folder)),
    "pierced-quads": (0, lambda folder: without_simplices(pierced, 0.03, folder, RecombinationAlgorithm=1)),
    "gear-quads": (0, lambda folder: without_simplices(gear, 0.03, folder, RecombinationAlgorithm=3)),
    "sharp-quads": (1, lambda folder: without_simplices(sharp, 0.03, folder, RecombinationAlgorithm=2)),
    "ring-curved": (0, lambda folder: meshed("ring", 0.5, folder, 2)),
    "torus-curved": (0, lambda folder: meshed("torus", 0.35, folder, 2)),
    "ellipsoid-curved": (0, lambda folder: meshed("ellipsoid", 0.4, folder, 2)),
}


def main(folder, *words):
    for name in (n for n in CASES if any(word in n for word in words)):
        mesh = CASES[name][1](Path(folder))
        cell_mesh.write(mesh, Path(folder) / f"{name}.msh")
        values = mesh.scaled_jacobians()
        print(f"{name}: {len(values)} cells, least {values.min():.4f}, not positive {(values <= 0).sum()}")


if __name__ == "__main__":
    main(*sys.argv[1:])

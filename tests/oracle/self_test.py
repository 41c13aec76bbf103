#!/usr/bin/env python3
"""Tests of the oracle itself: what is known of cells, files and motions, and errors that it has to find."""
import sys
import tempfile
from pathlib import Path

import run  # noqa: F401  with a Python that has numpy
import numpy as np

import cases
import geometry
from cells import CELLS, OF_TYPE, lattice, nodes, reference, values
from checks import Check, Points
from meshes import read
from motions import Deck, Moved

RANDOM = np.random.default_rng(4)


def test_nodes():
    for cell in CELLS:
        for p in range(1, 5):
            at, corner = np.array(nodes(cell, p)), p * np.array(cell.vertices)
            assert len(set(nodes(cell, p))) == len(at) == len(values(cell, p, reference(cell, p)))
            assert np.array_equal(at[:len(corner)], corner)
            edges = np.array(cell.edges)  # mid-edge nodes are midpoints, others divide the edge evenly
            for s in range(1, p):
                on_edge = at[len(corner) + s - 1:len(corner) + len(edges) * (p - 1):p - 1]
                assert np.array_equal(on_edge * p, (p - s) * corner[edges[:, 0]] + s * corner[edges[:, 1]])
            N = values(cell, p, reference(cell, p))
            assert np.allclose(N, np.eye(len(N)), atol=1e-11)


def test_maps():
    """Polynomial maps of degree p are reproduced, with their det J; volumes are those of the reference cells."""
    volume = dict(zip([c.name for c in CELLS], [1, 1 / 2, 1, 1 / 6, 1, 1 / 2, 1 / 3]))
    for cell in CELLS[1:]:
        n = cell.dim
        for p in range(1, 5):
            A, c = np.eye(n) + 0.2 * RANDOM.standard_normal((n, n)), 0.1 * RANDOM.standard_normal(n)
            physical = lambda abc: to_cell(cell, abc) @ A.T + c * (to_cell(cell, abc)[:, :1] ** p)
            block = type("Block", (), {"cell": cell, "degree": p})
            x = physical(reference(cell, p))
            block.nodes = np.arange(len(x))[None]
            points = lattice(cell, 5)[1:-1]
            assert np.allclose(values(cell, p, points) @ x, physical(points), atol=1e-11)
            exact = [np.linalg.det(A + np.outer(c, [p * xi[0] ** (p - 1), *[0] * (n - 1)]))
                     for xi in to_cell(cell, points)]
            assert np.allclose(geometry.determinants(block, x, points)[0], exact, atol=1e-9)
            straight = to_cell(cell, reference(cell, p)) @ A.T
            assert np.isclose(geometry.volumes(block, straight)[0], np.linalg.det(A) * volume[cell.name])
            one, of_eta, _ = geometry.distortion(block, straight, 3 * straight[:, ::-1] * ([-1] + [1] * (n - 1)))
            if n == 2:
                assert np.isclose(one, of_eta)  # a turn and a scaling do not distort


def to_cell(cell, abc):
    at = np.array(abc, float)
    if cell.name == "pyramid":
        at[:, :2] *= 1 - at[:, 2:]
    return at


def test_motions():
    deck = stand_in_deck("let a = 0.5\nlet b = 2*a")
    at = np.array([[1.0, 2.0, 0.5], [0.25, -1.0, 3.0]])
    move = lambda text: Moved(deck, text, Path(), *[Points(at, 3)] * 2, at).x
    assert np.array_equal(move("fixed"), at)
    assert np.allclose(move("translate a \"a^2\" 0; rotate 90 axis 0 0 1"),
                       np.stack([-at[:, 1] - 0.25, at[:, 0] + 0.5, at[:, 2]], axis=1))
    assert np.allclose(move('rotate "30*b" axis 0 0 2 about 1 2 0')[0], [1, 2, 0.5])
    assert np.allclose(move("scale 2 about 1 1 1"), 2 * at - 1)
    assert np.allclose(np.linalg.norm(move("sphere 1 0 0 2") - [1, 0, 0], axis=1), 2)
    assert np.allclose(np.hypot(*move("cylinder 0 0 0 0 0 3 2")[:, :2].T), 2)
    assert np.allclose(move('expression "-x^2" "max(y, 0) + sin(pi*z)" "atan2(y, x)"')[0],
                       [-1, 2 + 1, np.arctan2(2, 1)])
    turn = move("twist 30 axis 0 0 1")
    assert np.allclose(np.degrees(np.arctan2(turn[:, 1], turn[:, 0]) - np.arctan2(at[:, 1], at[:, 0])) % 360,
                       30 * at[:, 2] % 360)


def stand_in_deck(text):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.deck"
        path.write_text(text)
        return Deck(path)


def findings(made, change, claims=(), console="", lines=()):
    """Of a run that says that all is well and whose result is the mesh of the file but for a change."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        made.write(folder / "a.msh")
        (folder / "results").mkdir()
        count = len([e for e in made.elements if OF_TYPE[e[0]][0].dim == len(made.x[0])])
        summary = {"status": "converged", "certified_valid": "yes", "certified_injective": "yes", "nodes": len(made.x),
                   "elements": count, "relative_quality": 1, "max_distortion": 1, "nodes_off_target": 0,
                   "certified_bound": 0, "invalid_elements": 0, "max_boundary_error": 0, **dict(claims)}
        (folder / "results/summary.txt").write_text("".join(f"{k} = {v}\n" for k, v in summary.items()))
        change(made)
        made.write(folder / "results/final.msh")
        (folder / "a.deck").write_text("\n".join(["mesh = a.msh", *(lines or ["boundary all = fixed"])]))
        said = console or "certified valid and injective: certified bound 0; results in here"
        return Check(Deck(folder / "a.deck"), said, 0, folder / "results").all()


def test_mutations():
    """Nothing false is found where all is true, and each error is."""
    for cell in CELLS[1:]:
        for p in range(1, 3 if cell.dim == 3 else 5):
            make = lambda: cases.Made(cases.grid(cell, (2,) * cell.dim), p, name=cases.top_of(2))

            def fixed_by_one_ulp(made):
                node = made.elements[-1][2][0]
                made.x[node, 0] = np.nextafter(made.x[node, 0] + 1, 9) - 1 if made.x[node, 0] == 0 else \
                    np.nextafter(made.x[node, 0], 9)

            def inverted(made):  # a node inside, or a vertex of an element where there is none
                on_faces = {i for e in made.elements if OF_TYPE[e[0]][0].dim < cell.dim for i in e[2]}
                inside = next(i for i in range(len(made.x)) if i not in on_faces)
                made.x[inside] += 1.9

            def other_group(made):
                kind, tag, of = made.elements[-1]
                made.elements[-1] = (kind, next(t for d, t in made.names if d == cell.dim - 1 and t != tag), of)

            def other_nodes(made):
                kind, tag, of = made.elements[0]
                made.elements[0] = (kind, tag, [*of[1:len(OF_TYPE[kind][0].vertices)], of[0],
                                                *of[len(OF_TYPE[kind][0].vertices):]])
            has = lambda change, words, **more: any(words in text for text in findings(make(), change, **more))
            nothing = findings(make(), lambda made: None)
            assert not nothing, (cell.name, p, nothing)
            assert has(fixed_by_one_ulp, "nodes of fixed boundaries have moved"), (cell.name, p)
            assert has(inverted, "det J <= 0"), (cell.name, p)
            assert has(other_group, "other groups"), (cell.name, p)
            assert has(other_nodes, "other nodes"), (cell.name, p)
    make = lambda: cases.Made(cases.grid(CELLS[1], (2, 2)), 1, name=cases.top_of(2))
    nothing = lambda made: None
    for claims, words in (({"nodes": 8}, "nodes = 8"), ({"relative_quality": 0.99}, "relative_quality"),
                          ({"max_distortion": 1.1}, "max_distortion"), ({"certified_bound": 1.01}, "a sample is"),
                          ({"scaled_jacobian": 0.5}, "least of the corners"),
                          ({"nodes_off_target": 1, "status": "stalled"}, "exit code"),
                          ({"certified_injective": "no"}, "disagree")):
        assert any(words in text for text in findings(make(), nothing, claims)), (claims, words)
    assert any("next to nothing" in text for text in findings(
        make(), nothing, console="the last steps gained next to nothing; |grad E| is above omega_star\n"
                                 "certified valid and injective: certified bound 0; results in here"))
    moved = findings(make(), lambda made: made.x.__iadd__([1e-9, 0]), lines=["boundary all = translate 0 0"])
    assert any("not at their motion" in text for text in moved), moved


def test_overlaps():
    def found(made):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.msh"
            made.write(path)
            mesh = read(path)
            return len(geometry.overlaps(mesh, mesh.x, {id(b): np.ones(len(b.ids)) for b in mesh.cells})[0])
    for cell in ("triangle", "quadrilateral", "tetrahedron", "hexahedron"):
        assert not found(cases.crack(cell)[0]), cell
        assert found(cases.crack(cell, 1e-4)[0]), cell
    assert not found(cases.blocks(3)[0])
    assert found(cases.blocks(3, -1e-3)[0])


def main():
    geometry.PAIRS = {2: 200_000, 3: 100_000}
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"{name[5:]}: as it should be")


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""The module src/almesh.py and the shared library: tests/python.py [--library FILE] [--program FILE] [--bits] [TEST ...]

--bits: only, and of every quick deck, that the module's mesh has the bits of the program's. Otherwise the tests of
unittest, whose names may be given. With numpy and without it: run by an interpreter that has it, and by one that has
not, or with ALMESH_NO_NUMPY=1. Standard library only."""
import argparse
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import typing
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tests")]
if os.environ.get("ALMESH_NO_NUMPY"):
    sys.modules["numpy"] = None
PARSER = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
PARSER.add_argument("--library", default=os.environ.get("ALMESH_LIBRARY"))
PARSER.add_argument("--program", default=str(ROOT / "build" / "almesh"))
PARSER.add_argument("--bits", action="store_true")
PARSER.add_argument("--installed", action="store_true", help="the module that is installed, not that of src/")
OPTIONS, REST = PARSER.parse_known_args()
if OPTIONS.library:
    os.environ["ALMESH_LIBRARY"] = str(Path(OPTIONS.library).resolve())
if not OPTIONS.installed:
    sys.path.insert(0, str(ROOT / "src"))

import almesh
import reproduce
import verify

CIRCLE, SOLID = str(ROOT / "inputs/meshes/circle.msh"), str(ROOT / "inputs/meshes/cube.msh")


def flat(rows):
    return [v for row in rows.tolist() for v in row]


def circle():
    mesh = almesh.read(CIRCLE)
    mesh.boundary["inner"].translate(8, 0)
    mesh.boundary["outer"].fix()
    return mesh


class Moves(unittest.TestCase):
    def test_moves_and_tells(self):
        mesh, told = circle(), []
        before = flat(mesh.x)
        result = mesh.move(progress=told.append)
        self.assertTrue(result.certified)
        self.assertEqual(result.status, "converged")
        self.assertEqual(result.newton_iterations, sum(p.newton_step > 0 for p in told))
        self.assertLess(result.max_distortion, 1.3)
        self.assertEqual(result["relative_quality"], result.relative_quality)
        self.assertEqual(set(dir(result)) & {"status", "max_distortion"}, {"status", "max_distortion"})
        self.assertEqual(flat(mesh.first_x), before)
        inner = mesh.boundary["inner"].nodes.tolist()
        for node in inner:
            self.assertEqual(mesh.x.tolist()[node], [before[2 * node] + 8, before[2 * node + 1]])
        self.assertGreater(max(map(abs, flat(mesh.multipliers))), 0)
        self.assertGreater(min(mesh.quality().tolist()), 0)
        self.assertGreater(min(mesh.quality("certified_bound").tolist()), 0)
        self.assertGreaterEqual(min(mesh.quality("distortion").tolist()), 1)

    def test_arrays_are_copies(self):
        mesh = circle()
        x = mesh.x
        first = flat(x)
        mesh.move()
        self.assertEqual(flat(x), first)
        self.assertNotEqual(flat(mesh.x), first)

    def test_a_way_back_through_arrays(self):
        mesh = circle()
        cells = {of.type: of.nodes for of in mesh.elements}
        boundaries = {name: {of.type: of.nodes for of in part.faces} for name, part in mesh.boundary.items()}
        again = almesh.from_arrays(mesh.x, cells, boundaries)
        again.boundary["inner"].translate(8, 0)
        again.boundary["outer"].fix()
        mesh.move()
        again.move()
        self.assertEqual(flat(mesh.x), flat(again.x))

    def test_positions_are_a_motion(self):
        mesh, other = circle(), circle()
        mesh.move()
        x = [[p[0] + 8, p[1]] for p in other.first_x.tolist()]
        other.boundary["inner"].move_to(x)
        other.move()
        self.assertEqual(flat(mesh.x), flat(other.x))
        own = [x[node] for node in other.boundary["inner"].nodes.tolist()]
        other.boundary["inner"].move_to(own)
        other.move()
        self.assertEqual(flat(mesh.x), flat(other.x))
        other.move(degree=2)
        self.assertGreater(other.node_count, mesh.node_count)
        other.boundary["inner"].move_to(own)
        self.assertTrue(other.move(degree=1).certified)
        self.assertEqual(flat(mesh.x), flat(other.x))

    def test_frames_are_a_loop(self):
        mesh = circle()
        mesh.boundary["inner"].expression("x + 8*t", "y")
        status = [(r.status, r.certified) for r in mesh.frames([0.25, 0.5, 0.75, 1.0])]
        self.assertEqual(status, [("converged", True)] * 4)
        inner = mesh.boundary["inner"].nodes.tolist()
        shift = {mesh.x.tolist()[k][0] - mesh.first_x.tolist()[k][0] for k in inner}
        self.assertAlmostEqual(max(shift), 8)
        self.assertAlmostEqual(min(shift), 8)

    def test_solids_turn_and_motions_go_on(self):
        mesh = almesh.read(SOLID)
        name = next(iter(mesh.boundary))
        part = mesh.boundary[name].rotate(5, about=(0, 0, 0), axis=(0, 0, 1)).translate(0.01, 0, 0)
        self.assertEqual(part.motion, "rotate 5.0 axis 0.0 0.0 1.0 about 0.0 0.0 0.0; translate 0.01 0.0 0.0")
        mesh.boundary["rest"].free()
        self.assertTrue(mesh.move().certified)
        self.assertEqual(part.fix().motion, "fixed")
        self.assertEqual(mesh.boundary[name].translate(1, 0, 0).motion, "translate 1.0 0.0 0.0")

    def test_derivatives_fit_differences(self):
        mesh = circle()
        mesh.set("objective", "squared")
        mesh.move()
        dg = [[0.0, 0.0] for _ in range(mesh.node_count)]
        for node in mesh.boundary["inner"].nodes.tolist():
            dg[node] = [1.0, 0.5]
        dx = flat(mesh.tangent(dg))
        J = [[p[1], p[0] * 0.3] for p in mesh.x.tolist()]
        adjoint = flat(mesh.adjoint(J))
        by_tangent = sum(a * b for a, b in zip((v for row in J for v in row), dx))
        by_adjoint = sum(a * b for a, b in zip(adjoint, (v for row in dg for v in row)))
        self.assertAlmostEqual(by_tangent / by_adjoint, 1, places=8)

    def test_improves_and_saves(self):
        mesh = almesh.read(CIRCLE)
        before = min(mesh.quality().tolist())
        mesh.improve()
        self.assertGreater(min(mesh.quality().tolist()), before)
        with tempfile.TemporaryDirectory() as folder:
            mesh.save(Path(folder) / "out.msh")
            self.assertEqual(flat(almesh.read(Path(folder) / "out.msh").x), flat(mesh.x))

    def test_saves_a_proof_that_holds(self):
        mesh = almesh.read(CIRCLE)
        with tempfile.TemporaryDirectory() as folder:
            out, proof = Path(folder) / "out.msh", Path(folder) / "out.proof"
            mesh.save(out, proof=proof)
            self.assertEqual(verify.verify(out.read_bytes(), proof.read_text()), (mesh.element_count, 0))
            lines = out.read_text().split("\n")
            at = lines.index("$Nodes") + 2
            out.write_text("\n".join([*lines[:at], lines[at].split()[0] + " 9 9 0", *lines[at + 1:]]))
            proof.unlink()
            with self.assertRaises(almesh.NotCertified):
                almesh.read(out).save(out, proof=proof)
            self.assertFalse(proof.exists())

    def test_certificate_of_positions(self):
        mesh = circle()
        self.assertTrue(mesh.certify())
        x = mesh.x.tolist()
        x[mesh.elements[0].nodes.tolist()[0][0]] = [100.0, 100.0]
        verdict = mesh.certify(x)
        self.assertFalse(verdict)
        self.assertIn("element", verdict.reason)


class Errors(unittest.TestCase):
    def refused(self, kind, words, call, *arguments, **settings):
        with self.assertRaises(kind) as caught:
            call(*arguments, **settings)
        self.assertIn(words, str(caught.exception))
        return caught.exception

    def test_sentences(self):
        mesh = circle()
        self.refused(almesh.InputError, "nowhere.msh", almesh.read, "nowhere.msh")
        self.refused(almesh.UsageError, "did you mean", mesh.set, "omga", 1)
        self.refused(ValueError, "no 'inlet'", lambda: mesh.boundary["inlet"])
        self.refused(almesh.UsageError, "finite", mesh.certify, [[float("nan")] * 2] * mesh.node_count)
        self.refused(almesh.UsageError, "numbers given", mesh.certify, [[0.0, 0.0]])
        self.refused(almesh.UsageError, "array", mesh.certify, [["a", "b"]] * mesh.node_count)
        self.refused(almesh.UsageError, "code 0", mesh.set, "title", "a\0b")
        corner = [[0, 0], [1, 0], [0, 1]]
        self.refused(almesh.UsageError, "have 3 nodes each", almesh.from_arrays, corner, {"triangle": [[0, 1]]})
        self.refused(almesh.UsageError, "have 6 nodes each", almesh.from_arrays, corner, {"triangle": [[0, 1, 2]]},
                     degree=2)
        self.refused(almesh.UsageError, "indices", almesh.from_arrays, corner, {"triangle": [[0.5, 1, 2]]})
        self.refused(almesh.UsageError, "node -1", almesh.from_arrays, corner, {"triangle": [[0, 1, -1]]})
        self.refused(almesh.UsageError, "nodes x dim", almesh.from_arrays, [1, 2, 3], {})
        self.refused(almesh.UsageError, "no type of cells", almesh.from_arrays, [[0, 0]], {"pentagon": [[0]]})
        self.refused(almesh.UsageError, "", lambda: mesh.multipliers)
        self.refused(AttributeError, "no quantity", lambda: circle().move().quality_of_mine)
        mesh.close()
        self.refused(almesh.UsageError, "null", mesh.move)

    def test_a_run_that_fails_has_its_result(self):
        mesh = circle()
        error = self.refused(almesh.NotConverged, "", mesh.move, max_newton_iterations=1, continuation="never")
        self.assertEqual(error.result.status, "max_newton_iterations")
        self.assertTrue(mesh.certify())

    def test_progress_cancels_and_throws(self):
        mesh = circle()
        error = self.refused(almesh.Cancelled, "", mesh.move, progress=lambda p: p.newton_step == 2)
        self.assertFalse(error.result.certified and error.result.status == "converged")
        self.assertTrue(mesh.certify())
        self.refused(ZeroDivisionError, "division", mesh.move, progress=lambda p: 1 / 0)
        self.refused(almesh.UsageError, "another call", lambda: mesh.move(progress=lambda p: mesh.x is None))
        self.assertTrue(mesh.move().certified)

    def test_interrupt_ends_a_run(self):
        before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
        self.addCleanup(signal.signal, signal.SIGINT, before)
        mesh = circle()
        mesh.set("refine", 3)
        alarm = threading.Timer(0.6, lambda: os.kill(os.getpid(), signal.SIGINT))
        alarm.start()
        start = time.monotonic()
        try:
            with self.assertRaises(KeyboardInterrupt):
                while True:  # until the alarm
                    mesh.move()
        finally:
            alarm.join()
        self.assertLess(time.monotonic() - start, 30)
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)
        self.assertTrue(mesh.certify())


class Threads(unittest.TestCase):
    def test_the_interpreter_runs_meanwhile_and_bits_stay(self):
        alone = circle()
        alone.move()
        meshes, count = [circle() for _ in range(2)], [0]
        threads = [threading.Thread(target=mesh.move, kwargs={"refine": 2}) for mesh in meshes]
        for thread in threads:
            thread.start()
        while any(thread.is_alive() for thread in threads):
            count[0] += 1
            time.sleep(0.001)
        self.assertGreater(count[0], 3)
        self.assertEqual(flat(meshes[0].x), flat(meshes[1].x))

    def test_one_mesh_is_one_threads(self):
        mesh, begins, ends = circle(), threading.Event(), threading.Event()
        thread = threading.Thread(target=mesh.move, args=[lambda p: begins.set() or not ends.wait(60)])
        thread.start()
        self.assertTrue(begins.wait(60))
        with self.assertRaises(almesh.UsageError) as caught:
            mesh.certify()
        ends.set()
        thread.join()
        self.assertIn("another call", str(caught.exception))
        self.assertTrue(mesh.result.certified)


class Help(unittest.TestCase):
    def test_everything_is_documented_and_annotated(self):
        for name in almesh.__all__:
            self.assertTrue(getattr(almesh, name).__doc__, name)
        for kind in (almesh.Mesh, almesh.Boundary):
            for name, member in vars(kind).items():
                if name.startswith("_"):
                    continue
                self.assertTrue(member.__doc__, f"{kind.__name__}.{name}")
                if callable(member):
                    self.assertIn("return", member.__annotations__, name)
        self.assertTrue(all(key.meaning for key in almesh.keys().values()))
        self.assertTrue(all(almesh.motions().values()) and all(almesh.quantities().values()))
        self.assertTrue(typing.get_type_hints(almesh.Mesh.move))


def module_mesh(deck, folder):
    """The exit code of a deck by the module, and {id: position}."""
    mesh = almesh.read_deck(f"inputs/{deck}.deck")
    if deck in reproduce.FOLLOWS:
        leader, setting = reproduce.FOLLOWS[deck]
        mesh.set(*setting.format(Path(folder) / leader.replace("/", "-")).split("="))
    try:
        code = mesh.move().code
    except (almesh.NotConverged, almesh.NotCertified, almesh.ExpectationFailed) as error:
        code = error.code
    return code, dict(zip(mesh.node_ids.tolist(), mesh.x.tolist())), mesh.dim


def compare_bits(decks):
    """Whether the module's meshes of these decks have the bits of the program's."""
    different = 0
    os.chdir(ROOT)
    with tempfile.TemporaryDirectory() as folder:
        for deck in reproduce.in_order(decks):
            theirs = reproduce.Run([OPTIONS.program], deck, folder, 0)
            code, x, dim = module_mesh(deck, folder)
            same = all(x.get(i) == of[:dim] for i, *of in reproduce.nodes_of(theirs.folder / "final.msh"))
            different += not same or str(code) != theirs.values["exit_code"]
            print(f"{deck:32} {'same bits' if same else 'DIFFERS':9}  exit codes {theirs.values['exit_code']}, {code}",
                  flush=True)
    print(f"{different} differ")
    return different == 0


if __name__ == "__main__":
    if OPTIONS.bits:
        sys.exit(0 if compare_bits(REST or reproduce.QUICK) else 1)
    unittest.main(argv=[sys.argv[0], *REST])

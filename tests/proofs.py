#!/usr/bin/env python3
"""Proofs written by almesh are accepted by tests/verify.py, and false ones are refused with a reason.

    tests/proofs.py --program build/almesh [--quick] [MESH ...]

Small meshes of every cell and degree, their mutations, and the meshes that are named.
"""
import argparse, itertools, math, os, pathlib, shutil, subprocess, sys, tempfile, time
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import verify

AXES = {"triangle": (1, 2), "quadrilateral": (1, 3), "tetrahedron": (1, 2, 3), "hexahedron": (1, 3, 4),
        "prism": (1, 2, 3), "pyramid": (1, 3, 4)}
ENTRIES = {"triangle": (1, 2), "quadrilateral": (1, 3), "tetrahedron": (1, 2, 3), "hexahedron": (1, 3, 5),
           "prism": (1, 2, 4), "pyramid": (1, 3, 5)}
SWAP = {"triangle": (0, 1), "tetrahedron": (0, 1), "prism": (0, 1), "quadrilateral": (0, 1), "hexahedron": (0, 1),
        "pyramid": (0, 1)}
TYPE = {of: t for t, of in verify.TYPES.items()}


def linear_cells(cell):
    """Cells of the block 2 x 2 x 1 by the coordinates of their corners."""
    for i, j in itertools.product(range(2), range(2)):
        v = [(2 * (i + a), 2 * (j + b), 2 * c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        if cell == "triangle": rows = [(0, 1, 2), (0, 2, 3)]
        elif cell == "quadrilateral": rows = [(0, 1, 2, 3)]
        elif cell == "hexahedron": rows = [range(8)]
        elif cell == "prism": rows = [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)]
        elif cell == "pyramid":
            v.append((2 * i + 1, 2 * j + 1, 1))
            rows = [[int(k) for k in reversed(s)] + [8] for s in verify.CELLS["hexahedron"][3].split()]
        else:
            rows = []
            for order in itertools.permutations(range(3)):
                at, corners = [0, 0, 0], [0]
                for axis in order:
                    at[axis] = 1
                    corners.append(4 * at[2] + (2 * at[1] + (at[0] ^ at[1])))
                odd = sum(order[a] > order[b] for a in range(3) for b in range(a + 1, 3)) % 2
                rows.append([corners[k] for k in ((0, 2, 1, 3) if odd else (0, 1, 2, 3))])
        for row in rows: yield [v[k] for k in row]


class Mesh:
    def __init__(self, cell, p, place, cells=None):
        """place(x, y, z): where a node of the block goes."""
        self.cell, self.p, self.x, self.cells, known = cell, p, [], [], {}
        for corners in cells or linear_cells(cell):
            row = []
            for node in verify.lattice(cell, p):
                at = tuple(p * c + sum(node[e] * (corners[k][a] - c) for k, e in zip(AXES[cell], ENTRIES[cell]))
                           for a, c in enumerate(corners[0]))
                if at not in known:
                    known[at] = len(self.x) + 1
                    self.x.append(list(place(*(c / (2 * p) for c in at))))
                row.append(known[at])
            self.cells.append(row)

    def text(self):
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(self.x))]
        lines += [f"{i + 1} {x[0]!r} {x[1]!r} {x[2]!r}" for i, x in enumerate(self.x)]
        lines += ["$EndNodes", "$Elements", str(len(self.cells))]
        lines += [f"{e + 1} {TYPE[self.cell, self.p]} 2 1 1 " + " ".join(map(str, c)) for e, c in enumerate(self.cells)]
        return "\n".join(lines + ["$EndElements", ""]).encode()

    def turned(self, e):
        a, b = SWAP[self.cell]
        nodes = verify.lattice(self.cell, self.p)
        swapped = [tuple(n[b] if k == a else n[a] if k == b else n[k] for k in range(len(n))) for n in nodes]
        self.cells[e] = [self.cells[e][nodes.index(n)] for n in swapped]


def bent(dim):
    return lambda x, y, z: (x + 0.11 * y * y, y - 0.07 * x * x, z * (1 + 0.1 * x) if dim == 3 else 0.0)


def with_hash(proof, mesh):
    lines = proof.split("\n")
    return "\n".join("hash " + verify.fnv(mesh) if line.startswith("hash ") else line for line in lines)


def plain(count, mesh):
    return with_hash(f"almesh proof 1\nversion -\nhash -\nelements {count}\nend 5\n", mesh)


class Tests:
    def __init__(self, program, folder):
        self.program, self.folder, self.refused, self.accepted, self.wrong = program, folder, 0, 0, []

    def judge(self, mesh, proof):
        try: return verify.verify(mesh, proof) and None
        except verify.Refused as why: return str(why)
        except (KeyError, ValueError, IndexError, TypeError, StopIteration) as why: return f"not readable: {why!r}"

    def refuse(self, what, mesh, proof):
        why = self.judge(mesh, proof)
        if why: self.refused += 1
        else: self.wrong.append(f"accepted: {what}")

    def accept(self, what, mesh, proof):
        why = self.judge(mesh, proof)
        if why: self.wrong.append(f"refused: {what}: {why}")
        else: self.accepted += 1

    def written(self, mesh, path=None):
        path = path or self.folder / "m.msh"
        if mesh: path.write_bytes(mesh)
        proof = self.folder / "m.proof"
        proof.unlink(missing_ok=True)
        run = subprocess.run([self.program, "quality", path, f"proof={proof}"], capture_output=True, text=True, check=False)
        if not proof.exists(): return None, run.stdout.strip().split("\n")[-1] + run.stderr
        return proof.read_text(), ""

    def of_cell(self, cell, p):
        dim, name = sum(verify.CELLS[cell][0]), f"{cell} of degree {p}"
        build = lambda: Mesh(cell, p, bent(dim))
        good = build()
        mesh = good.text()
        proof, why = self.written(mesh)
        if not proof: return self.wrong.append(f"no proof: {name}: {why}")
        self.accept(name, mesh, proof)
        lines = proof.split("\n")
        for k in range(len(lines) - 1):
            self.refuse(f"{name}: line {k + 1} removed", mesh, "\n".join(lines[:k] + lines[k + 1:]))
            if k != 1 and k + 2 < len(lines): self.refuse(f"{name}: line {k + 1} swapped", mesh,
                                                         "\n".join(lines[:k] + [lines[k + 1], lines[k]] + lines[k + 2:]))
        self.refuse(f"{name}: a number changed", mesh, proof.replace(f"elements {len(good.cells)}", "elements 3"))
        self.refuse(f"{name}: a bit of the mesh", mesh.replace(b"$EndNodes", b"$EndNodes "), proof)
        for e in (0, len(good.cells) - 1):
            bad = build()
            bad.turned(e)
            self.refuse(f"{name}: element {e + 1} turned over", bad.text(), with_hash(proof, bad.text()))
        for node in sorted({good.cells[0][0], good.cells[0][-1], good.cells[-1][1]}):
            bad = build()
            x = bad.x[node - 1]
            bad.x[node - 1] = [a + (1.7 if abs(a - 1) < 0.1 else 2 * (1 - a)) for a in x[:2]] + x[2:]
            self.refuse(f"{name}: node {node} pulled through", bad.text(), with_hash(proof, bad.text()))
        twin = build()
        twin.cells.append(twin.cells[0])
        self.refuse(f"{name}: an element twice", twin.text(), plain(len(twin.cells), twin.text()))
        for gap in (-1e-12, -1e-3, 1e-12):
            blocks = [[(x + 6 * i, y, z) for x, y, z in c] for i in (0, 1) for c in linear_cells(cell)]
            two = Mesh(cell, p, lambda x, y, z, gap=gap: (x - (1 - gap if x > 2.5 else 0), y, z if dim == 3 else 0.0), blocks)
            what, mesh = f"{name}: two blocks {gap} apart", two.text()
            if gap < 0: self.refuse(what, mesh, plain(len(two.cells), mesh))
            elif p == 1 and cell in ("triangle", "quadrilateral", "tetrahedron"):
                self.accept(what, mesh, plain(len(two.cells), mesh))
        two = Mesh(cell, p, lambda x, y, z: (x - 1, y + 0.1, z if dim == 3 else 0.0) if x > 2.5 else (x, y, z), blocks)
        if p == 1:
            proof, why = self.written(two.text())
            if proof and "\ntouch " in proof:
                self.accept(f"{name}: two blocks that touch", two.text(), proof)
                line = proof.split("\n")[-3]
                for other in (line.replace("1e-09", "1e-3"), " ".join([*line.split()[:-1], "0,0,0,1e-09"]),
                              line.replace("touch", "pair")):
                    self.refuse(f"{name}: touching, changed", two.text(), proof.replace(line, other))
                fewer = proof.replace(line + "\n", "").replace(*(f"end {len(proof.split(chr(10))) - k}" for k in (1, 2)))
                self.refuse(f"{name}: touching, not named", two.text(), fewer)
            else: self.wrong.append(f"{name}: no proof of two blocks that touch: {why}")
            nearer = Mesh(cell, p, lambda x, y, z: (x - 1 - 1e-7, y + 0.1, z if dim == 3 else 0.0) if x > 2.5 else (x, y, z),
                          blocks)
            self.refuse(f"{name}: two blocks that do more", nearer.text(), with_hash(proof or "", nearer.text()))
        inside = Mesh(cell, p, lambda x, y, z: (((x - 6) / 8 + 0.9, y / 8 + 0.8, (z / 8 + 0.4 if dim == 3 else 0.0)) if x > 2.5
                                                else (x, y, z if dim == 3 else 0.0)), blocks)
        self.refuse(f"{name}: a block in a block", inside.text(), plain(len(inside.cells), inside.text()))
        for turns in (1.9, 2.3):
            ring = [[(x + 4 * i, y, z) for x, y, z in c] for i in range(12) for c in linear_cells(cell)]
            def wound(x, y, z, turns=turns):
                angle = 2 * math.pi * turns * x / 24
                return ((2 + y / 2) * math.cos(-angle), (2 + y / 2) * math.sin(-angle), z if dim == 3 else 0.0)
            twice = Mesh(cell, p, wound, ring)
            self.refuse(f"{name}: a ring around {turns} times", twice.text(), plain(len(twice.cells), twice.text()))

    def flat_by_one_unit(self):
        """A corner on a side, but for one unit in the last place."""
        for up in (1, -1):
            y = math.nextafter(0.1, up)
            m = Mesh("triangle", 1, lambda x, y, z: (x, y, z))
            m.x, m.cells = [[0.0, 0.1, 0.0], [3.0, 0.1, 0.0], [1.0, y, 0.0]], [[1, 2, 3]]
            (self.accept if up > 0 else self.refuse)("a flat triangle", m.text(), plain(1, m.text()))
            m = Mesh("tetrahedron", 1, lambda x, y, z: (x, y, z))
            m.x = [[0.0, 0.0, 0.1], [3.0, 0.0, 0.1], [0.0, 3.0, 0.1], [1.0, 1.0, y]]
            m.cells = [[1, 2, 3, 4]]
            (self.accept if up > 0 else self.refuse)("a flat tetrahedron", m.text(), plain(1, m.text()))

    def trees(self):
        """An element that has to be cut, and its tree changed."""
        m = Mesh("triangle", 2, lambda x, y, z: (x, y, 0.0))
        m.x = [[x / 64, y / 64, 0.0] for x, y in ((0, 0), (64, 0), (0, 64), (32, 11), (35, 42), (16, 40))]
        m.cells = [[1, 2, 3, 4, 5, 6]]
        mesh = m.text()
        proof, why = self.written(mesh)
        if not proof or "\nelement 1 " not in proof: return self.wrong.append(f"no tree: {why}")
        self.accept("a bent triangle", mesh, proof)
        for line in [line for line in proof.split("\n") if line.startswith(("element ", "pair "))]:
            *key, tree = line.split()
            key = " ".join(key) + " "
            for other in (key + ".", line[:-1], line + ".", key + tree[1:], key.replace("1", "2", 1) + tree, key.strip(),
                          key + tree.replace(".", "x", 1), line + "\n" + line, key + "9" + tree[1:], key + "-" + tree):
                self.refuse(f"{line} -> {other}", mesh, proof.replace(line, other))
        self.refuse("no tree", mesh, plain(1, mesh))


    def corners(self, program, count):
        """What the program says of two triangles with a common corner, beside exact arithmetic: never too much."""
        cases = self.folder / "corners"
        environment = {**os.environ, "ALMESH_CORNERS": str(cases), "ALMESH_COUNT": str(count)}
        subprocess.run([program, "-tc=two triangles at a corner*"], env=environment, capture_output=True, check=True)
        said = exact = false = 0
        with cases.open() as lines:
            for line in lines:
                is_apart, *words = line.split()
                ratio = [float.fromhex(word).as_integer_ratio() for word in words]
                scale = max(d for _, d in ratio)
                a = [n * (scale // d) for n, d in ratio]
                origin, *corner = [tuple(a[k:k + 3]) for k in range(0, 15, 3)]
                away = [verify.minus(x, origin) for x in corner[:2]] + [verify.minus(origin, x) for x in corner[2:]]
                is_true = verify.has_positive(lambda d: verify.farthest(away, d))
                said, exact, false = said + int(is_apart), exact + is_true, false + (int(is_apart) > is_true)
        print(f"{count} pairs of triangles at a corner: {exact} apart, {said} told to be, {false} of them falsely")
        if false or not said: self.wrong.append("triangles at a corner")

    def of_runs(self, decks, verb=()):
        """Every mesh that a run ends with, or has a frame of, and that is certified, has a proof that holds."""
        for deck in decks:
            results, begun = self.folder / "results", time.process_time()
            command = [self.program, *verb, deck, f"output={results}", "proof=yes", "vtk=none"]
            run = subprocess.run(command, capture_output=True, text=True, check=False)
            missing = [line for line in run.stderr.split("\n") if "no proof" in line]
            proofs = sorted(results.rglob("*.proof"))
            for proof in proofs:
                mesh = proof.with_name(proof.name + ".msh")
                mesh = mesh if mesh.exists() else next(m for m in (proof.with_suffix(".msh"), proof.with_suffix(".su2"))
                                                       if m.exists())
                self.accept(f"{deck}: {proof.name}", mesh.read_bytes(), proof.read_text())
            self.wrong += [f"{deck}: {line}" for line in missing]
            size = sum(proof.stat().st_size for proof in proofs)
            print(f"{deck}: code {run.returncode}, {len(proofs)} proofs, {size} bytes, checked in "
                  f"{time.process_time() - begun:.1f} s" + (f", {len(missing)} MISSING" if missing else ""), flush=True)
            shutil.rmtree(results, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default="build/almesh")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--tests", help="the program with the tests, for pairs of triangles at a corner")
    parser.add_argument("--decks", nargs="*", default=[])
    parser.add_argument("--improve", nargs="*", default=[], help="meshes that are improved first")
    parser.add_argument("meshes", nargs="*")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        tests = Tests(options.program, pathlib.Path(folder))
        tests.flat_by_one_unit()
        tests.trees()
        for cell, p in itertools.product(AXES, (1, 2, 3, 4)):
            if p == 1 or not options.quick: tests.of_cell(cell, p)
        if options.tests: tests.corners(options.tests, 10000 if options.quick else 1000000)
        tests.of_runs(options.decks)
        tests.of_runs(options.improve, ["improve"])
        for path in options.meshes:
            proof, why = tests.written(None, pathlib.Path(path))
            if proof: tests.accept(path, pathlib.Path(path).read_bytes(), proof)
            else: print(f"{path}: {why}")
    for sentence in tests.wrong: print(sentence)
    print(f"{tests.accepted} proofs accepted, {tests.refused} false ones refused, {len(tests.wrong)} judged wrongly")
    return 1 if tests.wrong else 0


if __name__ == "__main__": sys.exit(main())

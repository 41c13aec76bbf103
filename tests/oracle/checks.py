"""Holds files and sentences of a run against what its meshes are. Each finding is a sentence about something false."""
import csv
import re
from pathlib import Path

import numpy as np

import geometry
from cells import det, face_nodes, lattice, reference, values
from meshes import raised, read
from motions import Moved

ROUNDING = 1e-12  # of a position, relative to the largest coordinate or extent


def table(path):
    with open(path) as file:
        return dict(line.rstrip("\n").split(" = ", 1) for line in file if " = " in line)


def size_of(mesh):
    return max(np.abs(mesh.x).max(), np.ptp(mesh.x, axis=0).max())


class Points:
    """What Moved needs of a mesh."""

    def __init__(self, x, dim):
        self.ids, self.x, self.dim = np.arange(len(x)), x, dim


class Check:
    """Of one run: deck, what it printed, exit code, folder of its results."""

    def __init__(self, deck, console, code, output):
        self.deck, self.console, self.code, self.output = deck, console, code, Path(output)
        self.findings = []
        self.summary = table(self.output / "summary.txt") if (self.output / "summary.txt").exists() else {}
        self.improves = deck.value("ideal", "auto").split()[0] in ("regular", "size", "mesh")
        self.refine = int(deck.value("refine", 0))

    def say(self, *words):
        self.findings.append(" ".join(map(str, words)))

    def number(self, quantity, otherwise=0.0):
        value = self.summary.get(quantity, "none")
        return otherwise if value == "none" else float(value)

    def all(self):
        self.mesh = read(self.deck.keys["mesh"])
        self.signs_of_file()
        if self.code in (1, 2) or not self.summary:
            self.check_refusal()
            return self.findings
        self.check_console()
        if "frames" in self.deck.keys:
            with open(self.output / "frames.csv") as file:
                for number, row in enumerate(csv.DictReader(file), 1):
                    name = next(self.output.glob(f"frame-{number:04d}.[ms]*"), None)
                    if name:
                        self.check_result(self.numbered(read(name)), row["certified"] == "yes", row["certified"] == "yes",
                                          float(row["t"]), number, {"max_distortion": row["max_distortion"],
                                                                    "relative_quality": row["relative_quality"]})
            return self.findings
        for name in ("final.msh", "final.su2"):
            if (self.output / name).exists():
                self.check_result(self.numbered(read(self.output / name)), self.summary["certified_valid"] == "yes",
                                  self.summary["certified_injective"] == "yes", 0.0, 0, self.summary)
        return self.findings

    def numbered(self, result):
        """With the ids of the mesh file: SU2's are those of MSH less 1."""
        shift = int(result.is_su2) - int(self.mesh.is_su2)
        result.ids = result.ids + shift
        for block in result.blocks:
            block.ids = block.ids + shift
        return result

    # ---- the file

    def signs_of_file(self):
        """Per block and element: the sign of det J, of a mesh that is to be mended that of most elements."""
        self.signs = {}
        for block in self.mesh.cells:
            sign, straight = (np.sign(of(block, self.mesh.x)) for of in (geometry.volumes, geometry.straight_means))
            sign[sign != straight] = 0  # the result will tell
            if self.improves:
                sign[:] = 1 if np.sum(sign > 0) * 2 >= len(sign) else -1
            self.signs[block.cell] = dict(zip(block.ids.tolist(), sign.tolist()))

    def signs_in(self, mesh):
        return {id(b): np.array([self.signs.get(b.cell, {}).get(i, 0) for i in b.ids.tolist()]) for b in mesh.cells}

    def completed(self, mesh, signs):
        """Where the file does not tell it, as of new elements, it is that of the volume."""
        for block in mesh.cells:
            # Where the format changes: prisms of VTK are mirrored.
            known = signs[id(block)] * (self.refine == 0 and mesh.is_su2 == self.mesh.is_su2)
            if mesh.degree != self.mesh.degree:  # written anew, with det J > 0
                signs[id(block)] = known = np.abs(known)
            if not known.all():
                signs[id(block)] = np.where(known == 0, np.sign(geometry.volumes(block, mesh.x)), known)
        return signs

    def invalid_in_file(self):
        """Elements with det J <= 0 somewhere: their ids."""
        signs = self.completed(self.mesh, self.signs_in(self.mesh))
        return {int(i) for b in self.mesh.cells
                for i in b.ids[geometry.least_scaled(b, self.mesh.x, signs[id(b)]) <= 1e-12]}

    # ---- what was said

    def check_refusal(self):
        bad = self.invalid_in_file()
        if re.search(r"cross(es|ing)? itself|overlap", self.console) and not bad:
            self.check_crossing(self.mesh, self.completed(self.mesh, self.signs_in(self.mesh)))
        self.check_listed(self.doomed())
        lines = {name: text.split(";")[-1].strip() for name, (text, _) in self.deck.moves["boundary"].items()}
        if "let them slide" in self.console and all(text in ("slide", "free") for text in lines.values()):
            self.say("said that nodes are fixed, \"let them slide\", where all boundaries slide or are free")

    def doomed(self):
        """Elements that prescribed nodes alone make invalid: all their nodes, of linear ones those at a corner."""
        mesh = self.mesh
        if self.refine or int(self.deck.value("degree", 0)) not in (0, mesh.degree):
            return set()
        x, known = mesh.x.copy(), np.zeros(len(mesh.ids), bool)
        for _, nodes, _, moved in self.moves_of(mesh, 0.0, 0)[1]:
            nodes = nodes[moved.kind[nodes] == "moves"]
            x[nodes], known[nodes] = moved.x[nodes], True
        found, signs = set(), self.completed(mesh, self.signs_in(mesh))
        for block in mesh.cells:
            sign = signs[id(block)]
            bad = known[block.nodes].all(axis=1) & (geometry.least_scaled(block, x, sign) <= 1e-12)
            for v in range(len(block.cell.vertices)) if block.degree == 1 else []:
                at = [v, *(b if a == v else a for a, b in block.cell.edges if v in (a, b))]
                if len(at) == mesh.dim + 1:
                    corner = reference(block.cell, 1)[[v]]
                    J = geometry.jacobians(block.cell, 1, x[block.nodes][:, :, :mesh.dim], corner)
                    size = np.ptp(x[block.nodes], axis=1).max(axis=1) ** mesh.dim
                    bad |= known[block.nodes[:, at]].all(axis=1) & (sign * det(J)[:, 0] <= 1e-12 * size)
            found |= set(block.ids[bad].tolist())
        return found

    def check_crossing(self, mesh, signs):
        where, count = geometry.overlaps(mesh, mesh.x, signs)
        if not len(where):
            said = next(line for line in self.console.splitlines() if re.search("cross|overlap", line))
            self.say(f'said "{said[:100]}", but {count} points behind the boundary\'s faces are in one element each:',
                     "nothing crosses")

    def check_listed(self, bad):
        """Where elements are called invalid, all that are must be listed, the first ten by their ids."""
        said = re.search(r"(inverts?|inverted|flat|invalid|NOT certified)", self.console)
        if not bad or not said:
            return
        listed = {int(i) for i in re.findall(r"(?:triangle|quadrilateral|tetrahedron|hexahedron|prism|pyramid|element) "
                                             r"(\d+)", self.console)}
        listed |= {int(i) for i in re.findall(r"^ +(\d+) +\(", self.console, re.M)}
        files = [f.read_text() for pattern in ("*.csv", "*.txt") for f in self.output.glob(pattern)]
        listed |= {int(row.split(",")[0]) for f in files for row in f.splitlines() if re.match(r"\d+,", row)}
        if not bad <= listed:
            self.say(f"{len(bad)} elements are invalid, {len(bad - listed)} of them are not listed:",
                     sorted(bad - listed)[:10])

    def check_console(self):
        text, summary = self.console, self.summary
        certified, status = summary["certified_injective"] == "yes", summary["status"]
        said = re.search(r"^certified valid and injective: certified bound (\S+);", text, re.M)
        if "frames" not in self.deck.keys and bool(said) != certified:
            self.say("console and summary disagree on `certified`")
        if said and float(said[1]) > self.number("certified_bound") + 1e-12:
            self.say(f"console: certified bound {said[1]}, summary: {summary['certified_bound']}")
        if certified and summary["certified_valid"] != "yes":
            self.say("certified injective, but not valid")
        every = re.search(r"^every boundary node is .*$", text, re.M)
        if every and self.number("nodes_off_target"):
            self.say(f'said "{every[0][:60]}" with nodes_off_target = {summary["nodes_off_target"]}')
        work = re.search(r": (\d+) AL and (\d+) Newton iterations", text)
        if work and (work[1], work[2]) != (summary["al_iterations"], summary["newton_iterations"]):
            self.say(f"console: {work[0][2:]}, summary: {summary['al_iterations']} and {summary['newton_iterations']}")
        if status == "converged" and re.search(r"next to nothing", text):
            limit = next(line for line in text.splitlines() if "next to nothing" in line)
            self.say(f'status = converged with gradient_norm {summary.get("gradient_norm")}, and "{limit}"')
        fails = [e for e in self.deck.expected if not self.holds(e)]
        in_place = status in ("converged", "no_visible_gain")
        expected = (5 if fails else 0) if in_place and certified else 4 if in_place else 3
        if "frames" not in self.deck.keys and self.code != expected:
            self.say(f"exit code {self.code}; status, certificate and expectations give {expected}")
        if status == "converged" and not certified and re.search(r"cross|overlap|touch", text) \
                and summary["certified_valid"] == "yes":
            name = next(self.output.glob("final.*[!k]"))
            result = read(name)
            self.check_crossing(result, self.completed(result, self.signs_in(result)))
        if self.improves or summary["certified_valid"] != "yes":
            self.check_listed(set())

    def holds(self, expectation):
        quantity, relation, value, within = re.match(r"(\w+) *(<=|>=|=) *(\S+)(?: *\+- *(\S+))?", expectation).groups()
        got = self.summary.get(quantity, "none")
        try:
            got, value = float(got), float(value)
        except ValueError:
            return got == value and relation == "="
        if relation == "=":
            return abs(got - value) <= float(within or 0) + 1e-15 * abs(value)
        return got <= value if relation == "<=" else got >= value

    # ---- the result

    def check_result(self, result, valid, injective, t, frame, numbers):
        at = f"frame {frame}: " if frame else ""
        before = len(self.findings)
        self.check_topology(result)
        is_same = len(self.findings) == before
        signs = self.completed(result, self.signs_in(result))
        self.check_jacobians(result, signs, valid)
        if injective:
            where, count = geometry.overlaps(result, result.x, signs)
            if len(where):
                self.say(f"certified injective, but {len(where)} of {count} points are in several elements, such as",
                         where[0].tolist())
        self.check_boundaries(result, t, frame)
        if is_same and not (self.improves or self.refine or self.number("split_elements")):
            self.check_distortion(result, numbers)
        self.check_volume_rows(result)
        self.check_table(result, signs)
        self.findings[before:] = [at + text for text in self.findings[before:]]

    def check_topology(self, result):
        mesh, same = self.mesh, self.refine == 0 and result.degree == self.mesh.degree
        divided = int(self.number("split_elements"))  # and those at the same edges
        for quantity, count in (("nodes", len({int(i) for b in result.cells for i in b.nodes.ravel()})),
                                ("elements", sum(len(b.ids) for b in result.cells))):
            if quantity in self.summary and int(self.summary[quantity]) != count:
                self.say(f"{quantity} = {self.summary[quantity]}, the file has {count}")
        must = set(mesh.ids.tolist()) if result.degree == mesh.degree else \
            {int(i) for b in mesh.cells for i in mesh.ids[b.nodes[:, :len(b.cell.vertices)]].ravel()}
        if len(set(result.ids.tolist())) != len(result.ids) or not must <= set(result.ids.tolist()):
            self.say("ids of nodes are not kept")
        if same and not divided and mesh.ids.tolist() != result.ids.tolist():
            if sorted(mesh.ids.tolist()) != sorted(result.ids.tolist()):
                self.say("the nodes have other ids")
        if result.is_su2 and not mesh.is_su2:
            return
        kept = {(b.cell, int(i)): b.ids.size and (tuple(mesh.ids[n[:len(b.cell.vertices if not same else n)]]), g)
                for b in mesh.blocks for i, n, g in zip(b.ids, b.nodes, b.groups)}
        wrong, groups, missing = [], [], set(kept)
        if self.refine == 0 and not mesh.is_su2:
            for b in result.blocks:
                for i, n, g in zip(b.ids, b.nodes, b.groups):
                    old = kept.get((b.cell, int(i)))
                    missing.discard((b.cell, int(i)))
                    if old is None:
                        continue
                    now = tuple(result.ids[n[:len(old[0])]])
                    if old[0] != now and (same or sorted(old[0]) != sorted(now)):
                        wrong.append(int(i))
                    if {mesh.name(x) for x in old[1]} != {result.name(x) for x in g}:
                        if old[1] or b.cell.dim == mesh.dim:
                            groups.append(int(i))
            if missing and not divided:
                self.say(f"{len(missing)} elements of the file are missing, such as",
                         sorted(i for _, i in missing)[:5])
            if wrong and not divided:
                self.say(f"{len(wrong)} elements have other nodes, such as", wrong[:5])
            if groups:
                self.say(f"{len(groups)} elements are in other groups, such as", groups[:5])
        for dim in (mesh.dim - 1, mesh.dim):
            was, now = ({name: sum(len(rows) for _, rows in of) for name, of in m.groups(dim).items()}
                        for m in (mesh, result))
            for name in was:
                if name not in now or (self.refine == 0 and not divided and was[name] != now[name]):
                    self.say(f"group {name} has {now.get(name, 0)} elements, in the file {was[name]}")
            new = {name for name in set(now) - set(was) if not name.startswith("zone-")}
            if new and not self.deck.moves["select"]:
                self.say(f"groups that the file has not: {sorted(new)}")
        used = {int(i) for b in mesh.blocks for i in b.nodes.ravel()}
        number = {node: k for k, node in enumerate(result.ids.tolist())}
        loose = [k for k in range(len(mesh.ids)) if k not in used and int(mesh.ids[k]) in number]
        moved = [int(mesh.ids[k]) for k in loose if np.any(mesh.x[k] != result.x[number[int(mesh.ids[k])]])]
        if moved:
            self.say(f"nodes without an element have moved: {moved[:5]}")

    def check_jacobians(self, result, signs, valid):
        least, inverted = np.inf, []
        for block in result.cells:
            of = geometry.least_scaled(block, result.x, signs[id(block)])
            least = min(least, of.min())
            inverted += block.ids[of <= 0].tolist()
        if valid and inverted:
            self.say(f"certified valid, but det J <= 0 in {len(inverted)} elements, such as {inverted[:5]}")
        claim = self.number("certified_bound", -np.inf) if "frames" not in self.deck.keys else -np.inf
        if least < claim - 1e-9:
            self.say(f"certified_bound = {claim}, but a sample is {least:.9g}")
        corners = min(geometry.corner_jacobians(b, result.x, signs[id(b)]).min(initial=1) for b in result.cells)
        claim = self.number("scaled_jacobian", corners) if "frames" not in self.deck.keys else corners
        if abs(corners - claim) > 1e-5 * abs(claim) + 1e-9:  # six digits
            self.say(f"scaled_jacobian = {claim}, but the least of the corners is {corners:.9g}")
        if int(self.number("invalid_elements")) < len(inverted):
            self.say(f"invalid_elements = {self.summary['invalid_elements']}, but {len(inverted)} are")

    def ideal_of(self, result):
        given = self.deck.value("ideal", "auto") == "given" or "(ideal = given)" in self.console
        if given:
            return raised(self.mesh, self.mesh.x, result)
        ideal = result.x.copy()
        vertices = raised(self.mesh, self.mesh.x, result)
        for block in result.cells:
            N = values(block.cell, 1, reference(block.cell, block.degree))
            ideal[block.nodes] = np.einsum("pn,ena->epa", N, vertices[block.nodes[:, :N.shape[1]]])
        return ideal

    def check_distortion(self, result, numbers):
        """q is an integral, the largest eta one of quadrature points: not above that of a dense lattice, nor below the
        least of any element."""
        ideal = self.ideal_of(result)
        one = of_eta = largest = root = 0.0
        for block in result.cells:
            a, b, eta = geometry.distortion(block, ideal, result.x)
            one, of_eta, largest = one + a, of_eta + b, max(largest, np.nanmax(eta))
            if not geometry.is_straight(block):
                n = block.cell.dim
                points = lattice(block.cell, 8 * block.degree if n == 2 else 2 * block.degree + 2)
                worst = np.argsort(-eta.max(axis=1))[:200]
                J, A = (geometry.jacobians(block.cell, block.degree, x[block.nodes[worst]][:, :, :n], points)
                        for x in (result.x, ideal))
                F = np.linalg.inv(A) @ J
                with np.errstate(all="ignore"):
                    dense = np.sum(F * F, axis=(2, 3)) / (n * np.abs(det(F)) ** (2 / n))
                largest, root = max(largest, np.nanmax(dense)), max(root, eta.min(axis=1).max())
            else:
                root = max(root, eta.max())
        q, straight = np.sqrt(one / of_eta), all(map(geometry.is_straight, result.cells))
        said = float(numbers["relative_quality"]), float(numbers["max_distortion"])
        sharp, within = (2e-6, 1e-6) if straight else (3e-3, 0.02) if largest < 10 else (3e-2, 0.2)  # of peaks of eta
        if not abs(said[0] - q) <= sharp * q:
            self.say(f"relative_quality = {said[0]}, it is {q:.7g}")
        if not root * (1 - 1e-6) <= said[1] <= largest * (1 + within):
            self.say(f"max_distortion = {said[1]}, samples are from {root:.7g} to {largest:.7g}")

    def check_volume_rows(self, result):
        block = re.search(r"^volume +elements +energy.*\n((?:\S+ +\d+ .*\n)+)", self.console, re.M)
        counts = {name: sum(len(r) for _, r in of) for name, of in result.groups(result.dim).items()}
        for row in block[1].splitlines() if block else []:
            name, count = row.split()[:2]
            if name in counts and counts[name] != int(count):
                self.say(f"volume {name}: said {count} elements, the file has {counts[name]}")
        change = re.search(r"^change of (?:area|volume) relative to the file: [^,\n]* (\S+)$", self.console, re.M)
        if change and not self.refine and len(counts) < 2:
            was, now = (sum(np.abs(geometry.volumes(b, m.x)).sum() for b in m.cells) for m in (self.mesh, result))
            said = abs(float(change[1]))  # two digits
            if not self.invalid_in_file() and abs(abs(now - was) / was - said) > 0.05 * said + 1e-9:
                self.say(f"said change of volume {change[1]}, it is {(now - was) / was:.3g}")

    def check_table(self, result, signs):
        """What `improve` says of corners before and after: the least, the mean, how many are not above a value."""
        heading = "".join(re.findall(r"^elements +least.*", self.console, re.M))
        bounds = [float(b) for b in re.findall(r"< (\S+)", heading)]
        was = self.completed(self.mesh, self.signs_in(self.mesh))
        for mesh, when, of in ((self.mesh, "scaled Jacobian[ *] before", was), (result, " +after", signs)):
            row = re.search(rf"^{when} +(\S+) +(\S+)((?: +\d+)+)", self.console, re.M)
            if not row or self.refine or len(mesh.cells[0].nodes) == 0:
                continue
            J = np.concatenate([geometry.corner_jacobians(b, mesh.x, of[id(b)]) for b in mesh.cells])
            counts = [np.sum(J <= 0), *(np.sum(J < b) for b in bounds)]
            near = [np.sum(np.abs(J - b) < 1e-9) for b in [0, *bounds]]
            said = [int(n) for n in row[3].split()]
            least, mean = float(row[1]) - J.min(), float(row[2]) - J.mean()
            if abs(least) > 1e-3 * abs(J.min()) + 1e-9 or abs(mean) > 1e-3 * abs(J.mean()) + 6e-5 \
                    or any(abs(a - b) > n for a, b, n in zip(said, counts, near)):
                self.say(f"table, {when.split()[-1].strip(' +')}: {' '.join(row[0].split()[-8:])};",
                         f"the corners have {J.min():.4g} {J.mean():.4g}", *counts)
        said = re.search(r"^(\d+) elements? invalid in the file, (\d+) left", self.console, re.M)
        left = sum(int(np.sum(geometry.least_scaled(b, result.x, signs[id(b)]) <= 0)) for b in result.cells)
        if said and (int(said[1]) < len(self.invalid_in_file()) or int(said[2]) < left):
            self.say(f"said {said[0]}, but {len(self.invalid_in_file())} are, and {left} are left")

    # ---- boundaries

    def moves_of(self, result, t, frame):
        """Rows (name, nodes of the result, faces of the file, Moved)."""
        came = raised(self.mesh, self.mesh.x, result)
        named, inner = result.groups(result.dim - 1), self.mesh.groups(self.mesh.dim - 1)
        outer, faces_of_file = set(), {}
        for block, k, rows in result.outer_faces():
            for face in block.nodes[rows][:, face_nodes(block.cell, k, result.degree)].tolist():
                outer.add(frozenset(face))
        of = {name: [frozenset(n) for b, rows in groups for n in b.nodes[rows].tolist()]
              for name, groups in named.items()}
        of["untagged"] = list(outer - {face for faces in of.values() for face in faces})
        for name, groups in inner.items():
            faces_of_file[name] = [n[:len(b.cell.vertices)] for b, rows in groups for n in b.nodes[rows].tolist()]
        lines, found = self.deck.moves["boundary"], []
        rest = lines.get("rest", lines.get("all", ("slide", Path()) if self.improves else None))
        for name, faces in of.items():
            which = faces if name in lines else [f for f in faces if f in outer]
            line = lines.get(name, rest)
            if which and line:
                moved = Moved(self.deck, *line, self.mesh, result, came, t, frame)
                if self.deck.value("surface", "auto") == "slide":
                    moved.kind[moved.kind == "moves"] = "slides"
                found.append((name, np.array(sorted(frozenset().union(*which))), faces_of_file.get(name, []), moved))
        for name, line in self.deck.moves["volume"].items():
            cells = [b.nodes[rows].ravel() for b, rows in result.groups(result.dim).get(name, [])]
            if cells:
                found.append((name, np.unique(np.concatenate(cells)), [],
                              Moved(self.deck, *line, self.mesh, result, came, t, frame)))
        return came, found

    def check_boundaries(self, result, t, frame):
        if self.refine:
            return self.check_refined(result)
        if self.deck.moves["select"]:
            return
        came, rows = self.moves_of(result, t, frame)
        rounding = ROUNDING * size_of(self.mesh)
        target, owner, fixed, disputed = np.full(result.x.shape, np.nan), {}, np.zeros(len(result.ids), bool), set()
        for name, nodes, _, moved in rows:
            for i in nodes[(moved.kind[nodes] == "moves") & ~np.isnan(moved.x[nodes, 0])]:
                if i in owner and np.abs(target[i] - moved.x[i]).max() > 1e-6 * size_of(self.mesh):
                    disputed.add(i)
                if i not in owner or moved.is_fixed:
                    target[i], owner[i] = moved.x[i], name
                fixed[i] |= moved.is_fixed
        if disputed and self.deck.value("shared_nodes", "refuse") == "refuse":
            self.say(f"nodes {result.ids[sorted(disputed)[:5]]} have two targets, and none was refused")
        for block in result.blocks:  # faces at these follow
            for face in block.nodes.tolist() if disputed and block.cell.dim == self.mesh.dim - 1 else []:
                if not disputed.isdisjoint(face):
                    for i in face:
                        owner.pop(i, None)
        at = np.array(sorted(owner), int)
        if not len(at):
            return
        kept = np.isin(result.ids, self.mesh.ids)
        off = np.linalg.norm(result.x - target, axis=1)
        exact = fixed & kept
        astray = [i for i in at if off[i] > rounding or (exact[i] and np.any(result.x[i] != target[i]))]
        self.judge(result, astray, off, exact, owner)
        if "nodes_off_motion" in self.summary and not disputed and not self.number("straight_faces"):
            self.check_between(result, rows, came, t, frame)
        self.check_sliding(result, rows, set(owner), rounding)

    def judge(self, result, astray, off, exact, owner):
        """Nodes that are not where their motion takes them, against what was said of them."""
        told = int(self.number("nodes_off_motion", self.number("nodes_off_target") + self.number("freed_nodes")))
        largest = self.number("off_motion", max(self.number("max_boundary_error"), self.number("largest_slide")))
        gives_way = any(self.number(n) for n in ("nodes_off_target", "freed_nodes", "straight_faces"))
        for some, what in (([i for i in astray if exact[i]], "of fixed boundaries have moved"),
                           ([i for i in astray if not exact[i]], "are not at their motion")):
            if some and (len(astray) > told or (exact[some[0]] and not gives_way)):
                far = max(some, key=lambda i: off[i])
                self.say(f"{len(some)} nodes {what}, node {result.ids[far]} of {owner[far]} by {off[far]:.3g};",
                         f"said were {told} nodes off, by {largest:.3g} at most")
        far = max(astray, key=lambda i: off[i], default=None)
        if astray and len(astray) <= told and off[far] > largest * (1 + 1e-5) + 1e-11 * size_of(self.mesh):
            self.say(f"node {result.ids[far]} of {owner[far]} is off by {off[far]:.3g}, said was {largest:.6g} at most")

        slid = re.search(r"^(\d+) nodes slid along the surface, by at most (\S+);", self.console, re.M)
        if slid and astray and not self.number("straight_faces") and not self.number("nodes_off_target"):
            if off[far] > float(slid[2]) * 1.01 + 1e-11 * size_of(self.mesh):  # three digits
                self.say(f'said "{slid[0][:-1]}", but node {result.ids[far]} of {owner[far]} by {off[far]:.3g}')

    def check_between(self, result, rows, came, t, frame):
        """The boundary between the nodes, against the motion of the faces of the file."""
        said, farthest = self.number("max_boundary_error"), (0.0, "")
        for name, _, faces, moved in rows:
            line = self.deck.moves["boundary"].get(name)
            if line and not re.search(r"slide|free|\bfile\b|\bmesh\b", line[0]) and not self.number("freed_nodes"):
                for block, of in result.groups(result.dim - 1).get(name, []):
                    N = values(block.cell, block.degree, lattice(block.cell, 2 * block.degree + 3))
                    was, now = ((N @ x[block.nodes[of]]).reshape(-1, 3) for x in (came, result.x))
                    to = Moved(self.deck, *line, *[Points(was, self.mesh.dim)] * 2, was, t, frame).x
                    farthest = max(farthest, (np.linalg.norm(now - to, axis=1).max(), name))
        if farthest[0] > 1.5 * said + 1e-11 * size_of(self.mesh):  # the program looks at quadrature points
            self.say(f"{farthest[1]} is off its motion by {farthest[0]:.4g} between nodes, said was {said:.4g}")

    def check_sliding(self, result, rows, owned, rounding):
        """In planes, on lines, circles and spheres: nodes that slide stay there."""
        angle, dim = float(self.deck.value("feature_angle", 30)), self.mesh.dim
        number = {node: k for k, node in enumerate(result.ids.tolist())}
        tolerance = float(self.deck.value("surface_tolerance", 1e-3)) if self.improves else 0
        for name, _, faces, moved in rows:
            if moved.along or not faces or len({len(f) for f in faces}) > 1 or "slides" not in moved.kind:
                continue
            faces, x = np.array(faces), moved.surface[:, :dim]
            part = geometry.smooth_parts(faces, x, angle)
            for p in np.unique(part):
                corner = np.unique(faces[part == p])
                now = [number[int(i)] for i in self.mesh.ids[corner]]
                slid = np.array([i not in owned and moved.kind[i] == "slides" for i in now])
                off = geometry.off_surface(x[corner], result.x[now, :dim])
                edge = np.linalg.norm(np.diff(x[faces[part == p]][:, :2], axis=1)[:, 0], axis=1).max()
                known = np.sum(part == p) >= 2 * (dim - 1)  # a face alone may be of a surface that is round
                most = 1e-9 * size_of(self.mesh) + tolerance * edge
                if off is not None and known and slid.any() and off[slid].max() > most:
                    worst = now[int(np.argmax(np.where(slid, off, 0)))]
                    self.say(f"node {result.ids[worst]} of {name} has left its surface by {off[slid].max():.3g}")

    def check_refined(self, result):
        """Of every boundary all nodes are among the points to which the motion takes the refined faces' nodes."""
        told = int(self.number("nodes_off_target")) + int(self.number("freed_nodes"))
        named, lines = self.mesh.groups(self.mesh.dim - 1), self.deck.moves["boundary"]
        for name, groups in result.groups(result.dim - 1).items():
            text, folder = lines.get(name, lines.get("rest", lines.get("all", ("free", Path()))))
            if re.search("slide|free|file|mesh", text) or name not in named:
                continue
            points = []
            for block, rows in named[name]:
                at = lattice(block.cell, result.degree * 2 ** self.refine)
                points.append(np.einsum("pn,ena->epa", values(block.cell, block.degree, at),
                                        self.mesh.x[block.nodes[rows]]).reshape(-1, 3))
            points = np.concatenate(points)
            there = Moved(self.deck, text, folder, *[Points(points, self.mesh.dim)] * 2, points).x
            nodes = np.unique(np.concatenate([b.nodes[rows].ravel() for b, rows in groups]))
            off = np.array([np.linalg.norm(there - result.x[i], axis=1).min() for i in nodes])
            count = int(np.sum(off > ROUNDING * size_of(self.mesh)))
            if count > told:
                self.say(f"boundary {name}: {count} nodes are off by up to {off.max():.3g}, said were {told} of all")
            elif count and off.max() > self.number("max_boundary_error") * (1 + 1e-5) + 1e-11 * size_of(self.mesh):
                self.say(f"boundary {name} is off by {off.max():.6g}, said was {self.number('max_boundary_error')}")

"""Meshes good and bad for one_file.py: rings, strips that cover a ring twice, squares with a hole; with nodes moved,
pushed through an edge, triangles clockwise, boundary edges in no group, in MSH 2.2 and 4.1. Both programs have to come
to the same verdict. Standard library only.
"""
import concurrent.futures
import math
import random
import re
import subprocess
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
GROUPS = {1: "inner", 2: "outer"}


@dataclass(frozen=True)
class Case:
    name: str
    nodes: tuple      # (x, y)
    triangles: tuple  # three indices of nodes, from 0
    edges: tuple      # two indices and the group, 0 for none
    motion: str = "translate 0.1 0"


# ------------------------------------------------------------------------------------------------- meshes

def strip(around, layers, turns):
    """A strip of two triangles per cell that goes `turns` times around a ring and closes: valid where it is looked at
    triangle by triangle, and for two turns lying upon itself, node upon node."""
    angles = [2 * math.pi * (turns * i % around) / around for i in range(around)]
    nodes = [((1 + k / layers) * math.cos(angle), (1 + k / layers) * math.sin(angle))
             for angle in angles for k in range(layers + 1)]
    at = lambda i, k: i % around * (layers + 1) + k
    triangles = [t for i in range(around) for k in range(layers)
                 for t in ((at(i, k), at(i, k + 1), at(i + 1, k + 1)), (at(i, k), at(i + 1, k + 1), at(i + 1, k)))]
    edges = [(at(i, k), at(i + 1, k), group) for i in range(around) for k, group in ((0, 1), (layers, 2))]
    return Case(f"{turns} turns", tuple(nodes), tuple(triangles), tuple(edges))


def square(n):
    """A square of n x n cells, one of them a hole."""
    nodes = [(i / n, j / n) for i in range(n + 1) for j in range(n + 1)]
    at = lambda i, j: i * (n + 1) + j
    hole = (n // 2, n // 2)
    triangles = [t for i in range(n) for j in range(n) if (i, j) != hole
                 for t in ((at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))]
    i, j = hole
    corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    edges = [(a, b, 1) for a, b in zip(corners, corners[1:] + corners[:1])]
    for k in range(n):
        edges += [(at(k, 0), at(k + 1, 0), 2), (at(n, k), at(n, k + 1), 2), (at(k, n), at(k + 1, n), 2),
                  (at(0, k), at(0, k + 1), 2)]
    return Case("square", tuple(nodes), tuple(triangles), tuple(edges), f"translate {0.1 / n} 0")


def perturbed(case, by, r):
    return replace(case, name=f"{case.name}, perturbed by {by}",
                   nodes=tuple((x + r.uniform(-by, by), y + r.uniform(-by, by)) for x, y in case.nodes))


def folded(case, r):
    """A node pushed through the edge of a neighbour that is opposite to it."""
    inside = sorted(set(range(len(case.nodes))) - {node for edge in case.edges for node in edge[:2]})
    node = r.choice(inside)
    t = r.choice([t for t in case.triangles if node in t])
    middle = [sum(case.nodes[i][a] for i in t if i != node) / 2 for a in (0, 1)]
    far = 1 + r.uniform(0.05, 2)
    x, y = (case.nodes[node][a] + far * (middle[a] - case.nodes[node][a]) for a in (0, 1))
    return replace(case, name=f"{case.name}, folded",
                   nodes=(*case.nodes[:node], (x, y), *case.nodes[node + 1:]))


def turned(case, share, r):
    """Triangles clockwise."""
    return replace(case, name=f"{case.name}, clockwise", triangles=tuple(
        (a, c, b) if r.random() < share else (a, b, c) for a, b, c in case.triangles))


def untagged(case, left_out, r):
    """An edge of the boundary in no group, or not in the file."""
    place = r.randrange(len(case.edges))
    a, b, _ = case.edges[place]
    return replace(case, name=f"{case.name}, untagged",
                   edges=(*case.edges[:place], *([] if left_out else [(a, b, 0)]), *case.edges[place + 1:]))


def cases(count, seed):
    r = random.Random(seed)
    found = []
    for k in range(count):
        kind = k % 10
        turns = 2 if kind in (3, 7) else 1
        around, layers = turns * r.randrange(7, 12), r.randrange(2, 5)
        case = square(r.randrange(3, 7)) if kind % 4 == 2 else strip(around, layers, turns)
        size = 0.2 / 6 if case.name == "square" else 0.2 / layers
        if kind != 3:
            case = perturbed(case, size * r.uniform(0.05, 0.6), r)
        case = {4: lambda: folded(case, r), 5: lambda: turned(case, r.choice([1, 0.3]), r),
                6: lambda: untagged(case, r.random() < 0.5, r), 8: lambda: turned(folded(case, r), 0.5, r),
                9: lambda: perturbed(case, 4 * size, r)}.get(kind, lambda: case)()
        if k % 20 == 3:  # the two turns stay node upon node
            case = replace(case, motion="translate 0 0")
        if kind == 1:
            case = replace(case, motion=f"rotate {r.uniform(-20, 20)}")
        found.append(case)
    return found


# ------------------------------------------------------------------------------------------------- files

def text_22(case):
    names = "".join(f'1 {tag} "{name}"\n' for tag, name in GROUPS.items())
    nodes = "".join(f"{5 + 2 * i} {x!r} {y!r} 0\n" for i, (x, y) in enumerate(case.nodes))
    edges = [f"{e + 1} 1 2 {group} {group} {5 + 2 * a} {5 + 2 * b}\n" for e, (a, b, group) in enumerate(case.edges)]
    triangles = [f"{1000 + e} 2 2 3 1 {5 + 2 * a} {5 + 2 * b} {5 + 2 * c}\n"
                 for e, (a, b, c) in enumerate(case.triangles)]
    return (f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n{names}$EndPhysicalNames\n"
            f"$Nodes\n{len(case.nodes)}\n{nodes}$EndNodes\n"
            f"$Elements\n{len(edges) + len(triangles)}\n{''.join(edges + triangles)}$EndElements\n")


def text_41(case):
    """The same with an entity for each group, and nodes in two blocks."""
    used = sorted({group for _, _, group in case.edges})
    names = "".join(f'1 {tag} "{name}"\n' for tag, name in GROUPS.items())
    curves = "".join(f"{10 + g} -9 -9 0 9 9 0 {f'1 {g} ' if g else '0 '}0 \n" for g in used)
    half, ids = len(case.nodes) // 2, [5 + 2 * i for i in range(len(case.nodes))]
    nodes = "".join(f"2 1 0 {len(part)}\n" + "".join(f"{ids[i]}\n" for i in part) +
                    "".join(f"{case.nodes[i][0]!r} {case.nodes[i][1]!r} 0\n" for i in part)
                    for part in (range(half), range(half, len(ids))))
    blocks = []
    for g in used:
        rows = [f"{e + 1} {ids[a]} {ids[b]} \n" for e, (a, b, group) in enumerate(case.edges) if group == g]
        blocks.append(f"1 {10 + g} 1 {len(rows)}\n" + "".join(rows))
    blocks.append(f"2 1 2 {len(case.triangles)}\n" + "".join(
        f"{1000 + e} {ids[a]} {ids[b]} {ids[c]} \n" for e, (a, b, c) in enumerate(case.triangles)))
    count = len(case.edges) + len(case.triangles)
    return (f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n{names}$EndPhysicalNames\n"
            f"$Entities\n0 {len(used)} 1 0\n{curves}1 -9 -9 0 9 9 0 1 3 0 \n$EndEntities\n"
            f"$Nodes\n2 {len(ids)} 5 {ids[-1]}\n{nodes}$EndNodes\n"
            f"$Elements\n{len(blocks)} {count} 1 {1000 + count}\n{''.join(blocks)}$EndElements\n")


def counter_clockwise(text):
    """An MSH 2.2 file with two nodes of each clockwise triangle exchanged."""
    lines, point = text.split("\n"), {}
    for i, line in enumerate(lines):
        words = line.split()
        if len(words) == 4 and words[0].isdigit():
            point[words[0]] = [float(word) for word in words[1:3]]
        elif len(words) > 5 and words[1] == "2":
            (a, b), (c, d), (e, f) = (point[node] for node in words[-3:])
            if (c - a) * (f - b) - (d - b) * (e - a) < 0:
                lines[i] = " ".join([*words[:-2], words[-1], words[-2]])
    return "\n".join(lines)


# ------------------------------------------------------------------------------------------------- verdicts

def of_one_file(build, folder, mesh, motions):
    """(accepted, what it says, q)"""
    words = [word for name, motion in motions.items() if motion != "fixed" for word in (name, *motion.split())]
    done = subprocess.run([build / "lessons" / "almesh_in_one_file", mesh, *words], cwd=folder, text=True,
                          capture_output=True)
    rows = [line.split() for line in done.stdout.splitlines() if re.match(r"\s*\d", line)]
    return done.returncode == 0, done.stdout[-100:] + done.stderr, float(rows[-1][3]) if rows else 0


def of_program(build, folder, mesh, motions, settings):
    lines = [f"boundary {name} = {motion}{' about 0 0' if motion.startswith('rotate') else ''}\n"
             for name, motion in motions.items()]
    (folder / "case.deck").write_text(f"mesh = {mesh}\noutput = {folder}/results\n{''.join(lines)}")
    done = subprocess.run([build / "almesh", folder / "case.deck", *settings, "threads=1"], text=True,
                          capture_output=True)
    summary = folder / "results" / "summary.txt"
    q = re.search(r"^relative_quality = (\S+)", summary.read_text(), re.M) if done.returncode == 0 else None
    return done.returncode == 0, done.stdout + done.stderr, float(q.group(1)) if q else 0


def compare(build, settings, name, text, motions):
    """(the program's verdict: accepted, clockwise or refused; what differs, or "")"""
    with tempfile.TemporaryDirectory(prefix="almesh-verdicts-") as scratch:
        folder = Path(scratch)
        mesh = folder / "mesh.msh"
        mesh.write_text(text)
        accepted, says, q = of_program(build, folder, mesh, motions, settings)
        alike, message, own = of_one_file(build, folder, mesh, motions)
    first = re.search(r"with negative orientation turned, the first is element (\d+)", says)
    if accepted and first:
        told = f"triangle {first.group(1)} is clockwise" in message
        return "clockwise", "" if told and not alike else f"{name}: triangle {first.group(1)} is clockwise; {message}"
    verdict, differs = "accepted" if accepted else "refused", accepted and abs(own - q) > 1e-7
    if accepted != alike:
        return verdict, f"{name}: the program says {says[-300:]}, the one file {message}"
    if "folds over itself" in says and not re.search("folds over itself|is clockwise", message):
        return verdict, f"{name}: the mesh folds over itself, the one file says {message}"
    return verdict, f"{name}: q = {own}, of the program {q}" if differs else ""


def check_verdicts(build, settings, count, seed):
    """What differs."""
    jobs = []
    for k, case in enumerate(cases(count, seed)):
        motions = {"inner": case.motion, "outer": "fixed"}
        text = text_22(case) if k // 10 % 2 else text_41(case)
        jobs.append((f"seed {seed}, mesh {k} ({case.name})", text, motions))
        if "clockwise" in case.name:
            jobs.append((f"seed {seed}, mesh {k} ({case.name}), exchanged", counter_clockwise(text_22(case)), motions))
    fixed = dict.fromkeys(("bottom", "right", "top", "left"), "fixed")
    of_course = (ROOT / "inputs" / "meshes" / "square.msh").read_text()
    jobs += [("lesson 1's folded mesh", (ROOT / "inputs/lessons/01-distortion/inverted.msh").read_text(),
              {"wall": "fixed"}),
             ("square.msh", of_course, fixed), ("square.msh as 3.0", of_course.replace("4.1", "3.0", 1), fixed)]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        found = list(pool.map(lambda job: compare(build, settings, *job), jobs))
    counts = {verdict: sum(v == verdict for v, _ in found) for verdict in ("accepted", "refused", "clockwise")}
    failures = [text for _, text in found if text]
    failures += [f"only {n} of {len(jobs)} meshes are {v}" for v, n in counts.items() if n < len(jobs) // 20]
    print(f"{len(jobs)} meshes: " + ", ".join(f"{n} {verdict}" for verdict, n in counts.items()) +
          (f", {len(failures)} DIFFER" if failures else ", as by the program"))
    return failures

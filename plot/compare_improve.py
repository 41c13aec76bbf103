#!/usr/bin/env python3
"""`almesh improve` beside other programs that make the same bad meshes better, in one table.

  plot/compare_improve.py          the same as `make compare-improve`: all cases, a quarter of an hour
  plot/compare_improve.py --quick  `make compare-improve QUICK=1`: nine cases, two minutes
  plot/compare_improve.py NAME...  those whose names contain one of the words
  --keep                           with what an earlier run has of the other programs

Writes outputs/compare-improve/table.md, and table.csv with every method. ALMESH=FILE runs another program than ./almesh.
Needs gmsh's Python module, numpy and scipy (Debian: python3-gmsh python3-numpy python3-scipy). The cases are in
improve_cases.py, the measure of all results is in cell_mesh.py.

Move nodes alone, the boundary fixed:
  gmsh Relocate     optimize("Relocate3D") or ("Relocate2D"), ten times
  gmsh Laplace      optimize("Laplace2D"), ten times
  gmsh HighOrder    of curved meshes: optimize("HighOrder")
  gmsh elastic      of curved meshes: optimize("HighOrderElastic"), then "HighOrder"
  mmg3d moves       mmg3d -noinsert -noswap -nosurf, where mmg3d or mmg3d_O3 is on the PATH
  foldover, slim    of foldover.py, after the papers; slim from valid meshes only
  corners           of corners.py: L-BFGS on the corners; not of curved meshes; a column of its own, for it is the least
                    that is to be reached
  almesh            `almesh improve` with `boundary rest = fixed`
Change edges or insert nodes too, the boundary fixed:
  gmsh Optimize     optimize("")
  Netgen            OptimizeVolumeMesh() of Debian's python3-netgen
  tetgen            tetgen -rYO of Debian's tetgen
Moves nodes, those of the boundary along it:
  almesh slides     `almesh improve` as it is

Times are the user time of one process and thread, from reading a file to writing one. LIMIT is of the processor too.
Columns of a result: cells inverted; least scaled Jacobian of the cells that have a node inside; mean of all; seconds.
"""
import csv
import importlib
import os
import re
import resource
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import cad
import cell_mesh
import improve_cases

FOLDER = cad.runs.OUTPUTS / "compare-improve"
ALMESH = os.environ.get("ALMESH", cad.ROOT / "almesh")
LIMIT = 60  # seconds
OWN = {"almesh": ["boundary rest=fixed"], "almesh slides": []}
MMG = shutil.which("mmg3d") or shutil.which("mmg3d_O3")


# ---------------------------------------------------------------- in a process of its own: file, file -> file

def by_gmsh(source, target, *methods, times=1):
    gmsh = cad.start_gmsh()
    gmsh.open(source)
    for method in methods:
        gmsh.model.mesh.optimize(method, True, times)
    gmsh.write(target)


def by_netgen(source, target):
    from netgen import meshing
    meshing.SetMessageImportance(0)
    mesh = cell_mesh.read(source)
    out = meshing.Mesh(dim=3)
    points = [out.Add(meshing.MeshPoint(meshing.Pnt(*p))) for p in mesh.x.tolist()]
    out.Add(meshing.FaceDescriptor(bc=1, domin=1, domout=0, surfnr=1))
    out.SetMaterial(1, "body")
    for row in mesh.blocks[2][1].tolist():
        out.Add(meshing.Element2D(1, [points[i] for i in row]))
    for i, j, k, m in mesh.blocks[4][1].tolist():  # of the other hand there
        out.Add(meshing.Element3D(1, [points[i], points[k], points[j], points[m]]))
    out.CalcLocalH(0.3)
    out.OptimizeVolumeMesh()
    tetrahedra = np.array([[v.nr - 1 for v in e.vertices] for e in out.Elements3D()])[:, [0, 2, 1, 3]]
    write_tetrahedra([p.p for p in out.Points()], tetrahedra, target)


def write_tetrahedra(x, nodes, target):
    cell_mesh.write(cell_mesh.CellMesh(x, {4: (np.ones(len(nodes), int), nodes)}), target)


def by_tetgen(source, target):
    mesh = cell_mesh.read(source)
    base = Path(target).with_suffix("")
    rows = lambda table: "\n".join(f"{i} " + " ".join(map(repr, row)) for i, row in enumerate(table.tolist()))
    base.with_suffix(".node").write_text(f"{len(mesh.x)} 3 0 0\n{rows(mesh.x)}\n")
    base.with_suffix(".ele").write_text(f"{len(mesh.blocks[4][1])} 4 0\n{rows(mesh.blocks[4][1])}\n")
    subprocess.run(["tetgen", "-rYQO", base], check=True, stdout=subprocess.DEVNULL)
    read = lambda end: np.array([line.split() for line in Path(f"{base}.1.{end}").read_text().split("\n")[1:]
                                 if line.strip() and not line.startswith("#")], float)
    write_tetrahedra(read("node")[:, 1:4], read("ele")[:, 1:5].astype(int), target)


def by_mmg(source, target):
    gmsh = cad.start_gmsh()
    gmsh.open(source)
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    gmsh.write(target + ".mesh")
    subprocess.run([MMG, "-noinsert", "-noswap", "-nosurf", target + ".mesh", target + ".o.mesh"], check=True,
                   stdout=subprocess.DEVNULL)
    gmsh.open(target + ".o.mesh")
    gmsh.write(target)


def by_script(source, target, module, method, **options):
    mesh = cell_mesh.read(source)
    getattr(importlib.import_module(module), method)(mesh, **options)
    cell_mesh.write(mesh, target)


PEERS = {
    "gmsh Relocate": lambda s, t: by_gmsh(s, t, f"Relocate{cell_mesh.read(s).dim}D", times=10),
    "gmsh Laplace": lambda s, t: by_gmsh(s, t, "Laplace2D", times=10),
    "gmsh HighOrder": lambda s, t: by_gmsh(s, t, "HighOrder"),
    "gmsh elastic": lambda s, t: by_gmsh(s, t, "HighOrderElastic", "HighOrder"),
    "mmg3d moves": by_mmg,
    "foldover": lambda s, t: by_script(s, t, "foldover", "foldover"),
    "slim": lambda s, t: by_script(s, t, "foldover", "slim"),
    "corners": lambda s, t: by_script(s, t, "corners", "improve", seconds=LIMIT / 2),
    "gmsh Optimize": lambda s, t: by_gmsh(s, t, ""),
    "Netgen": by_netgen,
    "tetgen": by_tetgen}
CHANGE_EDGES = {"gmsh Optimize", "Netgen", "tetgen"}


def peer(name, source, target):
    """Prints the user seconds."""
    PEERS[name](source, target)
    print(sum(resource.getrusage(who).ru_utime for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)) - START)


def peers_of(mesh, valid):
    types = {t for t in mesh.blocks if cell_mesh.TYPES[t].dim == mesh.dim}
    if types & {9, 11}:
        return ["gmsh HighOrder", "gmsh elastic"]
    if mesh.dim == 2:
        return ["gmsh Relocate", "gmsh Laplace", "foldover"] + ["slim"] * valid + ["corners"]
    more = ["mmg3d moves", "gmsh Optimize", "Netgen", "tetgen"] if types == {4} else []
    return ["gmsh Relocate", "foldover"] + ["slim"] * valid + ["corners"] + more


# ---------------------------------------------------------------- the table

def limited():
    resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT + 5))


def run(name, source, folder):
    """(mesh that it left, user seconds), or a word that says why there is none."""
    target = folder / (name.replace(" ", "-") + ".msh")
    target.unlink(missing_ok=True)
    if name == "mmg3d moves" and not MMG:
        return "not installed"
    if name == "tetgen" and not shutil.which("tetgen"):
        return "not installed"
    output = folder / name.replace(" ", "-")
    command = ([ALMESH, "improve", source, f"output={output}", "threads=1", "vtk=none", *OWN[name]] if name in OWN else
               [sys.executable, __file__, "--peer", name, source, target])
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", preexec_fn=limited,
                          env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    if name in OWN:
        shutil.rmtree(folder / "kept", ignore_errors=True)
        target = output / "final.msh"
    if not target.exists():
        return "over the limit" if seconds > LIMIT - 1 else \
            "not installed" if "No module named" in done.stderr else "failed"
    return cell_mesh.read(target), seconds if name in OWN else float(done.stdout.split()[-1])


@dataclass
class Result:
    """Cells inverted, or -1 where the mesh overlaps itself, though none is; least and mean scaled Jacobian; seconds."""
    inverted: int
    least: float
    mean: float
    seconds: float

    def text(self):
        return (f"{'overlaps' if self.inverted < 0 else self.inverted}; {self.least:.3g}; {self.mean:.3g}; "
                f"{self.seconds:.2g} s")

    def order(self):
        return self.inverted >= 0, -self.inverted, self.least


def measured(mesh, fixed, volume, seconds=0.0):
    """fixed: positions of the nodes of the boundary. volume: with sign, of the tetrahedra inside it, or None."""
    values = mesh.scaled_jacobians()
    on = np.array([row in fixed for row in map(tuple, np.round(mesh.x, 9).tolist())])
    inside = np.concatenate([~on[nodes].all(axis=1) for _, nodes in mesh.cells()])
    inverted = int((values <= 0).sum())
    # Programs that turn inverted tetrahedra the other way round leave them where they are, over others.
    if inverted == 0 and volume and abs(signed_volume(mesh) - volume) > 1e-6 * volume:
        inverted = -1
    return Result(inverted, (values[inside] if inside.any() else values).min(), values.mean(), seconds)


def signed_volume(mesh):
    """Of the tetrahedra: as long as they fit together that of the boundary, whatever is inverted."""
    if 4 not in mesh.blocks:
        return 0
    x = mesh.x[mesh.blocks[4][1]]
    return np.linalg.det(x[:, 1:] - x[:, :1]).sum() / 6


def compare(name, known):
    """{method: Result or why not}, the first of them "before". known: the same of an earlier run, of other programs."""
    folder = FOLDER / name
    folder.mkdir(parents=True, exist_ok=True)
    mesh = improve_cases.CASES[name][1](folder)
    source = folder / "before.msh"
    cell_mesh.write(mesh, source)
    fixed = set(map(tuple, np.round(mesh.x[mesh.boundary()], 9).tolist()))
    volume = signed_volume(mesh)
    results = {"before": measured(mesh, fixed, volume)}
    for method in [*peers_of(mesh, results["before"].inverted == 0), *OWN]:
        if method in known and method not in OWN:
            results[method] = known[method]
            continue
        got = run(method, source, folder)
        slides = method == "almesh slides"
        results[method] = got if isinstance(got, str) else measured(got[0], fixed, None if slides else volume, got[1])
    return results


def best(results, methods):
    """"method: result" of the best of the methods, and the result."""
    found = [(r.order(), m) for m, r in results.items() if m in methods and isinstance(r, Result)]
    if not found:
        return "-", None
    method = max(found)[1]
    return f"{method}: {results[method].text()}", results[method]


def moving(results):
    """The best of the other methods that move nodes alone, as `best` has it."""
    return best(results, [m for m in results if m not in CHANGE_EDGES and m not in OWN and m != "before"])


def times(results, own, of):
    """Least scaled Jacobian over that of the result `of`, or None where one is missing or leaves cells inverted."""
    ours = results[own]
    return None if isinstance(ours, str) or not isinstance(of, Result) or of.inverted else ours.least / of.least


def row(name, results):
    cell = lambda method: r.text() if isinstance(r := results.get(method, "-"), Result) else r
    ratios = [times(results, own, moving(results)[1]) for own in OWN]
    before = results["before"]
    return (f"| {name} | {before.inverted}; {before.least:.2g} | {moving(results)[0]} | {cell('corners')} | "
            f"{best(results, CHANGE_EDGES)[0]} | {' | '.join(map(cell, OWN))} | "
            + ", ".join("-" if r is None else f"{r:.2f}" for r in ratios) + " |")


def counts(of_case):
    """Lines that compare every way to run almesh with the best peer that moves nodes, and with corners. of_case:
    [results]."""
    lines = []
    for own in OWN:
        valid = sum(isinstance(r[own], Result) and r[own].inverted == 0 for r in of_case)
        compared = [(times(r, own, moving(r)[1]), r[own].seconds, moving(r)[1].seconds) for r in of_case
                    if times(r, own, moving(r)[1])]
        corners = [t for t in (times(r, own, r.get("corners")) for r in of_case) if t]
        lines.append(f"{own}: no cell inverted in {valid} of {len(of_case)} cases; best peer that moves nodes: in "
                     f"{sum(moving(r)[1] is not None and moving(r)[1].inverted == 0 for r in of_case)}; least scaled "
                     f"Jacobian at least its in {sum(t >= 0.9995 for t, *_ in compared)} of {len(compared)}, at least "
                     f"1.2 times its in {sum(t >= 1.2 for t, *_ in compared)}; faster in "
                     f"{sum(a <= b for _, a, b in compared)}; least at least that of corners in "
                     f"{sum(t >= 0.9995 for t in corners)} of {len(corners)}")
    return lines


def read_table():
    """{case: {method: Result or why not}} of earlier runs."""
    table = {}
    if (FOLDER / "table.csv").exists():
        for case, method, inverted, *numbers in list(csv.reader(open(FOLDER / "table.csv", newline="")))[1:]:
            table.setdefault(case, {})[method] = Result(int(inverted), *map(float, numbers)) if numbers[0] else inverted
    return table


def write_table(table):
    with open(FOLDER / "table.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["case", "method", "inverted", "least", "mean", "seconds"])
        for case in (name for name in improve_cases.CASES if name in table):
            for method, r in table[case].items():
                writer.writerow([case, method] + ([r, "", "", ""] if isinstance(r, str) else
                                [r.inverted, f"{r.least:.6g}", f"{r.mean:.6g}", f"{r.seconds:.3g}"]))


def main(words):
    names = [w for w in words if not w.startswith("--")]
    chosen = [n for n, (quick, _) in improve_cases.CASES.items()
              if (quick if "--quick" in words else not names or any(w in n for w in names))]
    FOLDER.mkdir(parents=True, exist_ok=True)
    table = read_table()
    lines = ["| case | inverted; least | best that moves nodes | corners | best that changes edges | "
             + " | ".join(OWN) + " | least over that of the best that moves nodes |", "|---" * (6 + len(OWN)) + "|"]
    print("\n".join(lines))
    for name in chosen:
        table[name] = compare(name, table.get(name, {}) if "--keep" in words else {})
        write_table(table)
        lines.append(row(name, table[name]))
        print(lines[-1], flush=True)
    lines += ["", *counts([table[name] for name in chosen])]
    print("\n".join(lines[-len(OWN) - 1:]))
    (FOLDER / "table.md").write_text("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--peer"]:
        import gmsh  # noqa: F401  before the clock starts, as Python itself
        import scipy.optimize, scipy.sparse.linalg  # noqa: E401,F401
        START = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        peer(*sys.argv[2:])
    else:
        sys.exit(main(sys.argv[1:]))

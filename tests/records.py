#!/usr/bin/env python3
"""`almesh improve` on all meshes of some folders, measured by what shares nothing with it: a line for each mesh.

  tests/records.py [--seconds N] [--corners] [--program ./almesh] PATH ...    files, or folders with them

`make records MESHES=folder`, with SECONDS=N (120) for max_seconds and CORNERS=1 for what plot/corners.py reaches with a
fixed boundary. Files are MSH, SU2, INP, VTU and VTK. Where NAME.stl or NAME.obj lies beside a mesh, the boundary slides
along it. Columns:

  least, first per cent, mean  of the cells' scaled Jacobians, before and after (plot/cell_mesh.py)
  off                          the largest distance of a node of the boundary from the faces of the file's boundary, or
                               from the surface that is given, over the mean edge of the boundary
                               (plot/face_distance.py; of curved cells what the program says)
  seconds                      of the processor, on one thread
  certified                    what the program's summary says

A mesh is valid where all that is measured of it is positive. Exit code 1 where the least of a valid mesh became lower,
where a mesh that `almesh quality` certifies did not come out certified, or where there is no mesh. What cannot be
measured, of other cells or by meshio, is said. numpy, scipy, and meshio for all but MSH as text (Debian: python3-numpy
python3-scipy python3-meshio).
"""
import argparse
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "plot"))
import cell_mesh  # noqa: E402
import corners  # noqa: E402
import face_distance  # noqa: E402
import runs  # noqa: E402

ENDINGS, SURFACES = (".msh", ".su2", ".inp", ".vtu", ".vtk"), (".stl", ".obj")
ROUNDING = 1e-9  # of a scaled Jacobian
HEAD = (f"{'cells':>8}  {'least':^16}  {'first per cent':^16}  {'mean':^16}  {'off':>7}  {'seconds':>7}  "
        f"{'certified':9}")


@dataclass
class Record:
    cells: int = 0
    before: np.ndarray = None  # scaled Jacobians
    after: np.ndarray = None
    off: float = np.nan        # of an edge
    seconds: float = np.nan
    certified: bool = False
    corners: float = np.nan
    notes: list = field(default_factory=list)
    faults: list = field(default_factory=list)

    def line(self, with_corners):
        one = lambda of, values: "-".center(6) if values is None else f"{of(values):6.4f}"
        pair = lambda of: f"{one(of, self.before)} -> {one(of, self.after)}"
        number = lambda value, form: "-" if np.isnan(value) else format(value, form)
        cells = [f"{self.cells or '-':>8}", pair(np.min), pair(lambda s: np.quantile(s, 0.01)), pair(np.mean),
                 f"{number(self.off, '.1e'):>7}", f"{number(self.seconds, '.1f'):>7}",
                 f"{'yes' if self.certified else 'NO':9}"]
        cells += [f"{number(self.corners, '.4f'):>7}"] if with_corners else []
        return "  ".join([*cells, "; ".join(self.notes + [f"FAILS: {fault}" for fault in self.faults])]).rstrip()


def read(file):
    """(mesh, how many cells were numbered the other way round). Raises ValueError where it cannot be measured."""
    mesh = cell_mesh.read(file)
    if mesh.dim < 2:
        raise ValueError("it has no cells")
    if mesh.dim == 2 and np.ptp(mesh.x[:, 2]) > 0:
        raise ValueError("it is no plane mesh, nor one of solids")
    return mesh, mesh.turn()


def outer_faces(mesh):
    """[faces x vertices x 3]"""
    return [mesh.x[nodes] for nodes in mesh.outer_faces().values()]


def surface_faces(path):
    surface = cell_mesh.read(path)
    return [surface.x[nodes] for cell, nodes in surface.cells()]


def mean_edge(faces):
    return np.concatenate([np.linalg.norm(np.roll(f, -1, axis=1) - f, axis=2).ravel() for f in faces]).mean()


class Runner:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder

    def run(self, *arguments):
        """The finished process, or None where it did not end; and its seconds."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        try:
            done = subprocess.run([self.options.program.resolve(), *arguments, "threads=1"], capture_output=True,
                                  text=True, errors="replace", timeout=3 * self.options.seconds + 120)
        except subprocess.TimeoutExpired:
            done = None
        return done, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

    def record(self, file, number):
        record = Record()
        surface = next((s for s in map(file.with_suffix, SURFACES) if s.exists()), None)
        try:
            mesh, turned = read(file)
            record.cells, record.before = sum(len(nodes) for _, nodes in mesh.cells()), mesh.scaled_jacobians()
            record.notes += [f"{turned} cells are numbered the other way round"] if turned else []
        except ValueError as error:
            mesh = None
            record.notes.append(f"cannot be measured: {error}")
        output = self.folder / str(number)
        done, record.seconds = self.run("improve", file, f"output={output}", "vtk=none", "final=input",
                                        f"max_seconds={self.options.seconds}",
                                        *([f"boundary all=slide along {surface.resolve()}"] if surface else []))
        final = next(output.glob("final*"), None)
        if final is None:
            why = "it did not end" if done is None else (done.stderr.strip().splitlines() or [done.returncode])[-1]
            record.notes.append(f"no mesh: {why}")
        else:
            self.measure(record, mesh, output, final, surface)
        if not record.certified and (quality := self.run("quality", file)[0]) and quality.returncode == 0:
            record.faults.append("the file is certified, the result is not")
        if mesh and self.options.corners:
            record.corners = reached(mesh)
        return record

    @staticmethod
    def measure(record, mesh, output, final, surface):
        """What came of the mesh, None where it cannot be measured."""
        summary = runs.summary(output)
        record.certified = summary["certified_valid"] == summary["certified_injective"] == "yes"
        if mesh is None:
            return
        after = cell_mesh.CellMesh(cell_mesh.read(final).x, mesh.blocks)
        record.after = after.scaled_jacobians()
        if record.before.min() > 0 and record.after.min() < record.before.min() - ROUNDING:
            record.faults.append("the least became lower")
        if any(cell.degree > 1 for cell, _ in mesh.cells()):
            record.off = float(summary["relative_boundary_distance"])
            return
        faces = outer_faces(mesh)
        on = np.unique(np.concatenate([nodes.ravel() for nodes in mesh.outer_faces().values()]))
        off = face_distance.distances(after.x[on], surface_faces(surface) if surface else faces)
        record.off = off.max() / mean_edge(faces)
        record.notes += [f"off {surface.name}"] if surface else []


def reached(mesh):
    """The least scaled Jacobian that plot/corners.py reaches, nan of curved cells."""
    moved = cell_mesh.CellMesh(mesh.x, mesh.blocks)
    try:
        corners.improve(moved)
    except ValueError:
        return np.nan
    return moved.scaled_jacobians().min()


def total(records):
    """The last line."""
    measured = [r for r in records if r.after is not None]
    gain = np.array([r.after.min() - r.before.min() for r in measured])
    beside = [r.after.min() >= r.corners - ROUNDING for r in measured if not np.isnan(r.corners)]
    return (f"{len(records)} mesh{'es' if len(records) > 1 else ''}: certified {sum(r.certified for r in records)}; of "
            f"{len(measured)} that can be measured the least became larger in {(gain > ROUNDING).sum()}, lower in "
            f"{(gain < -ROUNDING).sum()}"
            + (f"; at least that of corners.py in {sum(beside)} of {len(beside)}" if beside else "")
            + f"; {sum(bool(r.faults) for r in records)} fail")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=120)
    parser.add_argument("--corners", action="store_true")
    parser.add_argument("--program", type=Path, default=Path("almesh"))
    parser.add_argument("path", nargs="+", type=Path)
    options = parser.parse_args()
    files = sorted((file, str(file.relative_to(path)) if path.is_dir() else file.name) for path in options.path
                   for file in (path.rglob("*") if path.is_dir() else [path]) if file.suffix in ENDINGS)
    if not options.program.exists():
        sys.exit(f"no program {options.program}: build it with `make`, or name it with --program")
    if not files:
        sys.exit(f"no mesh ({' '.join(ENDINGS)}) in {' '.join(map(str, options.path))}")
    width = max(len(name) for _, name in files)
    print(" " * (width + 1) + HEAD + ("  corners" if options.corners else ""))
    records = []
    with tempfile.TemporaryDirectory() as folder:
        runner = Runner(options, Path(folder))
        for number, (file, name) in enumerate(files):
            records.append(runner.record(file, number))
            print(name.ljust(width), records[-1].line(options.corners), flush=True)
    print(total(records))
    return 1 if any(record.faults for record in records) else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""What `almesh improve` must never do, on all meshes in inputs/ and on some that gmsh makes.

    tests/improve.py [--seconds N] [NAME ...]     all, or those whose name contains one of these; N (20): max_seconds

With gmsh for Python (Debian: python3-gmsh) also on solids and plates meshed by it, curved and not, with regions inside.
Of no valid mesh may the least scaled Jacobian or the certified bound become lower, and it must come out certified,
unless its time ran out. No face may leave the file's surface by more than surface_tolerance; of a mesh that is not
valid, not unsaid. Prints a line for each mesh. Exit code 1 where one of this does not hold."""
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ALMESH = ROOT / "almesh"
TOLERANCE = 1e-3  # surface_tolerance


def solids(occ):
    """Makes one model: name -> function."""
    def between(first, second):
        occ.fragment([(3, first)], [(3, second)])

    return {
        "sphere": lambda: occ.addSphere(0, 0, 0, 1),
        "torus": lambda: occ.addTorus(0, 0, 0, 1, 0.4),
        "cylinder": lambda: occ.addCylinder(0, 0, 0, 0, 0, 2, 0.5),
        "cone": lambda: occ.addCone(0, 0, 0, 0, 0, 1, 1, 0.3),
        "two-boxes": lambda: between(occ.addBox(0, 0, 0, 1, 1, 1), occ.addBox(1, 0, 0, 1, 1, 1)),
        "ball-in-box": lambda: between(occ.addBox(-1, -1, -1, 2, 2, 2), occ.addSphere(0, 0, 0, 0.6)),
        "plate-with-hole": lambda: occ.cut([(2, occ.addRectangle(-2, -1, 0, 4, 2))],
                                           [(2, occ.addDisk(0, 0, 0, 0.7, 0.2))]),
    }


def generate(folder):
    try:
        import gmsh
    except (ImportError, OSError):
        print("no meshes by gmsh: it is not there for this Python (python3-gmsh)")
        return []
    files = []
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    for name in solids(gmsh.model.occ):
        for degree in (1, 2):
            gmsh.model.add(name)
            for size in ("Mesh.MeshSizeMin", "Mesh.MeshSizeMax"):
                gmsh.option.setNumber(size, 0.3)
            gmsh.option.setNumber("Mesh.Optimize", 0)
            gmsh.option.setNumber("Mesh.MshFileVersion", 2.2 if degree == 1 else 4.1)
            solids(gmsh.model.occ)[name]()
            gmsh.model.occ.synchronize()
            dim = 2 if name.startswith("plate") else 3
            for _, tag in gmsh.model.getEntities(dim):
                gmsh.model.addPhysicalGroup(dim, [tag])
            gmsh.model.mesh.generate(dim)
            gmsh.model.mesh.setOrder(degree)
            files.append(folder / f"gmsh-{name}-{degree}.msh")
            gmsh.write(str(files[-1]))
            gmsh.model.remove()
    gmsh.finalize()
    return files


def almesh(*arguments):
    return subprocess.run([ALMESH, *arguments, "threads=1"], capture_output=True, text=True, cwd=ROOT)


def certified_bound(printed):
    return float(re.search(r"^(?:certified valid: )?certified bound (\S+)$", printed, re.M)[1])


def faults_of(file, result, seconds):
    """(what the run came to, list of what must not be)"""
    before = almesh("quality", file)
    run = almesh("improve", file, f"output={result}", "vtk=none", "final=input", f"max_seconds={seconds}")
    if run.returncode not in (0, 3, 4):
        return f"exit code {run.returncode}: {run.stderr.strip()}", ["refused"] if before.returncode == 0 else []
    after = almesh("quality", next(result.glob("final.*")), f"before={file}")
    rows = re.findall(r"^(?:scaled Jacobian[ *] before|                 after) +(\S+)", after.stdout, re.M)
    faults = []
    is_valid = "\ncertified valid: " in before.stdout
    if is_valid and float(rows[1]) < float(rows[0]):
        faults.append("the least scaled Jacobian of a corner became lower")
    is_curved = " of degree 1, " not in run.stdout.partition("\n")[0]
    if is_valid and is_curved and certified_bound(after.stdout) < certified_bound(before.stdout):
        faults.append("the certified bound became lower")
    table = after.stdout.partition("largest/edge   RMS/edge\n")[2].partition("\n\n")[0]
    is_off = any(float(row.split()[-2]) > TOLERANCE for row in table.splitlines())
    if is_off and (is_valid or ", NOT within surface_tolerance" not in run.stdout):
        faults.append("a face left the surface")
    interrupted = "max_seconds have passed" in run.stdout
    if before.returncode == 0 and run.returncode != 0 and not interrupted:
        faults.append("a valid mesh did not come out certified")
    end = "time ran out" if interrupted else f"exit code {run.returncode}"
    return f"{end}, {'' if is_valid else 'not '}valid, least scaled Jacobian {rows[0]} -> {rows[1]}", faults


def main():
    arguments = sys.argv[1:]
    seconds = 20
    if "--seconds" in arguments:
        at = arguments.index("--seconds")
        seconds = float(arguments[at + 1])
        del arguments[at:at + 2]
    failed = total = 0
    with tempfile.TemporaryDirectory() as temporary:
        files = sorted((ROOT / "inputs").rglob("*.msh")) + generate(Path(temporary))
        for file in files:
            if arguments and not any(name in file.stem for name in arguments):
                continue
            start = time.monotonic()
            came, faults = faults_of(file, Path(temporary) / f"result-{total}", seconds)
            print(f"{file.stem}: {came} ({time.monotonic() - start:.1f} s)" + "".join(f"; FAILS: {f}" for f in faults),
                  flush=True)
            failed += bool(faults)
            total += 1
    print(f"{failed} of {total} meshes fail")
    return 1 if failed or not total else 0


if __name__ == "__main__":
    sys.exit(main())

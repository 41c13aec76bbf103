#!/usr/bin/env python3
"""Compares the method in one file, src/lessons/almesh_in_one_file.cpp, with the program, in degree 1.

  tests/lessons/one_file.py [--build FOLDER] [--all] [--seed N]

A circle that is moved, a plate and a boundary layer that are turned: both have to take the same iterations with the
same updates, the same Newton steps from the second minimisation on (in the first the program damps its steps), and to
end with the same q, largest eta and |c_D|; the mesh of the one file has to be certified by the program.

Meshes good and bad, of verdicts.py: both accept them, with the same q, or neither does. Clockwise triangles, which the
program turns and tells, are refused by the one file with the same number, and accepted once they are exchanged. A
hundred and more; with --all a thousand.

The file includes the standard library alone and has 600 lines or less, and the command in its head compiles it. Exit
code 1 where something differs. Standard library only.
"""
import argparse
import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from verdicts import check_verdicts, counter_clockwise

ROOT = Path(__file__).resolve().parent.parent.parent
SOURCE = ROOT / "src" / "lessons" / "almesh_in_one_file.cpp"
CASES = {  # mesh: boundary that moves, its motion, boundary that stays
    "circle.msh": ("inner", "translate 8 0", "outer"),
    "plate.msh": ("plate", "rotate 30", "box"),
    "layer.msh": ("body", "rotate 30", "far"),
}
SETTINGS = ["objective=squared", "algorithm=paper", "length_scale=1", "mu0=24", "omega0=0.1", "epsilon0=1e-4",
            "omega_star=1e-6", "epsilon_star=1e-14", "continuation=never", "vtk=none"]


def of_one_file(build, folder, mesh, moving, motion):
    """Rows [|c_D|, q, largest eta, update, Newton steps]"""
    path = Path(folder) / mesh  # gmsh has made the triangles of layer.msh clockwise
    path.write_text(counter_clockwise((ROOT / "inputs" / "meshes" / mesh).read_text()))
    command = [build / "lessons" / "almesh_in_one_file", path, moving, *motion.split()]
    done = subprocess.run(command, cwd=folder, text=True, capture_output=True)
    if done.returncode != 0 or "certified: every triangle" not in done.stdout:
        sys.exit(f"{mesh}: {done.stdout}{done.stderr}ended with exit code {done.returncode}")
    rows = [line.split() for line in done.stdout.splitlines() if re.match(r"\s*\d", line)]
    return [[float(c), float(q), float(eta), update, int(steps)] for _, c, _, q, eta, _, update, steps in rows]


def of_program(build, folder, mesh, moving, motion, still):
    about = " about 0 0" if motion.startswith("rotate") else ""
    (folder / "case.deck").write_text(f"mesh = {ROOT}/inputs/meshes/{mesh}\nboundary {moving} = {motion}{about}\n"
                                      f"boundary {still} = fixed\noutput = {folder}/results\n")
    done = subprocess.run([build / "almesh", folder / "case.deck", *SETTINGS], text=True, capture_output=True)
    if done.returncode != 0:
        sys.exit(f"{mesh}: {done.stdout}{done.stderr}")
    with (folder / "results" / "history.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["kind"] == "al" and row["al_iteration"] != "0"]
    return [[float(row["constraint_norm"]), float(row["relative_quality"]), float(row["max_distortion"]),
             row["update"], int(row["newton_iterations"])] for row in rows]


def differences(build, mesh, moving, motion, still):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        one, program = (of_one_file(build, folder, mesh, moving, motion),
                        of_program(build, folder, mesh, moving, motion, still))
        certificate = subprocess.run([build / "almesh", "quality", folder / "outputs" / "lessons" / "one-file.vtk"],
                                     capture_output=True)
    found = [] if certificate.returncode == 0 else ["almesh quality does not certify one-file.vtk"]
    if [row[3] for row in one] != [row[3] for row in program]:
        found.append(f"updates {[row[3] for row in one]}, of the program {[row[3] for row in program]}")
    if [row[4] for row in one[1:]] != [row[4] for row in program[1:]]:
        found.append(f"Newton steps {[row[4] for row in one]}, of the program {[row[4] for row in program]}")
    for k, (what, tolerance) in enumerate([("|c_D|", 1e-3), ("q", 1e-9), ("largest eta", 1e-6)]):
        if abs(one[-1][k] - program[-1][k]) > tolerance * program[-1][k]:
            found.append(f"{what} is {one[-1][k]}, of the program {program[-1][k]}")
    steps = f"{len(one)} iterations, {sum(row[4] for row in one)} Newton steps"
    print(f"{mesh:<12} {steps}, q = {one[-1][1]:.8f}, largest eta {one[-1][2]:.6f}"
          f"{'  DIFFERS' if found else '  as the program'}")
    return [f"{mesh}: {text}" for text in found]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    build = (ROOT / options.build).resolve()
    failures = check_verdicts(build, SETTINGS, 1000 if options.all else 120, options.seed)
    failures += [text for mesh, case in CASES.items() for text in differences(build, mesh, *case)]
    lines = SOURCE.read_text().splitlines()
    failures += [f"{SOURCE.name}: {line}" for line in lines if line.startswith("#include") and "<" not in line]
    compiles = "//   g++ -std=c++20 -O2 src/lessons/almesh_in_one_file.cpp -o one-file"
    if compiles not in lines[:10]:
        failures.append(f"{SOURCE.name}: its head does not say how to compile it")
    elif options.all:
        with tempfile.TemporaryDirectory() as folder:
            command = compiles[5:].replace("one-file", f"{folder}/one-file").replace("src/", f"{ROOT}/src/")
            if subprocess.run(command.split()).returncode != 0:
                failures.append(f"{SOURCE.name}: the command in its head does not compile it")
    if len(lines) > 600:
        failures.append(f"{SOURCE.name} has {len(lines)} lines, more than 600")
    print("\n".join(failures), file=sys.stderr, end="\n" if failures else "")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

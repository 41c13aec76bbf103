#!/usr/bin/env python3
"""A flexible plate by CalculiX moves the mesh around it: clamped at its left end, it swings under its own weight, by
two fifths of its length. ccx's nodes on the plate are those of the fluid's mesh, so what it prints for each time is
almesh's node file. `make coupling`; Debian: calculix-ccx."""
import csv
import shutil
import subprocess
import sys
from pathlib import Path

FOLDER = Path("outputs/coupling/calculix")
MESH = Path("inputs/meshes/plate.msh")
ELEMENTS, HALF_LENGTH, HALF_HEIGHT = 25, 2.5, 0.1  # of 8 nodes each, in one layer
SIZE = HALF_LENGTH / ELEMENTS                      # of half an element
INNER = 100000                                     # ids from here on: nodes between elements, inside the plate
DECK = """mesh = ../../../inputs/meshes/plate.msh
boundary plate = file plate-%04d.csv displacement
boundary box = fixed
frames = times.csv
"""


def plate_nodes():
    """{place in the grid of half elements: node id of the mesh} of the nodes on the plate."""
    _, *rows = MESH.read_text().split("$Nodes\n")[1].split("\n$EndNodes")[0].split("\n")
    found = {}
    for number, x, y, _ in (row.split() for row in rows):
        if abs(float(x)) < HALF_LENGTH + 1e-6 and abs(float(y)) < HALF_HEIGHT + 1e-6:
            found[round((float(x) + HALF_LENGTH) / SIZE), round((float(y) + HALF_HEIGHT) / HALF_HEIGHT)] = int(number)
    return found


def displacements(path):
    """[(time, rows of id, ux, uy)] that ccx printed."""
    steps = []
    for words in (line.split() for line in path.read_text().split("\n")):
        if words[:1] == ["displacements"]:
            steps.append((words[-1], []))
        elif words:
            steps[-1][1].append(words[:3])
    return steps


if not shutil.which("ccx"):
    print("CalculiX is not here: apt-get install calculix-ccx")
    sys.exit()
shutil.rmtree(FOLDER, ignore_errors=True)
FOLDER.mkdir(parents=True)
at = plate_nodes()
corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
place = {(2 * k, 1): INNER + k for k in range(1, ELEMENTS)} | at
mesh = ["*NODE, NSET=PLATE",
        *(f"{n}, {i * SIZE - HALF_LENGTH:.17g}, {(j - 1) * HALF_HEIGHT}" for (i, j), n in place.items()),
        "*NSET, NSET=CLAMPED", *(f"{place[0, j]}" for j in range(3)), "*ELEMENT, TYPE=CPE8, ELSET=SOLID"]
mesh += [", ".join(map(str, [k + 1, *(place[2 * k + i, j] for i, j in corners)])) for k in range(ELEMENTS)]
(FOLDER / "mesh.inp").write_text("\n".join(mesh) + "\n")
shutil.copy("plot/coupling/calculix.inp", FOLDER / "plate.inp")
subprocess.run(["ccx", "-i", "plate"], cwd=FOLDER, check=True, stdout=subprocess.DEVNULL)
steps = displacements(FOLDER / "plate.dat")
(FOLDER / "times.csv").write_text("\n".join(t for t, _ in steps) + "\n")
for k, (_, rows) in enumerate(steps, 1):
    lines = [",".join(row) for row in rows if int(row[0]) < INNER]
    (FOLDER / f"plate-{k:04d}.csv").write_text("\n".join(lines) + "\n")
(FOLDER / "plate.deck").write_text(DECK)
run = subprocess.run(["./almesh", FOLDER / "plate.deck", f"output={FOLDER}/mesh"], check=True, text=True,
                     stdout=subprocess.PIPE)
print("CalculiX: t, displacement of the tip, Newton steps, largest eta, certified valid and injective")
with (FOLDER / "mesh" / "frames.csv").open(newline="") as file:
    for frame, (_, rows) in list(zip(csv.DictReader(file), steps))[4::5]:
        tip = next(float(row[2]) for row in rows if int(row[0]) == at[2 * ELEMENTS, 1])
        print(f"{float(frame['t']):5.2f}  {tip:6.3f}  {frame['newton_steps']:>2}  {float(frame['max_distortion']):.3f}  "
              f"{frame['certified']}")
print(run.stdout.splitlines()[-1])

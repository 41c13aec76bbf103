#!/usr/bin/env python3
"""A flexible plate by CalculiX moves the mesh around it: clamped at its left end, it swings under its own weight, by
two fifths of its length. ccx's nodes on the plate are those of the fluid's mesh, so what it prints for each time is
almesh's node file. `make coupling`; Debian: calculix-ccx."""
import shutil
import subprocess
from pathlib import Path

import clients

MESH = Path("inputs/meshes/plate.msh")
ELEMENTS, HALF_LENGTH, HALF_HEIGHT = 25, 2.5, 0.1  # of 8 nodes each, in one layer
SIZE = HALF_LENGTH / ELEMENTS                      # of half an element
INNER = 100000                                     # ids from here on: nodes between elements, inside the plate
DECK = """mesh = ../../../inputs/meshes/plate.msh
boundary plate = file - displacement
boundary box = fixed
"""


def solid_mesh():
    """{place in the grid of half elements: node id}, first those inside the plate, and the mesh as ccx reads it."""
    place = {(2 * k, 1): INNER + k for k in range(1, ELEMENTS)}
    for number, (x, y, _) in clients.nodes(MESH).items():
        if abs(x) < HALF_LENGTH + 1e-6 and abs(y) < HALF_HEIGHT + 1e-6:
            place[round((x + HALF_LENGTH) / SIZE), round(y / HALF_HEIGHT) + 1] = number
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    lines = ["*NODE, NSET=PLATE"]
    lines += [f"{n}, {i * SIZE - HALF_LENGTH:.17g}, {(j - 1) * HALF_HEIGHT}" for (i, j), n in place.items()]
    lines += ["*NSET, NSET=CLAMPED", *(f"{place[0, j]}" for j in range(3)), "*ELEMENT, TYPE=CPE8, ELSET=SOLID"]
    lines += [", ".join(map(str, [k + 1, *(place[2 * k + i, j] for i, j in corners)])) for k in range(ELEMENTS)]
    return place, "\n".join(lines) + "\n"


def displacements(path):
    """[(time, rows of id, ux, uy)] that ccx printed."""
    steps = []
    for words in map(str.split, path.read_text().split("\n")):
        if words[:1] == ["displacements"]:
            steps.append((words[-1], []))
        elif words:
            steps[-1][1].append(words[:3])
    return steps


clients.need("calculix-ccx", "ccx")
folder = clients.new_folder("calculix")
place, mesh = solid_mesh()
(folder / "mesh.inp").write_text(mesh)
shutil.copy("plot/coupling/calculix.inp", folder / "plate.inp")
subprocess.run(["ccx", "-i", "plate"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
steps = displacements(folder / "plate.dat")
print("CalculiX: t, displacement of the tip")
coupled = clients.Coupled(folder, DECK)
for k, (t, rows) in enumerate(steps, 1):
    (folder / "plate.csv").write_text("\n".join(",".join(row) for row in rows if int(row[0]) < INNER) + "\n")
    coupled.mesh(t, folder / "plate.csv")
    if k % 5 == 0:
        tip = next(float(row[2]) for row in rows if int(row[0]) == place[2 * ELEMENTS, 1])
        print(f"{float(t):4.2f}  {tip:6.3f}")
coupled.end()

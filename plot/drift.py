#!/usr/bin/env python3
"""Drift: a plate pitches and plunges for some periods, and its mesh is moved step by step. A method that starts each
step from the mesh that the last one left adds up what the steps do to the elements; one that starts from the mesh of
the file does not. Writes to outputs/drift/

  drift.csv   the worst shape quality of the mesh at each time, as `almesh quality` prints it
  table.md    the worst of some periods, and how far nodes are from where they were at t = 0.25
  drift.png   the same as curves; a curve ends at a cross where no valid mesh came out

  plot/drift.py          the same as `make drift`; half a minute
  plot/drift.py --table  table and figure of an earlier drift.csv

Needs numpy, scipy and matplotlib.
"""
import csv
import re
import subprocess
import sys

import numpy as np
from scipy.interpolate import RBFInterpolator

import runs

FOLDER = runs.OUTPUTS / "drift"
MESH = runs.OUTPUTS.parent / "inputs" / "meshes" / "plate.msh"
PERIODS, STEPS = 10, 20  # steps of a period
PITCH, PLUNGE = 60, 2    # the plate is 5 long, its box 20 by 20
FILE, LAST = "each from the file", "each from the last"
# Title, how it moves the mesh, colour of the curve.
METHODS = [
    ("almesh, frames", "frames", "#c2410c"),
    (f"almesh, {LAST}", "augmented_lagrangian", "#f29b4b"),
    (f"elasticity, {FILE}", "elasticity file", "#a9cbe6"),
    (f"elasticity, {LAST}", "elasticity", "#16588e"),
    (f"RBF, {FILE}", "rbf file", "#b9dcc6"),
    (f"RBF, {LAST}", "rbf", "#2f6f4f"),
]


def read_nodes(path):
    """Ids and positions (nodes x 3) of a mesh in MSH 2.2."""
    nodes = runs.nodes(path)
    return np.array(list(nodes)), np.array(list(nodes.values()))


def write_nodes(path, positions):
    """The mesh of the file with its nodes elsewhere."""
    lines = MESH.read_text().split("\n")
    first = lines.index("$Nodes") + 2
    lines[first:first + len(positions)] = [" ".join([line.split()[0], *map(repr, map(float, x))])
                                           for line, x in zip(lines[first:], positions)]
    path.write_text("\n".join(lines))


def plate_at(t, x):
    """Positions of points of the plate at time t."""
    angle = np.radians(PITCH) * np.sin(2 * np.pi * t)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    return x @ turn.T + [0, PLUNGE * (1 - np.cos(2 * np.pi * t)), 0]


def almesh(*words):
    return subprocess.run(["./almesh", *words], capture_output=True, text=True, check=False)


def quality(path):
    """Worst shape quality of a mesh; 0 where it is not certified."""
    out = almesh("quality", str(path), "threads=1").stdout
    valid = "\ncertified valid: " in out and "certified injective" in out and "NOT" not in out
    return float(re.search(r"^quality 1/eta +(\S+)", out, re.M)[1]) if valid else 0.0


def deck(mesh, output, *more, program=("./almesh",)):
    """Whether a run of the plate, with the targets of its nodes in plate-NNNN.csv, ended well."""
    path = FOLDER / "plate.deck"
    path.write_text("\n".join([f"mesh = {mesh}", "boundary box = fixed", "vtk = none", "threads = 1", *more]) + "\n")
    command = [*program, str(path), f"output={output}"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def meshes(way, start, on_plate, on_wall):
    """One mesh after the other, None where there is none."""
    frames = range(1, PERIODS * STEPS + 2)
    output = FOLDER / way.replace(" ", "-")
    if way == "frames":
        deck(MESH, output, "boundary plate = file plate-%04d.csv", f"frames = 0 : {1 / STEPS} : {PERIODS}")
    last = MESH
    for k in frames:
        if way == "frames":
            last = output / f"frame-{k:04d}.msh"
        elif way.startswith("rbf"):
            now = read_nodes(MESH if "file" in way else last)[1]
            goal = np.where(on_plate[:, None], plate_at((k - 1) / STEPS, start), start)
            move = RBFInterpolator(now[on_wall, :2], (goal - now)[on_wall, :2], kernel="thin_plate_spline", degree=1)
            last = FOLDER / f"{output.name}.msh"
            write_nodes(last, np.column_stack([now[:, :2] + move(now[:, :2]), start[:, 2]]))
        else:
            program = ["build/examples/comparators", "elasticity", "1"] if "elasticity" in way else ["./almesh"]
            out = FOLDER / f"{output.name}-{k % 2}"  # the mesh of the last step is in the other
            plate = f"boundary plate = file plate-{k:04d}.csv"
            if not deck(MESH if "file" in way else last, out, plate, program=program):
                yield None
                return
            last = out / "final.msh"
        yield last if last.exists() else None


def run_all():
    FOLDER.mkdir(parents=True, exist_ok=True)
    ids, start = read_nodes(MESH)
    on_wall = np.isin(ids, boundary_nodes())
    on_plate = on_wall & (np.abs(start[:, 0]) < 5) & (np.abs(start[:, 1]) < 5)
    for k in range(PERIODS * STEPS + 1):
        rows = np.column_stack([ids[on_plate], plate_at(k / STEPS, start)[on_plate, :2]])
        np.savetxt(FOLDER / f"plate-{k + 1:04d}.csv", rows, ["%d", "%.17g", "%.17g"])
    with (FOLDER / "drift.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["method", "t", "quality", "off"])
        for title, way, _ in METHODS:
            for k, path in enumerate(meshes(way, start, on_plate, on_wall)):
                worst = quality(path) if path else 0.0
                off = ""
                if path and k % STEPS == STEPS // 4:
                    nodes = read_nodes(path)[1]
                    first = nodes if k < STEPS else first
                    off = np.linalg.norm(nodes - first, axis=1).max()
                writer.writerow([title, k / STEPS, worst, off])
                if worst == 0 and "file" not in title:
                    break
            file.flush()


def boundary_nodes():
    """Ids of the nodes of the line elements in the file."""
    elements = MESH.read_text().split("$Elements\n")[1].split("\n")
    return [int(word) for line in elements for word in line.split()[-2:] if line.split()[1:2] == ["1"]]


def table(rows):
    shown = (1, 2, 3, 5, PERIODS)
    heads = ["method", "valid up to", *(f"period {p}" for p in shown), "nodes off at t = 1.25", f"at {PERIODS - 0.75}"]
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    for title, *_ in METHODS:
        own = [row for row in rows if row["method"] == title and float(row["quality"]) > 0]
        cells = [title, f"t = {float(own[-1]['t']):g}"]
        for p in shown:
            values = [float(row["quality"]) for row in own if p - 1 < float(row["t"]) <= p]
            cells.append(f"{min(values):.4g}" if len(values) == STEPS else "✗")
        for t in (1.25, PERIODS - 0.75):
            off = [float(row["off"]) for row in own if float(row["t"]) == t]
            cells.append(f"{off[0]:.2g}" if off else "✗")
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def figure(rows):
    from style import INK, apply, plt
    apply()
    fig, ax = plt.subplots(figsize=(9, 3.6), layout="constrained")
    for title, _, colour in METHODS:
        own = [(float(row["t"]), float(row["quality"])) for row in rows if row["method"] == title]
        ax.plot(*zip(*((t, q if q else np.nan) for t, q in own)), color=colour, label=title, linewidth=1.3)
        lost = [(own[i - 1][0], own[i - 1][1]) for i in range(1, len(own)) if own[i][1] == 0 and own[i - 1][1] > 0]
        ax.plot(*(zip(*lost) if lost else ((), ())), "x", color=colour, markersize=6, zorder=5)
    ax.set(xlabel="periods", ylabel="worst shape quality of an element", xlim=(0, PERIODS), ylim=(0, 0.75))
    ax.legend(loc="upper left", bbox_to_anchor=(1, 1), labelcolor=INK)
    fig.savefig(FOLDER / "drift.png", facecolor="white", dpi=110)


if __name__ == "__main__":
    if sys.argv[1:] != ["--table"]:
        run_all()
    with (FOLDER / "drift.csv").open(newline="") as lines:
        results = list(csv.DictReader(lines))
    (FOLDER / "table.md").write_text(table(results))
    figure(results)
    print(table(results), end="")

#!/usr/bin/env python3
"""Puts the Newton iterates of inputs/circle.deck into the page circle.html beside this file: runs the program, reads
its VTK files and history.csv. The page has the positions in 16 bits for each coordinate.

  plot/lessons/pages/circle_data.py [PROGRAM]     ./almesh where none is named

Standard library only. Exit code 1 where |c_D| of an iterate, from its positions, is not that of history.csv.
"""
import base64
import csv
import json
import math
import re
import subprocess
import sys
import tempfile
from array import array
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent.parent
sys.path.insert(0, str(ROOT / "plot"))
import vtk_file

PAGE = Path(__file__).with_name("circle.html")
HALF_WIDTH = 22  # of the square that 16 bits divide


def boundary_of(triangles):
    """The edges that one triangle has."""
    sides = Counter(tuple(sorted((t[k], t[(k + 1) % 3]))) for t in triangles for k in range(3))
    return [side for side, count in sides.items() if count == 1]


def violation(x, start, edges):
    """|c_D| of lesson 7: each edge has the matrix (2 1; 1 2)/6. The circle has radius 1 and goes by 8."""
    def off(node):
        is_inner = math.hypot(start[3 * node], start[3 * node + 1]) < 2
        return [x[3 * node + a] - start[3 * node + a] - (8 if is_inner and a == 0 else 0) for a in (0, 1)]

    total = 0
    for a, b in edges:
        u, v = off(a), off(b)
        total += sum(u[k] * u[k] + u[k] * v[k] + v[k] * v[k] for k in (0, 1)) / 3
    return math.sqrt(total / len(edges))


def packed(kind, numbers):
    """base64 of little-endian numbers of 16 bits."""
    values = array(kind, numbers)
    if sys.byteorder == "big":
        values.byteswap()
    return base64.b64encode(values.tobytes()).decode()


def run(program, folder):
    """(frames, rows): the VTK files of the iterates, and what history.csv says of each."""
    subprocess.run([program, ROOT / "inputs" / "circle.deck", "iterates=1", f"output={folder}"], check=True,
                   stdout=subprocess.DEVNULL)
    with (folder / "history.csv").open(newline="") as file:
        history = list(csv.DictReader(file))
    ends = {int(row["al_iteration"]): row for row in history if row["kind"] == "al"}
    rows = [{"k": 0, "mu": None, "update": None, "c": float(ends[0]["constraint_norm"])}]
    for step in (row for row in history if row["kind"] == "newton"):
        end = ends[int(step["al_iteration"])]
        rows.append({"k": int(step["al_iteration"]), "mu": float(end["mu"]), "update": end["update"], "c": None})
    for before, after in zip(rows, rows[1:] + [None]):
        if after is None or after["k"] != before["k"]:
            before["c"] = float(ends[before["k"]]["constraint_norm"])
    return [vtk_file.read(path) for path in sorted(folder.glob("iterate-*.vtk"))], rows


def main(program):
    with tempfile.TemporaryDirectory() as name:
        frames, rows = run(program, Path(name))
    triangles = [tuple(frames[0].cells[4 * e + 1:4 * e + 4]) for e in range(len(frames[0].types))]
    edges, start = boundary_of(triangles), frames[0].points
    for vtk, row in zip(frames, rows, strict=True):
        c = violation(vtk.points, start, edges)
        if row["c"] is not None and not math.isclose(c, row["c"], rel_tol=1e-6, abs_tol=1e-13):
            sys.exit(f"|c_D| is {c}, in history.csv {row['c']}")
        row.update(c=float(f"{c:.4g}"), eta=float(f"{max(vtk.cell_data['distortion']):.6g}"))
    scale = 65535 / (2 * HALF_WIDTH)
    data = {
        "rows": json.dumps(rows),
        "triangles": packed("H", [node for t in triangles for node in t]),
        "positions": packed("H", [round(scale * (vtk.points[3 * i + a] + HALF_WIDTH)) for vtk in frames
                                  for i in range(len(start) // 3) for a in (0, 1)])}
    text = PAGE.read_text()
    for name, value in data.items():
        lines = value.replace("}, ", "},\n") if name == "rows" else re.sub("(.{118})", r"\1\n", value)
        text, found = re.subn(rf'(<script id="{name}"[^>]*>)[^<]*(</script>)', rf"\1\n{lines}\n\2", text)
        if found != 1:
            sys.exit(f"{PAGE} has no place for {name}")
    PAGE.write_text(text)
    print(f"{PAGE.relative_to(ROOT)}: {len(frames)} iterates, {len(triangles)} triangles")


if __name__ == "__main__":
    main(sys.argv[1] if sys.argv[1:] else ROOT / "almesh")

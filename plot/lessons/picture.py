"""What the lessons' pictures share: the look, the tables that the programs wrote, where pictures go.

A script draws one picture from outputs/lessons/NN-name/ and saves it there as NN-name.png; the copies that the handouts
show lie beside the scripts (`picture.save` writes them where the environment has KEEP=1).
"""
import csv
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np

import runs
import style
from style import ACCENT, DISTORTION, INK, PAPER, plt
from vtk_mesh import read_vtk

LESSONS = runs.OUTPUTS / "lessons"


def figure(rows=1, columns=1, size=(6, 4), **options):
    """(figure, axes) in the style of the other figures."""
    style.apply()
    return plt.subplots(rows, columns, figsize=size, layout="constrained", **options)


def table(name):
    """{column: numbers, or texts where a cell is none} of outputs/lessons/<name>."""
    path = LESSONS / name
    if not path.exists():
        sys.exit(f"{path} is missing: `make lesson-{name[:2]}` runs the programs that write it")
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {column: numbers([row[column] for row in rows]) for column in rows[0]}


def numbers(texts):
    try:
        return np.array([float(text or "nan") for text in texts])
    except ValueError:
        return np.array(texts)


def mesh(name):
    """The mesh in outputs/lessons/<name>, a .vtk file."""
    return read_vtk(LESSONS / name)


def save(fig, name, folder=None):
    path = LESSONS / (folder or name) / f"{name}.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    fig.draw_without_rendering()  # axes of equal aspect need a second layout
    fig.savefig(path, facecolor="white", dpi=110)
    print(path.relative_to(runs.OUTPUTS.parent))
    if os.environ.get("KEEP"):  # with a palette: a third of the size
        from PIL import Image
        Image.open(path).convert("RGB").quantize(128).save(Path(__file__).parent / path.name, optimize=True)
    plt.close(fig)

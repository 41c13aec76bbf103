#!/usr/bin/env python3
"""Lesson 13: how often two meshes of sound triangles cover each point; signs that floating-point numbers get wrong."""
import numpy as np
from matplotlib.colors import ListedColormap

import picture


def grid(name, columns):
    """The numbers of a table, one for each pair of the first two columns, as a matrix."""
    data = picture.table(f"13-injectivity/{name}.csv")
    x, y = (np.unique(data[column]) for column in columns[:2])
    return x, y, data[columns[2]].reshape(len(y), len(x))


def edges(name):
    """The triangles of a mesh, as closed lines."""
    lines = (picture.LESSONS / "13-injectivity" / f"{name}.msh").read_text().split("\n")
    at, to = lines.index("$Nodes") + 2, lines.index("$Elements") + 2
    x = np.array([line.split()[1:3] for line in lines[at:to - 3]], dtype=float)
    triangles = [list(map(int, line.split()[5:])) for line in lines[to:-2]]
    return [x[np.array(t + t[:1]) - 1] for t in triangles]


fig, axes = picture.figure(1, 3, size=(9.6, 3.5))
numbers = ListedColormap(["white", "#c9dbe8", picture.ACCENT])
for ax, name, title in ((axes[0], "strip", "a strip that goes around twice"),
                        (axes[1], "sheets", "two octagons joined crosswise")):
    x, y, number = grid(name, ("x", "y", "number"))
    ax.pcolormesh(x, y, number, cmap=numbers, vmin=-0.5, vmax=2.5, rasterized=True)
    for line in edges(name):
        ax.plot(*line.T, color=picture.INK, linewidth=0.6)
    ax.set(title=f"{title};\norange: covered twice", aspect="equal")
    ax.axis("off")
x, y, sign = grid("signs", ("i", "j", "sign"))
axes[2].pcolormesh(x, y, sign, cmap=ListedColormap([picture.ACCENT, "white", "#8fb3cc"]), rasterized=True)
axes[2].plot([0, 255], [0, 255], color=picture.INK, linewidth=0.8)
axes[2].set(title="signs by doubles, beside a line:\norange -1, white 0, blue 1", aspect="equal", xlabel="i", ylabel="j")
picture.save(fig, "13-injectivity")

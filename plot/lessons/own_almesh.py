#!/usr/bin/env python3
"""An almesh of one's own: the mesh that it has moved, and how the iterations came to it."""
import numpy as np

import picture
from style import polygons, window_around

mesh, table = picture.mesh("12-project/own.vtk"), picture.table("12-project/own.csv")
fig, (left, near, right) = picture.figure(1, 3, size=(12, 3.9), width_ratios=[1, 1, 1.1])
corners = mesh.points[mesh.cells][:, :, :2]
eta = mesh.cell_data["eta"]
worst = corners[np.argmax(eta)].mean(axis=0)
size = np.ptp(mesh.points[:, :2], axis=0).max()
for ax, half, title in ((left, 0.52 * size, f"{len(eta)} triangles"),
                        (near, 0.1 * size, f"at the most distorted one, η = {eta.max():.3f}")):
    cells = polygons(ax, corners, eta, picture.style.Normalize(1, eta.max()), picture.DISTORTION, 0.3)
    x, y = (mesh.points[:, :2].min(axis=0) + mesh.points[:, :2].max(axis=0)) / 2 if ax is left else worst
    picture.style.picture(ax, window_around(x, y, half), title)
fig.colorbar(cells, ax=near, shrink=0.8, label="η")

right.semilogy(table["k"], table["c"], "o-", color=picture.INK, label="$|c_D|$")
right.semilogy(table["k"], table["gradient"], "s--", color=picture.ACCENT, label=r"$|\nabla L|$")
for k, c, update, steps in zip(table["k"], table["c"], table["update"], table["newton"]):
    right.annotate(f"{int(steps)} Newton, {update}", (k, c), (6, 4), textcoords="offset points", fontsize=7)
right.axhline(1e-7, color=picture.PAPER, linewidth=0.7, linestyle=":")
right.set(xlabel="iteration of Algorithm 1", title=f"q = {table['q'][-1]:.4f}", xlim=(0.8, table["k"][-1] + 1.6))
right.set_xticks(table["k"])
right.legend(fontsize=8, loc="lower left")
picture.save(fig, "own-almesh", "12-project")

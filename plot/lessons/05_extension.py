#!/usr/bin/env python3
"""Lesson 5: harmonic extensions of a translation and a rotation, near the circle; and how far increments get."""
import numpy as np
from matplotlib.collections import PolyCollection

import picture

fig, axes = picture.figure(1, 3, size=(9, 3.1), width_ratios=[1, 1, 1.1])
for ax, name, centre in zip(axes, ["translate 4 0 in 1", "rotate 55 about 0 0 in 1"], [4, 0]):
    mesh = picture.mesh(f"05-extension/{name}.vtk")
    triangles = mesh.points[mesh.cells][..., :2]
    side = np.roll(triangles, -1, axis=1) - triangles
    inverted = side[:, 0, 0] * side[:, 1, 1] - side[:, 0, 1] * side[:, 1, 0] <= 0
    for chosen, face, edge in [(~inverted, "white", picture.PAPER), (inverted, picture.ACCENT, picture.ACCENT)]:
        ax.add_collection(PolyCollection(triangles[chosen], facecolors=face, edgecolors=edge, linewidths=0.4))
    ax.set(xlim=(centre - 1.4, centre + 1.6), ylim=(-1.5, 1.5), aspect="equal", xticks=[], yticks=[],
           title=f"{name.removesuffix(' in 1')}: {inverted.sum()} inverted")

data = picture.table("05-extension/reach.csv")
axes[2].semilogx(data["increments"], data["translation"] / np.log(21), "o-", color=picture.INK,
                 label=r"translation / $\ln 21$")
axes[2].semilogx(data["increments"], data["rotation"] / 60, "s-", color=picture.ACCENT, label="rotation / 60°")
axes[2].axhline(1, color=picture.PAPER, linewidth=0.7, linestyle=":")
axes[2].set(xlabel="increments", title="reach", ylim=(0, None), xticks=data["increments"],
            xticklabels=[f"{n:.0f}" for n in data["increments"]])
axes[2].minorticks_off()
axes[2].legend()
picture.save(fig, "05-extension")

#!/usr/bin/env python3
"""Lesson 1: eta and eta_delta of a triangle as maps over the place of one of its vertices."""
import numpy as np

import picture

fig, axes = picture.figure(1, 2, size=(9, 4.2))
data = picture.table("01-distortion/map.csv")
shape = (len(np.unique(data["y"])), len(np.unique(data["x"])))
x, y = data["x"].reshape(shape), data["y"].reshape(shape)
titles = [r"$\eta$, infinite below the edge", r"$\eta_\delta$, $\delta = 0.1$"]
for ax, name, title in zip(axes, ["eta", "eta_delta"], titles):
    value = np.clip(data[name].reshape(shape), 1, 1e3)
    cells = ax.contourf(x, y, np.log10(value), levels=np.linspace(0, 3, 25), cmap=picture.DISTORTION)
    levels = ax.contour(x, y, value, levels=[1.1, 1.5, 2, 3, 5, 10, 30], colors=picture.INK, linewidths=0.5)
    ax.clabel(levels, fmt="%g", fontsize=7)
    ax.plot([0, 1], [0, 0], color=picture.INK, linewidth=2)
    ax.plot([0, 0.5, 1], [0, np.sqrt(3) / 2, 0], ":", color=picture.INK, linewidth=1)
    ax.set(title=title, aspect="equal", xlabel="x of the vertex", ylabel="y of the vertex")
fig.colorbar(cells, ax=axes, label=r"$\log_{10}$", shrink=0.8)
picture.save(fig, "01-distortion")

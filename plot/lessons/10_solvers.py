#!/usr/bin/env python3
"""Lesson 10: where the factor L has its entries, by ordering; how the residual of conjugate gradients falls."""
import numpy as np

import picture

fig, axes = picture.figure(2, 3, size=(9.6, 6.4))
pattern = picture.table("10-solvers/soft/pattern.csv")
titles = {"natural": "natural", "rcm": "reverse Cuthill-McKee", "minimum_degree": "minimum degree",
          "nested_dissection": "nested dissection"}
for ax, (ordering, title) in zip(axes.flat, titles.items()):
    chosen = pattern["ordering"] == ordering
    grid = np.full((100, 100), np.nan)
    grid[pattern["row"][chosen].astype(int), pattern["column"][chosen].astype(int)] = pattern["entries"][chosen]
    ax.imshow(grid, cmap="Blues", vmin=-40, vmax=290, interpolation="nearest")
    ax.set(title=f"L, {title}", xticks=[], yticks=[])
for ax, folder, title in zip(axes.flat[4:], ["soft", "stiff"], ["μ = 960", "μ = 96000"]):
    history = picture.table(f"10-solvers/{folder}/residuals.csv")
    for method in dict.fromkeys(history["method"]):
        chosen = history["method"] == method
        ax.semilogy(history["iteration"][chosen], history["residual"][chosen], label=method, linewidth=1.2)
    ax.set(title=title, xlabel="iteration", ylabel="|b - A x| / |b|", xlim=(0, 200), ylim=(1e-8, 30))
    ax.legend(fontsize=7)
picture.save(fig, "10-solvers")

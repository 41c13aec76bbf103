#!/usr/bin/env python3
"""Lesson 11: growth of Cholesky's factor in 2D and 3D; time of the circle per unknown; the aircraft's by phases."""
import numpy as np

import picture

fig, (ax, middle, right) = picture.figure(1, 3, size=(10.5, 3.8))
growth = picture.table("11-cost/growth.csv")
for name, dim, power in [("circle", 2, 1.5), ("sphere-shell", 3, 2)]:
    chosen = growth["mesh"] == name
    n, entries, flops = (growth[column][chosen] for column in ("unknowns", "factor", "flops"))
    line, = ax.loglog(n, entries / n, "o-", markersize=4, label=f"{dim}D: nnz(L) / N")
    ax.loglog(n, flops / n, "s--", markersize=4, color=line.get_color(), label=f"{dim}D: flops / N")
    law = np.log(n) if dim == 2 else n ** (1 / 3)
    ax.loglog(n, entries[-1] / n[-1] * law / law[-1], ":", color=picture.INK, linewidth=0.8)
    ax.loglog(n, flops[-1] / n[-1] * (n / n[-1]) ** (power - 1), ":", color=picture.INK, linewidth=0.8)
ax.set(title="Cholesky, per unknown; dotted: the laws", xlabel="unknowns N")
ax.legend(fontsize=7)

runs = [picture.runs.summary(f"lessons/11-cost/circle-{r}") for r in range(4)]
n = np.array([2 * float(run["nodes"]) for run in runs])
for part, label in [("time_total", "all"), ("time_linear", "linear solves"), ("time_assembly", "assembly")]:
    seconds = np.array([float(run[part]) / float(run["newton_iterations"]) for run in runs])
    middle.semilogx(n, 1e6 * seconds / n, "o-", markersize=4, label=label)
paper = np.array([1.11, 3.56, 14.29, 101.94])  # Table 1
middle.set(title="Circle: µs per unknown and Newton step", xlabel="unknowns N", ylim=(0, None))
middle.legend(fontsize=7, title=f"Paper, whole run: {1e6 * paper[0] / n[0]:.0f} to {1e6 * paper[-1] / n[-1]:.0f}",
              title_fontsize=7)

names = ["setup", "assembly", "linear", "line_search", "certify", "write"]
for place, folder in enumerate(["one-thread", "aircraft"]):
    run, start = picture.runs.summary(f"lessons/11-cost/{folder}"), 0
    for name, colour in zip(names, picture.DISTORTION(np.linspace(0.1, 0.95, len(names)))):
        seconds = float(run[f"time_{name}"])
        label = name.replace("_", " ") if place else None
        right.bar(place, seconds, bottom=start, color=colour, width=0.6, label=label)
        start += seconds
right.set(title="Aircraft: seconds", xlim=(-0.5, 2.6))
right.set_xticks([0, 1], ["1 thread", "all threads"])
right.legend(fontsize=7)
picture.save(fig, "11-cost")

#!/usr/bin/env python3
"""Lesson 9: det J of a triangle that folds between its quadrature points; the error of the boundary over its edges."""
import numpy as np

import picture

fig, (ax, right) = picture.figure(1, 2, size=(9, 4.2), width_ratios=[1, 1.1])
data = picture.table("09-curving/map.csv")
points = picture.table("09-curving/points.csv")
xi, eta, det = data["xi"], data["eta"], data["det"]
ax.tricontourf(xi, eta, det, levels=np.linspace(-2, 2, 41), cmap="RdBu")
ax.tricontourf(xi, eta, det, levels=[-10, 0], colors=[picture.ACCENT])
ax.plot(points["xi"], points["eta"], "o", color=picture.INK, markersize=3, label="12 quadrature points")
ax.plot([0, 1, 0, 0.5, 0.5, 0], [0, 0, 1, 0, 0.5, 0.5], "s", color="white", markeredgecolor=picture.INK, label="nodes",
        markersize=5, clip_on=False)
ax.set(title="det J for s = 1; orange: less than 0", aspect="equal", xlabel="ξ", ylabel="η")
ax.legend(fontsize=8, loc="lower right", bbox_to_anchor=(1, 0.52))
inset = ax.inset_axes([0.62, 0.68, 0.38, 0.32])
for edge in (eta == 0, xi == 0, abs(xi + eta - 1) < 1e-9):
    inset.plot(data["x"][edge], data["y"][edge], color=picture.INK, linewidth=1)
inset.axis("off")
inset.set(aspect="equal")

for p, marker in zip(range(1, 5), "osD^"):
    runs = [picture.runs.summary(f"lessons/09-curving/p{p}-r{r}") for r in range(3)]
    h = 2.0 ** -np.arange(3)
    error = np.array([float(run["constraint_norm"]) for run in runs])
    line, = right.loglog(h, error, marker=marker, label=f"degree {p}")
    right.loglog(h, error[-1] * (h / h[-1]) ** (p + 1), ":", color=line.get_color(), linewidth=0.8)
right.set(title="$e_h$ of the ring; dotted: slope p + 1",
          xlabel="length of an edge, the coarsest = 1", ylabel="$|c_D|$ at the end")
right.set_xticks([0.25, 0.5, 1], ["1/4", "1/2", "1"])
right.minorticks_off()
right.legend(fontsize=8)
picture.save(fig, "09-curving")

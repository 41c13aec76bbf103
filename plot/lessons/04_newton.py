#!/usr/bin/env python3
"""Lesson 4: a swirled mesh with its boundary bent, and how the gradient falls on the way to the minimum."""
import picture
from style import polygons

fig, (start, bent, held) = picture.figure(1, 3, size=(10.5, 3.8))
mesh = picture.mesh("04-newton/start-90-bent.vtk")
x = mesh.points[:, :2]
polygons(start, x[mesh.cells], line_width=0.4)
start.plot(*x.T, ".", color=picture.INK, markersize=1.5)
start.set(title="start: 90 degrees, bent", aspect="equal", xticks=[], yticks=[])

for ax, title, runs in [
        (bent, r"$|g|$, $\eta^2$, 90 degrees, bent",
         [("search-90-bent", "full: no descent", picture.PAPER), ("projected-90-bent", "projected", picture.INK),
          ("switching-90-bent", "switching", picture.ACCENT)]),
        (held, r"$|g|$, 60 degrees, full Hessian",
         [("pure-60-deviation", r"$(\eta - 1)^2$", picture.INK), ("pure-60", r"$\eta^2$", picture.ACCENT)])]:
    for name, label, colour in runs:
        data = picture.table(f"04-newton/{name}.csv")
        ax.semilogy(data["step"], data["gradient"], "o-", color=colour, markersize=3.5, linewidth=1, label=label)
    ax.set(title=title, xlabel="step")
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.legend()
picture.save(fig, "04-newton")

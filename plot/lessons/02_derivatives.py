#!/usr/bin/env python3
"""Lesson 2: the errors of Taylor polynomials of eta, and those of finite differences near the barrier."""
import numpy as np

import picture

fig, (left, right) = picture.figure(1, 2, size=(9, 4))
data = picture.table("02-derivatives/slopes.csv")
for degree, colour in enumerate([picture.PAPER, picture.INK, picture.ACCENT]):
    error = data[f"degree_{degree}"]
    left.loglog(data["h"], error, "o-", color=colour, markersize=3.5, linewidth=1)
    left.annotate(f"degree {degree}: slope {degree + 1}", (data["h"][0], error[0]), xytext=(7, -3),
                  textcoords="offset points", color=colour)
left.set(title="error of the Taylor polynomial", xlabel="h", ylabel=r"error of $\eta$", xlim=(5e-4, 1.5))

data = picture.table("02-derivatives/differences.csv")
for height, colour in zip([0.8, 0.08, 0.008], [picture.PAPER, picture.INK, picture.ACCENT]):
    of_height = data["height"] == height
    h, error = data["h"][of_height], data["error"][of_height]
    finite = np.isfinite(error)
    right.loglog(h[finite], error[finite], color=colour, linewidth=1, label=f"height {height:g}")
    right.axvline(h[finite].max(), color=colour, linestyle=":", linewidth=1)
right.set(title=r"error of the central difference of $\eta$", xlabel="h", ylabel="relative error", ylim=(1e-13, 1e2))
right.annotate("rounding", (3e-12, 1e-11), color=picture.INK)
right.annotate("truncation", (3e-5, 1e-11), color=picture.INK)
right.legend(title="dotted: the barrier", loc="upper left")
picture.save(fig, "02-derivatives")

#!/usr/bin/env python3
"""Lesson 6: where the circles end, the violation of the constraint, and what a large penalty costs."""
import numpy as np

import picture

fig, (left, middle, right) = picture.figure(1, 3, size=(11, 3.7))
boundary = picture.table("06-penalty/boundary.csv")
looks = {0.01: ("#b9c4cf", r"$\mu = 0.01\,|1|^2$"), 1: ("#2a7f62", "1"), 10: (picture.ACCENT, "10"),
         1e8: (picture.INK, r"$10^8$")}
for mu, (colour, label) in looks.items():
    x, y = (boundary[column][boundary["mu"] == mu] for column in "xy")
    inner = np.append(np.arange(32), 0)  # in the order of the file, which goes round the circle
    outer = 32 + np.argsort(np.arctan2(y[32:], x[32:]))
    outer = np.append(outer, outer[0])
    left.plot(x[inner], y[inner], color=colour, linewidth=1.2, label=label)
    left.plot(x[outer], y[outer], color=colour, linewidth=1.2)
left.set(aspect="equal", title="the two circles")
left.legend(loc="center left", bbox_to_anchor=(0.14, 0.5), fontsize=7.5)

data = picture.table("06-penalty/penalties.csv")
middle.loglog(data["mu"], data["c"], "o-", color=picture.INK)
middle.loglog(data["mu"][4:], 4 / data["mu"][4:], ":", color=picture.PAPER, label=r"slope $-1$")
middle.set(xlabel=r"$\mu / |1|^2$", title="$|c|$")
middle.legend()

for column, label, colour in [("condition", "condition number", picture.INK),
                              ("plain", "conjugate gradients", picture.ACCENT),
                              ("ilu0", "the same with ILU(0)", "#2a7f62"), ("newton", "Newton steps", picture.PAPER)]:
    right.loglog(data["mu"], data[column], "o-", color=colour, label=label, markersize=4)
right.set(xlabel=r"$\mu / |1|^2$", title="cost")
right.legend(fontsize=8)
picture.save(fig, "06-penalty")

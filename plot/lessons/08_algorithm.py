#!/usr/bin/env python3
"""Lesson 8: |c_D| of Algorithm 1 with and without its misprints, and the factor of one update."""
import numpy as np

import picture

fig, (left, right) = picture.figure(1, 2, size=(9.5, 3.9))
data = picture.table("08-algorithm/variants.csv")
looks = {"corrected": (picture.INK, "o-", 2), "weight": (picture.ACCENT, "s-", 1.4), "either": ("#2a7f62", "D--", 1.4),
         "looser": (picture.PAPER, "^-", 1.2), "printed": ("#7c3aed", "x--", 1.4)}
for name, (colour, style, width) in looks.items():
    of = data["variant"] == name
    left.semilogy(data["k"][of], data["c"][of], style, color=colour, linewidth=width, markersize=5, label=name)
left.axhline(1e-7, color=picture.PAPER, linewidth=0.7, linestyle=":")
left.set(xlabel="iteration of Algorithm 1", ylabel="$|c_D|$", title="one misprint at a time")
left.legend()

mu = np.logspace(-1, 6, 400)
for kappa, style in [(0.0, "-"), (100.0, "--"), (17000.0, ":")]:
    right.loglog(mu, np.abs(1 - mu / (kappa + mu**2)), style, color=picture.ACCENT,
                 label=rf"as printed, $\kappa$ = {kappa:g}")
for kappa, style in [(100.0, "--"), (17000.0, ":")]:
    right.loglog(mu, kappa / (kappa + mu), style, color=picture.INK, label=rf"corrected, $\kappa$ = {kappa:g}")
right.axhline(1, color=picture.PAPER, linewidth=0.7)
right.set(xlabel=r"$\mu$", title="factor of the error in one update", ylim=(1e-3, 20))
right.legend(fontsize=8, loc="lower left")
picture.save(fig, "08-algorithm")

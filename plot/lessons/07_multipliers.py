#!/usr/bin/env python3
"""Lesson 7: the forces of the wall, what eight updates leave of the constraint, and a penalty that is too small."""
import numpy as np

import picture


def circle(name):
    """Nodes of the moved circle in the order of their angle around its target's centre, closed; as columns."""
    data = picture.table(f"07-multipliers/boundary-{name}.csv")
    inner = np.arange(len(data["x"]))[np.hypot(data["x"], data["y"]) < 18]
    order = np.append(inner[:32], inner[0])  # in the order of the file, which goes round the circle
    return {column: values[order] for column, values in data.items()}


fig, axes = picture.figure(1, 3, size=(10, 3.7))
target = np.linspace(0, 2 * np.pi, 200)
soft = {"color": picture.PAPER, "linewidth": 0.8}
at = circle("24")
axes[0].plot(at["x"], at["y"], color=picture.INK, linewidth=1)
axes[0].quiver(at["x"], at["y"], at["fx"], at["fy"], color=picture.ACCENT, angles="xy", scale_units="xy", scale=4,
               width=0.006)
axes[0].set(title="forces of the wall")
size = np.hypot(at["cx"], at["cy"]).max()
axes[1].plot(8 + np.cos(target), np.sin(target), **soft)
axes[1].plot(at["x"] + 0.25 * at["cx"] / size, at["y"] + 0.25 * at["cy"] / size, "o-", color=picture.ACCENT,
             markersize=2.5, linewidth=1)
axes[1].set(title=f"what 8 updates leave, {0.25 / size / np.sqrt(40):.0f} times enlarged")
bad = circle("1")
axes[2].plot(8 + np.cos(target), np.sin(target), **soft)
axes[2].plot(bad["x"], bad["y"], "o-", color=picture.ACCENT, markersize=2.5, linewidth=1)
axes[2].set(title=r"$\mu = |1|^2$ is too small: after 6 updates")
for ax in axes:
    ax.set(aspect="equal", xlim=(6.2, 10.2), ylim=(-2, 2))
picture.save(fig, "07-multipliers")

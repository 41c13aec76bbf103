"""Figures 2, 6 and 10: constraint norm over the augmented Lagrangian iterations. Figure 3: times."""
from matplotlib.ticker import MaxNLocator

import runs
import style
from paper_values import CONVERGENCE, TABLE1
from style import plt

WHAT = {2: "moving a circle", 6: "curving a boundary layer", 10: "moving an aircraft"}
DOTS = {"mu": ("the penalty is updated here", style.INK), "lambda": ("the multipliers are updated here", "white")}


def constraint_norm(figure):
    """Dots: the projected norm, on which convergence is judged. Dashes: the norm, where the two differ."""
    row = next(row for row in CONVERGENCE if row.figure == figure)
    rows = runs.al_rows(row.deck)
    iteration = [int(al["al_iteration"]) for al in rows]
    projected = [float(al["projected_constraint_norm"]) for al in rows]
    norm = [float(al["constraint_norm"]) for al in rows]

    fig, ax = plt.subplots(figsize=(5.6, 4.2), layout="constrained")
    ax.set_title(f"Fig. {figure} of the paper: constraint norm, {WHAT[figure]}", fontsize=10.5)
    ax.semilogy(iteration, projected, color=style.INK, linewidth=0.9, zorder=2)
    if norm[-1] > 2 * projected[-1]:
        ax.semilogy(iteration, norm, "--", color=style.ACCENT, linewidth=0.9, zorder=1,
                    label="norm without projection: ends at the best\napproximation error of the exact target")
    for update, (label, face) in DOTS.items():
        chosen = [k for k, al in enumerate(rows) if al["update"] == update]
        ax.plot([iteration[k] for k in chosen], [projected[k] for k in chosen], "o", markersize=7, markeredgewidth=1.1,
                markeredgecolor=style.INK, markerfacecolor=face, linestyle="none", zorder=3, label=label)
    ends = [k for k, al in enumerate(rows) if al["update"] not in DOTS]
    ax.plot([iteration[k] for k in ends], [projected[k] for k in ends], "s", markersize=5, color=style.PAPER, zorder=3,
            linestyle="none", label="initial mesh; converged")
    ax.plot(*zip(*row.stated), "D", markersize=5, color=style.PAPER, markerfacecolor="none", zorder=1, linestyle="none",
            label="paper, orders of magnitude in the text")
    ax.set_xlabel("augmented Lagrangian iteration")
    ax.set_ylabel(r"constraint norm $\Vert c_D\Vert_{\partial M}$")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.grid(True, which="major", linewidth=0.3, alpha=0.5)
    ax.margins(x=0.06, y=0.07)
    ax.legend(fontsize=8, loc="upper right")
    style.save(fig, f"fig{figure:02d}")


def fig02():
    constraint_norm(2)


def fig06():
    constraint_norm(6)


def fig10():
    constraint_norm(10)


def fig03():
    elements = [row.elements for row in TABLE1]
    ours = [float(runs.summary(row.deck)["time_total"]) for row in TABLE1]
    threads = ", ".join(sorted({runs.summary(row.deck)["threads"] for row in TABLE1}))

    fig, ax = plt.subplots(figsize=(5.6, 4.2), layout="constrained")
    ax.set_title("Fig. 3 of the paper: times of the refined circle", fontsize=10.5)
    ax.loglog(elements, [row.time for row in TABLE1], "s--", color=style.PAPER, markersize=6, linewidth=0.9,
              label="paper, Table 1 (sparse direct solver)")
    ax.loglog(elements, ours, "o-", color=style.INK, markersize=6, linewidth=0.9,
              label=f"almesh, {threads} thread{'' if threads == '1' else 's'}")
    ideal = [ours[0] * count / elements[0] for count in elements]
    ax.loglog(elements, ideal, ":", color=style.ACCENT, linewidth=1, label="proportional to the number of elements")
    ax.set_xticks(elements, [f"{count}" for count in elements])
    ax.minorticks_off()
    ax.set_xlabel("elements")
    ax.set_ylabel("time (s)")
    ax.grid(True, which="major", linewidth=0.3, alpha=0.5)
    ax.legend(fontsize=8)
    style.save(fig, "fig03")

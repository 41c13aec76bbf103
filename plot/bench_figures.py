"""What `make bench` measured: growth of time and memory with the mesh, and where the decks spend their time."""
import numpy as np
from matplotlib.ticker import NullFormatter

import runs
import style
from paper_values import TABLE1
from style import plt


def exponent(x, y):
    """Slope of the straight line through the points on logarithmic axes."""
    return np.polyfit(np.log(x), np.log(y), 1)[0]


def scaling():
    rows = runs.bench("scaling")
    levels = [row for row in rows if row["name"].startswith("circle level")]
    unknowns, seconds, memory = (np.array([level[key] for level in levels]) for key in ("unknowns", "time", "peak memory"))
    paper_unknowns, paper_seconds = np.array([(2 * row.nodes, row.time) for row in TABLE1]).T
    threads = int(levels[0]["threads"])

    fig, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.4), layout="constrained")
    fig.suptitle("The circle refined, the aircraft refined and of higher degree: time and memory of a whole run",
                 fontsize=10.5)
    left.loglog(paper_unknowns, paper_seconds, "s--", color=style.PAPER, markersize=6, linewidth=0.9,
                label=f"paper, Table 1: exponent {exponent(paper_unknowns, paper_seconds):.2f}")
    left.loglog(unknowns, seconds, "o-", color=style.INK, markersize=6, linewidth=0.9,
                label=f"circle, {threads} thread{'' if threads == 1 else 's'}: exponent {exponent(unknowns, seconds):.2f}")
    left.loglog(unknowns, seconds[0] * unknowns / unknowns[0], ":", color=style.ACCENT, linewidth=1,
                label="proportional to the unknowns")
    left.set_ylabel("time (s)")
    right.loglog(unknowns, memory, "o-", color=style.INK, markersize=6, linewidth=0.9,
                 label=f"circle: exponent {exponent(unknowns, memory):.2f}")
    right.loglog(unknowns, memory[-1] * unknowns / unknowns[-1], ":", color=style.ACCENT, linewidth=1,
                 label="proportional to the unknowns")
    right.set_ylabel("peak memory (MB)")
    for family, marker in (("aircraft refined", "^-"), ("aircraft degree", "D-")):
        of_family = [row for row in rows if row["name"].startswith(family)]
        n, time, size = (np.array([row[key] for row in of_family]) for key in ("unknowns", "time", "peak memory"))
        for ax, y in ((left, time), (right, size)):
            ax.loglog(n, y, marker, markersize=5, linewidth=0.9,
                      label=f"{family}: exponent {exponent(n, y):.2f}" if len(n) > 1 else family)
    for ax in (left, right):
        ax.set_xlabel("unknowns")
        ax.grid(True, which="major", linewidth=0.3, alpha=0.5)
        ax.xaxis.set_minor_formatter(NullFormatter())
        ax.legend(fontsize=8, loc="upper left")
    style.save(fig, "scaling")


def splits():
    rows = runs.bench("split")
    threads = max(row["threads"] for row in rows)
    rows = [row for row in rows if row["threads"] == threads][::-1]
    stages = [key for key in rows[0] if key not in ("name", "threads", "whole run")]
    colours = [*plt.get_cmap("viridis")(np.linspace(0.15, 0.95, len(stages) - 1)), style.PAPER]  # grey: the rest

    fig, ax = plt.subplots(figsize=(8.6, 0.5 + 0.32 * len(rows)), layout="constrained")
    ax.set_title(f"Where a run spends its time, {threads:.0f} thread{'' if threads == 1 else 's'}", fontsize=10.5)
    left = np.zeros(len(rows))
    for stage, colour in zip(stages, colours):
        share = np.array([row.get(stage, 0.0) for row in rows])
        ax.barh(range(len(rows)), share, left=left, color=colour, height=0.7, label=stage.replace("_", " "))
        left += share
    ax.set_yticks(range(len(rows)), [f"{row['name']}, {row['whole run']:.3g} s" for row in rows])
    ax.set_xlim(0, 100)
    ax.set_xlabel("% of the whole run")
    ax.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1, 1))
    style.save(fig, "splits")

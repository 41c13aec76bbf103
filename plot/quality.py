#!/usr/bin/env python3
"""The quality of elements before and after `almesh improve`: draws quality.csv of a folder of results.

    plot/quality.py outputs/tangled     writes quality.png into it

Numbers of elements on a logarithmic scale, so that a single bad element is seen."""
import csv
import sys
from pathlib import Path

import style
from style import plt

MEASURES = (("scaled_jacobian", "least scaled Jacobian of a corner"), ("quality", "shape quality 1/eta"))
TIMES = (("before", style.PAPER), ("after", style.ACCENT))


def draw(rows, fig):
    """The first row counts the elements that are not valid: a bar beside the others, whose width is that of theirs."""
    low = [float(row["low"]) for row in rows]
    high = [float(row["high"]) for row in rows]
    low[0] = high[0] - (high[1] - low[1])
    edges = low + high[-1:]
    for ax, (column, label) in zip(fig.subplots(1, 2, sharey=True), MEASURES):
        for time, colour in TIMES:
            counts = [int(row[f"{column}_{time}"]) for row in rows]
            ax.stairs([max(count, 0.5) for count in counts], edges, baseline=0.5, color=colour, linewidth=1.4,
                      fill=time == "before", alpha=0.6 if time == "before" else 1,
                      label=f"{time}, {counts[0]} of them not positive")
        ax.axvline(0, color=style.INK, linewidth=0.6, linestyle=":")
        ax.set_yscale("log")
        ax.margins(y=0.1)
        ax.set_ylim(bottom=0.5)
        ax.set_xlabel(label)
        ax.legend(fontsize=8, loc="upper left")
    fig.axes[0].set_ylabel("elements")


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    folder = Path(sys.argv[1])
    try:
        with open(folder / "quality.csv", newline="") as file:
            rows = list(csv.DictReader(file))
    except FileNotFoundError:
        raise SystemExit(f"{folder}/quality.csv is missing: `almesh improve FILE` writes it")
    style.apply()
    fig = plt.figure(figsize=(8.2, 3.4), layout="constrained")
    draw(rows, fig)
    fig.savefig(folder / "quality.png", facecolor="white")
    print(folder / "quality.png")


if __name__ == "__main__":
    main()

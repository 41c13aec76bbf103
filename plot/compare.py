#!/usr/bin/env python3
"""The methods that the paper argues against, beside its own, on the same meshes and motions: runs every case below with
every method and writes to outputs/compare/

  compare.csv     a row per run
  tables.md       the condensed table, then one table per case
  survival.png    worst distortion against distance and angle; a curve ends at a cross where no valid mesh came out

  plot/compare.py           the same as `make compare`; some seven minutes
  plot/compare.py --tables  tables and figure of an earlier compare.csv

A run is stopped after LIMIT seconds, and its row says so. Needs matplotlib.
"""
import csv
import re
import subprocess
import sys

import runs

FOLDER = runs.OUTPUTS / "compare"
LIMIT = 60  # seconds of one run
OWN = ["algorithm=adaptive", "objective=deviation", "length_scale=auto", "omega_star=1e-8", "epsilon_star=1e-16"]
PAPER = "Algorithm 1, paper's decks"
ALMESH, OTHER = ["./almesh"], "build/examples/comparators"
# Title, program, settings, colour of the curve.
METHODS = [
    ("augmented Lagrangian", ALMESH, OWN, "#c2410c"),
    (PAPER, ALMESH, ["algorithm=paper"], "#f29b4b"),
    ("penalty", ALMESH, [*OWN, "method=penalty"], "#8c1127"),
    ("fixed boundary", [OTHER, "set", "1"], OWN, "#8a94a0"),
    ("incremental, 10", [OTHER, "set", "10"], OWN, "#2f6f4f"),
    ("incremental, 100", [OTHER, "set", "100"], OWN, "#7fb796"),
    ("untangle", [OTHER, "untangle", "1"], OWN, "#7a3f9d"),
    ("elasticity, 1", [OTHER, "elasticity", "1"], OWN, "#16588e"),
    ("elasticity, 10", [OTHER, "elasticity", "10"], OWN, "#4f93c8"),
    ("elasticity, 100", [OTHER, "elasticity", "100"], OWN, "#a9cbe6"),
    ("harmonic, 1", [OTHER, "harmonic", "1"], OWN, "#5b4a1f"),
    ("harmonic, 10", [OTHER, "harmonic", "10"], OWN, "#a08a45"),
    ("harmonic, 100", [OTHER, "harmonic", "100"], OWN, "#d3c48e"),
]
# Title, deck, setting with {} for the size of the motion, sizes, unit.
CASES = [
    ("circle translated", "circle", "boundary inner=translate {} 0", [2, 4, 8, 12, 16, 18, 19, 19.5], ""),
    ("circle rotated", "circle", "boundary inner=rotate {} about 0 0", range(30, 181, 30), "°"),
    ("plate rotated in a box", "gauntlet/plate-turned", "boundary plate=rotate {} about 0 0", range(15, 181, 15), "°"),
    ("boundary layer curved", "curving", "", [0], ""),
    ("aircraft translated", "aircraft", "boundary aircraft=translate {} 0 0", [4], ""),
    ("aircraft pitched", "aircraft", "boundary aircraft=rotate {} axis 0 1 0 about 0 0 0", [90], "°"),
]
COLUMNS = ["case", "motion", "method", "status", "valid", "invalid_elements", "reached", "max_distortion",
           "relative_quality", "size_skew_mean", "size_skew_min", "max_boundary_error", "steps", "time_run",
           "nodes_off_target"]
HEADS = ["worst η", "q", "size-skew mean", "size-skew min", "boundary error", "steps", "seconds"]


def reached(out):
    """Part of the motion that the mesh has come to, as the program for other methods tells it."""
    told = re.search(r"([\d.e+-]+) of the motion", out)
    return float(told[1]) if told else 0


def run(case, deck, setting, size, method, program, settings):
    """A row of compare.csv."""
    name = f"compare/{case}-{size}-{method}".replace(" ", "-").replace(",", "").replace("'", "")
    command = [*program, f"inputs/{deck}.deck", *settings, f"output=outputs/{name}", "vtk=none"]
    if setting:
        command.append(setting.format(size))
    row = {"case": case, "motion": size, "method": method, "valid": "no"}
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return {**row, "status": f"not in {LIMIT} s"}
    if done.returncode not in (0, 3, 4, 5):
        sys.exit(f"{' '.join(command)} ended with exit code {done.returncode}")
    summary = runs.summary(name)
    row.update({column: summary[column] for column in COLUMNS if column in summary})
    row["steps"] = sum(int(summary[f"{part}newton_iterations"]) for part in ("", "earlier_", "coarse_"))
    row["reached"] = 1 if summary["status"] == "converged" else reached(done.stdout)
    if summary["status"] == "converged" and summary["certified_injective"] == "yes":
        row["valid"] = "yes"
    return row


def run_all():
    FOLDER.mkdir(parents=True, exist_ok=True)
    with (FOLDER / "compare.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for case, deck, setting, sizes, _ in CASES:
            for size in sizes:
                for method, program, settings, _ in METHODS:
                    row = run(case, deck, setting, size, method, program, settings)
                    writer.writerow(row)
                    file.flush()
                    print(f"{case} {size}, {method}: {row['status']}, {outcome(row)}", flush=True)


def shown(text, digits=4):
    return f"{float(text):.{digits}g}"


def outcome(row):
    """Of a run in words: valid, how many elements are not, or where it stopped."""
    if row["valid"] == "yes":
        return "valid"
    if not row.get("invalid_elements"):  # not in the time that it had
        return row["status"]
    invalid, way = int(row["invalid_elements"]), float(row["reached"])
    after = ""
    if int(row["nodes_off_target"]) > 0:
        after = f" after {100 * way:.3g} %" if way else " in the first part"
    return (f"{invalid} inverted" if invalid else row["status"]) + after


def cell(row):
    """Worst η, or what went wrong."""
    return shown(row["max_distortion"]) if row["valid"] == "yes" else outcome(row)


def full_table(rows):
    lines = ["| method | outcome | " + " | ".join(HEADS) + " |", "|---" * (2 + len(HEADS)) + "|"]
    for row in rows:
        cells = [row["method"], outcome(row)]
        cells += [shown(row[column]) if row[column] else "-" for column in COLUMNS[7:-1]]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def survives(rows, unit):
    """The largest motion up to which all are valid."""
    largest = None
    for row in rows:
        if row["valid"] != "yes":
            break
        largest = row["motion"]
    return "none" if largest is None else f"{largest}{unit}"


def costs(row):
    return f"{cell(row)}; {row['steps']}; {shown(row['time_run'], 2)} s" if row["valid"] == "yes" else outcome(row)


def condensed(table):
    """One row per method. table: {(case, method): rows}."""
    heads = ["method", "circle moved up to; η (steps) at 8, 18", "rotated up to; at 90°, 180°",
             "plate up to; at 90°, 180°", "boundary layer: η; steps; time", "aircraft moved", "pitched by 90°"]
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]

    def far(case, method, unit, sizes):
        rows = table[case, method]
        at = {row["motion"]: f"{cell(row)} ({row['steps']})" if row["valid"] == "yes" else "✗" for row in rows}
        return f"{survives(rows, unit)}; {', '.join(at[size] for size in sizes)}"
    for method, *_ in METHODS:
        cells = [method, far("circle translated", method, "", ["8", "18"]),
                 far("circle rotated", method, "°", ["90", "180"]),
                 far("plate rotated in a box", method, "°", ["90", "180"])]
        cells += [costs(table[case, method][0]) for case in
                  ("boundary layer curved", "aircraft translated", "aircraft pitched")]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def draw(table):
    import style
    from matplotlib import pyplot as plt
    style.apply()
    fig, axes = plt.subplots(1, 3, figsize=(10, 3.6), sharey=True)
    for ax, (case, _, _, _, unit) in zip(axes, CASES):
        for method, *_, colour in METHODS:
            rows = table[case, method]
            good = []
            for row in rows:
                if row["valid"] != "yes":
                    break
                good.append((float(row["motion"]), float(row["max_distortion"])))
            points = [(0, 1), *good]
            first = method == METHODS[0][0]  # broad, since others come to the same minimum
            ax.plot(*zip(*points), color=colour, linewidth=5 if first else 1.3, alpha=0.4 if first else 1, marker=".",
                    markersize=3, label=method)
            if len(good) < len(rows):
                ax.plot(*points[-1], "x", color=colour, markersize=6)
        ax.set_yscale("log")
        ax.set_ylim(0.95, 1e3)
        ax.set_title(case)
        ax.set_xlabel("distance, the radius being 1" if not unit else "angle in degrees")
    axes[0].set_ylabel("worst η")
    fig.legend(*axes[0].get_legend_handles_labels(), loc="center right", fontsize=7.5)
    fig.tight_layout(rect=(0, 0, 0.82, 1))
    fig.savefig(FOLDER / "survival.png", dpi=100, facecolor="white")


def main():
    if "--tables" not in sys.argv[1:]:
        run_all()
    table = {}
    with (FOLDER / "compare.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            table.setdefault((row["case"], row["method"]), []).append(row)
    lines = condensed(table)
    for case, _, _, sizes, unit in CASES:
        for k, size in enumerate(sizes):
            lines += ["", f"**{case}" + (f" by {size}{unit}" if size else "") + "**", ""]
            lines += full_table([table[case, method][k] for method, *_ in METHODS])
    (FOLDER / "tables.md").write_text("\n".join(lines) + "\n")
    print("\n".join(condensed(table)))
    draw(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())

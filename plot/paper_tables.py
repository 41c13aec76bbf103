#!/usr/bin/env python3
"""The paper's tables beside ours: reads outputs/<deck>/ of the paper's decks, writes outputs/paper/tables.md.

  plot/paper_tables.py            the same as the last step of `make paper`
  plot/paper_tables.py --decks    only the names of these decks, for the Makefile

Ends with exit code 1, and one line per failure on stderr, where a deck has not been run or did not converge, one of its
`expect` lines does not hold, or a value is off the paper's by more than the tolerances below. Standard library only.
"""
import sys
from collections import namedtuple

import runs
from paper_values import (AIRCRAFT_SIZE, CIRCLE_MAX_DISTORTION, CONVERGENCE, CURVING_SIZE, CURVING_TIME_IN_TEXT,
                          MISPRINTED_NODES, NODES_MEANT, TABLE1, TABLE2)

QUALITY_TOLERANCE = 0.001  # one unit of the last digit that the paper prints
AL_TOLERANCE = 2           # AL iterations, where the paper's tolerances and mu0 are not known

DECKS = ["circle", "circle-refined-1", "circle-refined-2", "circle-refined-3", "circle-refined-4", "circle-printed",
         "curving", "curving-printed", "aircraft", "aircraft-weighted", "aircraft-squared"]


Check = namedtuple("Check", "deck quantity expected got holds")


# ---------------------------------------------------------------------------------------------------------- comparisons

def check_deck(checks, deck):
    """The verdicts of the program on the deck's `expect` lines; without one on its status it must have converged."""
    rows = runs.expectations(deck)
    if not any(row["quantity"] == "status" for row in rows):
        status = runs.summary(deck)["status"]
        checks.append(Check(deck, "status", "= converged", status, status == "converged"))
    for row in rows:
        checks.append(Check(deck, row["quantity"], row["expected"], row["got"], row["holds"] == "yes"))


def check_quality(checks, deck, paper, what):
    got = runs.summary(deck)["relative_quality"]
    near = abs(float(got) - paper) <= QUALITY_TOLERANCE
    checks.append(Check(deck, f"relative_quality ({what})", f"= {paper} +- {QUALITY_TOLERANCE}", got, near))


def check_al_iterations(checks, deck, paper, what, at_most=False):
    got = int(runs.summary(deck)["al_iterations"])
    expected = f"<= {paper}" if at_most else f"= {paper} +- {AL_TOLERANCE}"
    near = got <= paper if at_most else abs(got - paper) <= AL_TOLERANCE
    checks.append(Check(deck, f"al_iterations ({what})", expected, str(got), near))


def check_program(checks):
    """All runs must be of one build: tables that mix several are of none."""
    programs = {}
    for deck in DECKS:
        programs.setdefault(runs.deck_lines(deck)[0].lstrip("# "), []).append(deck)
    got = "; ".join(f"{program} ({', '.join(decks)})" for program, decks in programs.items())
    checks.append(Check("all decks", "program", "the same: run `make paper`", got, len(programs) == 1))


def check_table1(checks):
    for row in TABLE1:
        summary = runs.summary(row.deck)
        nodes = NODES_MEANT if row.nodes == MISPRINTED_NODES else row.nodes
        for quantity, value in (("elements", row.elements), ("nodes", nodes)):
            got = summary[quantity]
            checks.append(Check(row.deck, f"{quantity} (Table 1)", f"= {value}", got, got == str(value)))
        check_quality(checks, row.deck, row.quality, "Table 1")
        check_al_iterations(checks, row.deck, row.al_iterations, "Table 1")


def check_table2(checks):
    for row in TABLE2:
        check_quality(checks, row.deck, row.quality[-1], "Table 2, last column")
    for row in CONVERGENCE[1:]:
        # The aircraft's nine is an upper bound: with another mesh and mu0 fewer iterations are no drift.
        check_al_iterations(checks, row.deck, row.al_iterations, f"Fig. {row.figure}", at_most=row.figure == 10)


def all_checks():
    checks = []
    for deck in DECKS:
        check_deck(checks, deck)
    check_program(checks)
    check_table1(checks)
    check_table2(checks)
    return checks


# --------------------------------------------------------------------------------------------------------------- tables

def padded_quality(deck, columns):
    """Relative quality per AL iteration, the last one repeated up to `columns`, as the paper's Table 2 does."""
    quality = [float(row["relative_quality"]) for row in runs.al_rows(deck)]
    return (quality + [quality[-1]] * columns)[:columns]


def markdown(header, rows):
    lines = ["| " + " | ".join(str(cell) for cell in row) + " |" for row in [header, *rows]]
    lines.insert(1, "|" + "---|" * len(header))
    return "\n".join(lines) + "\n"


def three(text):
    """Three significant digits, for times and norms."""
    if not text:  # row 0 of the history: nothing was minimised yet
        return ""
    value = float(text)
    return f"{value:.1e}" if 0 < abs(value) < 1e-2 or abs(value) >= 1e5 else f"{value:.3g}"


def provenance():
    lines = [line.lstrip("# ") for line in runs.deck_lines("circle")[:3]]
    threads = sorted({runs.summary(deck)["threads"] for deck in DECKS})
    return f"{lines[0]}; {lines[1]}; threads: {', '.join(threads)}."


def table1():
    rows = []
    for row in TABLE1:
        ours = runs.summary(row.deck)
        nodes = f"{row.nodes} [^nodes]" if row.nodes == MISPRINTED_NODES else row.nodes
        rows.append((f"`{row.deck}`", row.elements, ours["elements"], nodes, ours["nodes"], row.time,
                     three(ours["time_total"]), row.quality, f"{float(ours['relative_quality']):.4f}",
                     row.al_iterations, ours["al_iterations"], ours["newton_iterations"]))
    header = ["deck", "elements, paper", "ours", "nodes, paper", "ours", "time (s), paper", "ours",
              "quality, paper", "ours", "AL iterations, paper", "ours", "Newton steps, ours"]
    note = (f"[^nodes]: Refining the row above once more (105088 triangles, 52704 nodes, 320 boundary edges) adds a "
            f"node per edge: 52704 + (3 · 105088 + 320)/2 = {NODES_MEANT}. The paper's {MISPRINTED_NODES} cannot be "
            "that mesh.\n")
    return markdown(header, rows) + "\n" + note


def table2():
    columns = len(TABLE2[0].quality)
    rows = []
    for row in TABLE2:
        time = f"{row.time} ({CURVING_TIME_IN_TEXT} in §4.2)" if row.deck == "curving" else row.time
        rows.append((row.example, "paper", *row.quality, time))
        ours = [f"{value:.4f}" for value in padded_quality(row.deck, columns)]
        rows.append(("", f"`{row.deck}`", *ours, three(runs.summary(row.deck)["time_total"])))
    return markdown(["example", "", "initial", *range(1, columns), "time (s)"], rows)


def figure3():
    rows = [(row.elements, row.time, three(runs.summary(row.deck)["time_total"])) for row in TABLE1]
    return markdown(["elements", "time (s), paper", "ours"], rows)


def convergence(row):
    updates = {"mu": "● penalty", "lambda": "○ multipliers", "-": ""}
    rows = [(al["al_iteration"], three(al["projected_constraint_norm"]), three(al["constraint_norm"]),
             three(al["mu"]), al["newton_iterations"], updates.get(al["update"], al["update"]), three(al["seconds"]))
            for al in runs.al_rows(row.deck)]
    header = ["AL iteration", "projected norm", "norm", "μ", "Newton steps", "then updated", "time (s)"]
    return f"The paper: {row.text}.\n\n" + markdown(header, rows)


def outcomes(decks):
    rows = []
    for deck in decks:
        ours = runs.summary(deck)
        rows.append((f"`{deck}`", ours["status"], ours["al_iterations"], ours["newton_iterations"],
                     three(ours["projected_constraint_norm"]), f"{float(ours['relative_quality']):.4f}",
                     f"{float(ours['max_distortion']):.4g}", ours["certified_valid"], three(ours["time_total"])))
    return markdown(["deck", "status", "AL iterations", "Newton steps", "projected norm", "quality", "max distortion",
                     "certified valid", "time (s)"], rows)


def checked(checks):
    rows = [(f"`{deck}`", quantity, expected, got, "yes" if good else "**no**")
            for deck, quantity, expected, got, good in checks]
    return markdown(["deck", "quantity", "expected", "got", "holds"], rows)


def convergence_sections():
    start = float(runs.al_rows("aircraft")[0]["constraint_norm"])
    notes = {6: "The circle is no polynomial of degree 4: the norm ends at the best approximation error of the target, "
                "and convergence is judged on the projected norm.",
             10: f"The norm of Eq. (6) runs over the whole boundary, far field included, and starts at {start:.3g}; "
                 "4, the displacement, is what it would be if the aircraft were the whole boundary."}
    for row in CONVERGENCE:
        yield f"## Figure {row.figure}: constraint norm, `{row.deck}`"
        yield convergence(row)
        if row.figure in notes:
            yield notes[row.figure]


def document(checks):
    curving, aircraft = runs.summary("curving"), runs.summary("aircraft")
    sections = [
        "# The paper's tables and the data of its figures",
        f"Written by plot/paper_tables.py. {provenance()} Times are wall-clock and of different machines: compare "
        "their growth.",
        "## Table 1: the circle, refined", table1(),
        "## Table 2: relative quality over the AL iterations",
        "Padded with the last value, as in the paper. The value after the first iteration depends on μ0, which the "
        "paper does not state: only the last column is checked.", table2(),
        "## Figure 3: times of the refined circle", figure3(),
        *convergence_sections(),
        "## Eq. (5) as printed, element weights, and the aircraft with ∫η²",
        "The paper's quality of the circle is that of ∫η², which `circle` and `curving` minimise; the decks "
        "`-printed`, `aircraft` and `aircraft-weighted` minimise ∫(η − 1)², Eq. (5). The paper's largest distortion of "
        f"the circle is {CIRCLE_MAX_DISTORTION}. `aircraft-squared` has no counterpart in the paper.",
        outcomes(["circle", "circle-printed", "curving", "curving-printed", "aircraft", "aircraft-weighted",
                  "aircraft-squared"]),
        f"Sizes: the boundary layer has the paper's {CURVING_SIZE[0]} vertices and {CURVING_SIZE[1]} triangles "
        f"({curving['nodes']} nodes in degree 4); the aircraft has {aircraft['nodes']} nodes and "
        f"{aircraft['elements']} tetrahedra, the paper's {AIRCRAFT_SIZE[0]} and {AIRCRAFT_SIZE[1]}.",
        "## What was checked",
        "The `expect` lines of the decks, and the paper's values: quality to "
        f"{QUALITY_TOLERANCE}, AL iterations to {AL_TOLERANCE} (the aircraft: at most the paper's).",
        checked(checks)]
    return "\n\n".join(section.rstrip("\n") for section in sections) + "\n"


def missing_runs():
    """One message per deck that lacks a file."""
    messages = []
    for deck in DECKS:
        try:
            for file in ("summary.txt", "expectations.csv", "history.csv", "deck.txt"):
                runs.path_of(deck, file)
        except runs.MissingRun as error:
            messages.append(str(error))
    return messages


def main(arguments):
    if arguments == ["--decks"]:
        print(*DECKS)
        return 0
    if missing := missing_runs():
        print("\n".join(missing), file=sys.stderr)
        return 1
    checks = all_checks()
    path = runs.OUTPUTS / "paper" / "tables.md"
    path.parent.mkdir(exist_ok=True)
    path.write_text(document(checks))
    failures = [check for check in checks if not check.holds]
    for check in failures:
        print(f"{check.deck}: {check.quantity}: expected {check.expected}, got {check.got}", file=sys.stderr)
    print(f"outputs/paper/tables.md: {len(checks) - len(failures)} of {len(checks)} checks hold")
    return 1 if failures else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except runs.MissingName as error:
        sys.exit(str(error))

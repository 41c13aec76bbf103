#!/usr/bin/env python3
"""Prints the tables of numbers that the README shows; `make readmes` compares them.

  plot/readme_tables.py results    beside the paper's values: reads outputs/ of `make paper`
  plot/readme_tables.py shares     of the time of three of these runs
  plot/readme_tables.py large      the aircraft refined and curved, a bar of hexahedra: runs them, two minutes

Standard library only.
"""
import subprocess
import sys

import runs
from paper_values import CONVERGENCE, TABLE1, TABLE2

LARGE = [("aircraft", keys) for keys in ([], ["refine=1"], ["refine=2"], ["degree=2"], ["degree=3"], ["degree=4"])]
LARGE += [("cells/twist-90", ["refine=3"]), ("cells/twist-90", ["degree=3", "refine=1"])]


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def header(*names):
    row(*names)
    print("|" + "---|" * len(names))


def results():
    header("deck", "elements", "q, paper", "q", "AL, paper", "AL", "Newton steps", "max η", "time, paper", "time")
    papers = [("circle", TABLE1[0]), ("circle-refined-2", TABLE1[2]), ("circle-refined-4", TABLE1[4]),
              ("curving", TABLE2[1]), ("aircraft", TABLE2[2])]
    iterations = {example.deck: example.al_iterations for example in CONVERGENCE}
    for deck, paper in papers:
        ours = runs.summary(deck)
        quality = paper.quality[-1] if isinstance(paper.quality, list) else paper.quality
        row(f"`{deck}`", ours["elements"], quality, f"{float(ours['relative_quality']):.4f}",
            iterations.get(deck) or paper.al_iterations, ours["al_iterations"], ours["newton_iterations"],
            f"{float(ours['max_distortion']):.4g}", f"{paper.time} s", f"{float(ours['time_run']):.2g} s")


def shares():
    header("deck", "unknowns", "Newton steps", "linear iterations", "share of linear solves", "share of assembly",
           "share of setup, checks, writing")
    for deck in ("circle-refined-4", "curving", "aircraft"):
        ours = runs.summary(deck)
        parts = [["time_linear"], ["time_assembly"], ["time_setup", "time_certify", "time_write"]]
        percent = [100 * sum(float(ours[name]) for name in names) / float(ours["time_run"]) for names in parts]
        row(f"`{deck}`", int(ours["nodes"]) * int(ours["dimension"]), ours["newton_iterations"],
            ours["linear_iterations"], *(f"{value:.0f} %" for value in percent))


def large():
    header("deck and keys", "elements", "unknowns", "Newton steps", "on coarser meshes", "max η", "time", "memory")
    for number, (deck, keys) in enumerate(LARGE):
        name = f"readme/large-{number}"
        command = ["./almesh", f"inputs/{deck}.deck", "algorithm=adaptive", "vtk=none", f"output=outputs/{name}", *keys]
        code = subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode
        if code not in (0, 5):  # the deck's expectations are those of its own mesh
            sys.exit(f"{' '.join(command)} ended with exit code {code}")
        ours = runs.summary(name)
        row(f"`{' '.join([deck, *keys])}`", ours["elements"], int(ours["nodes"]) * int(ours["dimension"]),
            ours["newton_iterations"], ours["coarse_newton_iterations"], f"{float(ours['max_distortion']):.3g}",
            f"{float(ours['time_total']):.2g} s", f"{float(ours['peak_memory_mb']) / 1000:.2g} GB")


def main(arguments):
    tables = {"results": results, "shares": shares, "large": large}
    if len(arguments) != 1 or arguments[0] not in tables:
        sys.exit(__doc__)
    tables[arguments[0]]()
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (runs.MissingRun, runs.MissingName) as error:
        sys.exit(str(error))

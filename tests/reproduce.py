#!/usr/bin/env python3
"""Runs the decks in inputs/ and compares what comes out with the committed tests/reference/summaries.csv.

  tests/reproduce.py [--program build-x/almesh] [DECK ...]   compare; all decks where none is named (cad/torus)
  tests/reproduce.py --quick                                 those of a second or two
  tests/reproduce.py --threads 1,2,3                         each of them with these numbers of threads
  tests/reproduce.py --update [DECK ...]                     write their rows of the reference: see the difference then
  --under "qemu-aarch64-static"                              the command that the program is run by

Status, exit code and every count (of steps, iterations, nodes off target) must be equal. `same bits`: the nodes of
final.msh are, to the last bit, and so is history.csv but for its times. Where they are not, the table shows by how much
numbers differ, and LIMITS how much is taken. With several numbers of threads all must give the same bits.

Exit code 1 where a deck differs. Standard library only.
"""
import argparse
import csv
import hashlib
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
REFERENCE = ROOT / "tests" / "reference" / "summaries.csv"
QUICK = ["channel-bump", "circle", "circle-literal", "circle-printed", "circle-refined-1", "circle-refined-2",
         "circle-size-shape", "curving", "curving-printed", "sphere-shell", "cad/torus", "cells/airfoil",
         "cells/circle", "cells/circle-far", "cells/circle-turned", "cells/curving", "gauntlet/airfoil-layers",
         "gauntlet/airfoil-pitched", "gauntlet/airfoil-turned", "gauntlet/block-turned", "gauntlet/circle-moved-worst",
         "gauntlet/circle-quarter-worst", "gauntlet/circle-refined-turned", "gauntlet/circle-turned",
         "gauntlet/circle-turned-worst", "gauntlet/layers-degree-4", "gauntlet/plate-turned", "slide/bump",
         "slide/half-aircraft", "slide/onto-box", "slide/onto-bump", "slide/piston", "slide/rotor", "targets/flap",
         "targets/wave", "targets/from-wave"]
COUNTS = ["exit_code", "status", "al_iterations", "newton_iterations", "earlier_newton_iterations",
          "coarse_newton_iterations", "linear_iterations", "local_steps", "nodes_off_target", "freed_nodes",
          "refined_elements", "invalid_elements", "certified_valid", "certified_injective"]
# Of the last subproblem in history.csv, with all their digits. The boundary error is one of the nodes' heights: its
# difference is shown as it is, those of the others relative to the reference.
LIMITS = {"energy": 1e-6, "relative_quality": 1e-6, "max_distortion": 1e-6, "relative_boundary_error": 1e-6}
# The walls of the one are the final mesh of the other.
FOLLOWS = {"targets/from-wave": ("targets/wave", "boundary all=mesh {}/final.msh")}
SECONDS = 3600  # of one run, at most


def all_decks():
    decks = [path.relative_to(ROOT / "inputs").with_suffix("").as_posix() for path in (ROOT / "inputs").rglob("*.deck")]
    return sorted(deck for deck in decks if not deck.startswith(("lessons/", "frames/")))


def in_order(decks):
    """The decks, and those they follow, with these before them."""
    decks = {*decks, *(FOLLOWS[deck][0] for deck in decks if deck in FOLLOWS)}
    return sorted(decks, key=lambda deck: (deck in FOLLOWS, deck))


def nodes_of(mesh):
    """Of a file in MSH 2.2, by their ids."""
    rows = mesh.read_text().split("$Nodes\n")[1].split("$EndNodes")[0].splitlines()[1:]
    return sorted([int(number), *map(float, x)] for number, *x in map(str.split, rows))


class Run:
    """One run of a deck: its counts and numbers as texts, and a hash of what does not depend on the time."""

    def __init__(self, command, deck, outputs, threads):
        self.folder = Path(outputs) / deck.replace("/", "-")
        settings = [f"output={self.folder}", "vtk=none", "final=msh"] + ([f"threads={threads}"] if threads else [])
        if deck in FOLLOWS:
            leader, setting = FOLLOWS[deck]
            settings.append(setting.format(Path(outputs) / leader.replace("/", "-")))
        begin = time.monotonic()
        done = subprocess.run([*command, f"inputs/{deck}.deck", *settings], cwd=ROOT, timeout=SECONDS,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.seconds = time.monotonic() - begin
        summary = self.folder / "summary.txt"
        if not summary.exists():
            raise RuntimeError(f"exit code {done.returncode} and no results: {done.stderr.strip()[-300:]}")
        self.values = dict(line.split(" = ", 1) for line in summary.read_text().splitlines())
        self.values["exit_code"] = str(done.returncode)
        with (self.folder / "history.csv").open(newline="") as lines:
            history = list(csv.DictReader(lines))
        self.values |= {name: [row for row in history if row["kind"] in ("al", "local")][-1][name] for name in LIMITS}
        steps = [[text for name, text in row.items() if name not in ("run", "seconds")] for row in history]
        nodes = nodes_of(self.folder / "final.msh")
        self.values["bits"] = hashlib.sha256(repr(steps + nodes).encode()).hexdigest()[:16]


def difference(name, got, expected):
    if got == expected:
        return 0.0
    got, expected = float(got or "nan"), float(expected or "nan")
    return abs(got - expected) / (1 if name == "relative_boundary_error" else abs(expected))


def faults_of(runs, reference, differences):
    """What is not as it must be, as texts."""
    if not reference:
        return ["no row in " + REFERENCE.name]
    got = runs[0].values
    faults = [f"{name} {got[name]} instead of {reference[name]}" for name in COUNTS if got[name] != reference[name]]
    faults += [f"{name} {got[name]} instead of {reference[name]}" for name, limit in LIMITS.items()
               if not differences[name] <= limit]
    return faults + ["other bits with other numbers of threads"] * (len({run.values["bits"] for run in runs}) > 1)


def read_reference():
    if not REFERENCE.exists():
        return {}
    with REFERENCE.open(newline="") as lines:
        return {row["deck"]: row for row in csv.DictReader(lines)}


def write_reference(rows):
    REFERENCE.parent.mkdir(exist_ok=True)
    with REFERENCE.open("w", newline="") as file:
        table = csv.DictWriter(file, ["deck", *COUNTS, *LIMITS, "bits"], extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(rows[deck] for deck in sorted(rows) if deck in all_decks())


def reproduce(command, decks, threads=(0,), show=print):
    """Runs the decks; returns ({deck: values}, {deck: faults}). A line of the table for each goes to show()."""
    reference, values, faults, largest = read_reference(), {}, {}, dict.fromkeys(LIMITS, (0.0, ""))
    show(f"{'deck':<34}{'':<10}{'AL':>4}{'Newton':>8}{'linear':>8}{'local':>7}{'energy':>10}{'quality':>10}"
         f"{'max eta':>10}{'boundary':>10}{'time':>9}")
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as outputs:
        for deck in in_order(decks):
            try:
                runs = [Run(command, deck, outputs, number) for number in threads]
            except (RuntimeError, subprocess.TimeoutExpired) as failure:
                faults[deck] = [str(failure)]
                show(f"{deck:<34}{'FAILED':<10}{failure}")
                continue
            got, expected = runs[0].values, reference.get(deck)
            values[deck] = {"deck": deck, **got}
            differences = {name: difference(name, got[name], expected[name]) if expected else 0.0 for name in LIMITS}
            faults[deck] = faults_of(runs, expected, differences)
            largest = {name: max(largest[name], (differences[name], deck)) for name in LIMITS}
            verdict = "DIFFERS" if faults[deck] else "same bits" if got["bits"] == expected["bits"] else "same"
            newton = sum(int(got[name]) for name in COUNTS if name.endswith("newton_iterations"))
            show(f"{deck:<34}{verdict:<10}{got['al_iterations']:>4}{newton:>8}"
                 f"{got['linear_iterations']:>8}{got['local_steps']:>7}"
                 + "".join(f"{value:>10.1e}" if value else f"{'0':>10}" for value in differences.values())
                 + f"{sum(run.seconds for run in runs):>7.1f} s")
            for fault in faults[deck]:
                show(f"    {fault}")
    differing = sum(map(bool, faults.values()))
    to_the_bit = sum(reference.get(deck, {}).get("bits") == got["bits"] for deck, got in values.items())
    show(f"\n{len(faults)} decks in {time.monotonic() - begin:.0f} s: {len(faults) - differing} as the reference, "
         f"{to_the_bit} of them to the last bit, {differing} not; largest differences of numbers:")
    for name, (value, deck) in largest.items():
        show(f"  {name:<24} {value:.1e} {deck}")
    return values, faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="./almesh")
    parser.add_argument("--under", default="")
    parser.add_argument("--threads", default="0", help="0: as many as the program takes by itself")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("deck", nargs="*")
    options = parser.parse_args()
    unknown = [deck for deck in options.deck if deck not in all_decks()]
    if unknown:
        sys.exit(f"no such deck in inputs: {' '.join(unknown)}")
    decks = options.deck or (QUICK if options.quick else all_decks())
    command = [*shlex.split(options.under), str(Path(options.program).resolve())]
    threads = [int(number) for number in options.threads.split(",")]
    values, faults = reproduce(command, decks, threads, lambda line: print(line, flush=True))
    if options.update:
        write_reference(read_reference() | values)
        return 0
    return 1 if any(faults.values()) else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Builds the program with every compiler that it is for, runs its tests and decks, and prints a table.

  tests/matrix.py [NAME ...]    the configurations below, or those named
  tests/matrix.py --quick       what continuous integration has the time for besides `make test`
  tests/matrix.py --list        what there is

Each is built with warnings as errors in a folder of its own, build-matrix/NAME, where log.txt has what was printed.
Tests: all, or the fast ones of the Makefile (`make run-fast-tests`), counted as doctest counts them. Decks: the quick
ones of tests/reproduce.py against the committed reference, with 1, 2 and 3 threads (--quick: with 2, as `make long-tests`
compares threads); in brackets those that come out the same to the last bit. What a machine lacks is reported as `not here`, with the packages (Debian's names) that bring it,
and neither as passed nor as failed.

Exit code 1 where something that is here failed. Standard library only.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import reproduce

ROOT = Path(__file__).resolve().parent.parent
SANITIZERS = "-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all"
PROBE = "#include <cstdio>\n#include <vector>\nint main() { return std::vector<double>(1).size() != 1; }\n"


@dataclass
class Configuration:
    name: str
    compiler: str
    flags: str
    packages: str
    tests: str = "run-tests"  # target of the Makefile
    quick: str = None         # the same in --quick; None: not there
    openmp: bool = True
    under: str = ""           # what runs its programs
    threads: tuple = (1, 2, 3)


CONFIGURATIONS = [
    Configuration("g++", "g++", "-O3 -march=native", "g++"),
    Configuration("g++-O2", "g++", "-O2", "g++"),
    Configuration("clang++", "clang++", "-O3 -march=native", "clang libomp-dev"),
    Configuration("clang++-O2", "clang++", "-O2", "clang libomp-dev"),
    Configuration("libc++", "clang++", "-O2 -stdlib=libc++", "clang libomp-dev libc++-dev libc++abi-dev",
                  quick="run-fast-tests"),
    Configuration("no-openmp", "g++", "-O3 -march=native", "g++", openmp=False, threads=(1,)),
    Configuration("sanitizers", "clang++", SANITIZERS, "clang libomp-dev", "run-fast-tests"),
    # The headers of doctest are the machine's own, behind all those of the target.
    Configuration("aarch64", "aarch64-linux-gnu-g++", "-O2 -static -idirafter /usr/include",
                  "g++-aarch64-linux-gnu qemu-user-static", "run-fast-tests", under="qemu-aarch64-static"),
]


def is_here(one, folder):
    """Whether a small program can be built and run."""
    probe = folder / "probe"
    flags = [*one.flags.split(), "-std=c++20", *["-fopenmp"] * one.openmp]
    try:
        subprocess.run([one.compiler, *flags, "-x", "c++", "-", "-o", probe], input=PROBE, text=True, check=True,
                       capture_output=True)
        subprocess.run([*one.under.split(), probe], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        return False
    return True


def make(one, folder, *targets):
    """(whether it went well, what it printed)"""
    compiler = "ccache " * bool(shutil.which("ccache")) + one.compiler
    settings = [f"BUILD={folder.relative_to(ROOT)}", f"CXX={compiler}", f"CXXFLAGS={one.flags}", "WERROR=-Werror",
                f"UNDER={one.under}", *["OPENMP="] * (not one.openmp)]
    # Not as a part of the make that may have started this script, whose jobs it cannot share.
    environment = {name: text for name, text in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    done = subprocess.run(["make", "--no-print-directory", "-k", "-Oline", *targets, *settings], cwd=ROOT, text=True,
                          env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace")
    with (folder / "log.txt").open("a") as log:
        log.write(done.stdout)
    return done.returncode == 0, done.stdout


def passed_of(printed):
    """(tests passed, tests run) of all runs of doctest."""
    runs = re.findall(r"test cases: *(\d+) *\| *(\d+) passed", printed)
    return sum(int(passed) for _, passed in runs), sum(int(cases) for cases, _ in runs)


def check(one, tests, threads):
    """(cells of its row, whether nothing failed)"""
    folder = ROOT / "build-matrix" / one.name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "log.txt").write_text("")
    if not is_here(one, folder):
        return [f"not here: install {one.packages}"], True
    relative = folder.relative_to(ROOT)
    built, printed = make(one, folder, f"{relative}/almesh", *[f"{relative}/almesh-tests"] * bool(tests))
    warnings = len(re.findall(r"\[-W[\w-]*error", printed))
    cells = ["yes" if built else "NO", str(warnings)]
    if not built:
        return cells, False
    passed = True
    if tests:
        passed, printed = make(one, folder, tests)
        cells.append("{} of {}".format(*passed_of(printed)) + ("" if passed else " FAILED"))
    else:
        cells.append("-")
    command = [*one.under.split(), str(folder / "almesh")]
    with (folder / "log.txt").open("a") as log:
        values, faults = reproduce.reproduce(command, reproduce.QUICK, threads,
                                        lambda line: print(line, file=log, flush=True))
    same = sum(not fault for fault in faults.values())
    reference = reproduce.read_reference()
    to_the_bit = sum(reference.get(deck, {}).get("bits") == got["bits"] for deck, got in values.items())
    cells.append(f"{same} of {len(faults)} ({to_the_bit})" + ("" if same == len(faults) else " FAILED"))
    return cells, passed and same == len(faults)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("name", nargs="*")
    options = parser.parse_args()
    names = [one.name for one in CONFIGURATIONS]
    unknown = [name for name in options.name if name not in names]
    if unknown:
        sys.exit(f"no configuration {' '.join(unknown)}: there are {' '.join(names)}")
    if options.list:
        for one in CONFIGURATIONS:
            print(f"{one.name:<12} {one.under} {one.compiler} {one.flags}{'' if one.openmp else ', without OpenMP'}")
        return 0
    chosen = [one for one in CONFIGURATIONS if one.name in options.name or not options.name]
    if options.quick and not options.name:
        chosen = [one for one in chosen if one.quick is not None]
    row = "{:<12} {:<6} {:<9} {:<18} {:<20} {:>8}"
    print(row.format("", "built", "warnings", "tests passed", "decks the same", "time"))
    good = True
    for one in chosen:
        begin = time.monotonic()
        cells, passed = check(one, *((one.quick or "", (2,)) if options.quick else (one.tests, one.threads)))
        seconds = time.monotonic() - begin
        good = good and passed
        if len(cells) == 1:
            print(f"{one.name:<12} {cells[0]}", flush=True)
        else:
            cells += [""] * (4 - len(cells))
            print(row.format(one.name, *cells, f"{seconds:.0f} s"), flush=True)
        if not passed:
            print(f"    see build-matrix/{one.name}/log.txt", flush=True)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())

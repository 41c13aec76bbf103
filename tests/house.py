#!/usr/bin/env python3
"""Measures the roads of the house: how many files and lines a reader opens for each topic, beside the aim.

  tests/house.py            the table; part of `make test`, as a report
  tests/house.py --files    and the files of each topic

A topic is what a reader opens to follow it from its first line to its last, headers included. Exit code 1 only where a
file of a topic is missing, so that the lists stay true. Standard library only.
"""
import re
import sys
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SRC = ROOT / "src"

# topic: most files, most lines, the files: both of `name.*` where there are two.
TOPICS = {
    "Algorithm 1": (5, 450, "method/augmented_lagrangian.* method/schedule.* method/status.* method/functional.hpp "
                    "method/newton.hpp constraint/constraint.hpp"),
    "a Newton step, up to the linear solve": (10, 850, "method/newton.* method/functional.hpp method/line_search.* "
                                              "method/damping.hpp method/forcing.hpp method/eigenvalue_filtering.hpp "
                                              "method/stopping_tests.* method/local_elimination.hpp "
                                              "linalg/linear_solver.hpp"),
    "energy, plain assembly": (8, 750, "energy/distortion_energy.* energy/group_energy.* energy/plain_energy.* "
                               "energy/densities.hpp energy/density_hessian.hpp energy/options.hpp "
                               "energy/element_rules.hpp base/small_matrix.hpp"),
    "constraint as in the paper": (4, 450, "constraint/constraint.hpp constraint/dirichlet.* constraint/trace_space.*"),
    "trace space": (4, 350, "constraint/trace_space.* mesh/quadrature_table.hpp"),
    "driver, from main to minimise": (8, 900, "main.cpp app/commands.hpp app/command_line.cpp app/run/run.cpp "
                                      "app/problem.* method/levels.* method/p_norm.* method/continuation.*"),
}
MOST_LINES, MOST_README_LINES, MOST_DEPTH, MOST_LOOP_LINES = 23000, 180, 9, 30


def lines_of(path):
    return len(path.read_text().splitlines())


def files_of(pattern):
    found = sorted(SRC.glob(pattern))
    if not found:
        sys.exit(f"tests/house.py: no file src/{pattern}: mend its list of topics")
    return found


@lru_cache(maxsize=None)
def chain(path):
    """The longest chain of includes from this file on, itself first."""
    names = re.findall(r'^#include "(.+)"', path.read_text(), re.M)
    below = [chain(SRC / name) for name in names if (SRC / name).exists() and SRC / name != path]
    return [path] + max(below, key=len, default=[])


def loop_lines():
    """Lines of Newton::minimise(), from its name to its closing brace."""
    text = (SRC / "method" / "newton.cpp").read_text().splitlines()
    first = next(i for i, line in enumerate(text) if "Newton::minimise(" in line and not line.startswith(" "))
    return next(i for i, line in enumerate(text[first:], 1) if line == "}")


def main():
    program = [path for path in sorted(SRC.rglob("*.?pp")) if "lessons" not in path.parts]
    print(f"{'topic':40} {'files':>5} {'aim':>4} {'lines':>7} {'aim':>6}")
    for topic, (most_files, most_lines, patterns) in TOPICS.items():
        files = [path for pattern in patterns.split() for path in files_of(pattern)]
        print(f"{topic:40} {len(files):5} {most_files:4} {sum(map(lines_of, files)):7} {most_lines:6}")
        if "--files" in sys.argv[1:]:
            for path in files:
                print(f"  {path.relative_to(ROOT)}: {lines_of(path)}")
    rows = [("src/ without the lessons", sum(map(lines_of, program)), MOST_LINES),
            ("README.md", lines_of(ROOT / "README.md"), MOST_README_LINES),
            ("Newton::minimise()", loop_lines(), MOST_LOOP_LINES)]
    for name, lines, most in rows:
        print(f"{name:40} {'':5} {'':4} {lines:7} {most:6}")
    longest = max((chain(path) for path in program), key=len)
    print(f"{'include depth':40} {len(longest) - 1:5} {MOST_DEPTH:4}")
    if "--files" in sys.argv[1:]:
        print("  " + " > ".join(str(path.relative_to(SRC)) for path in longest))


if __name__ == "__main__":
    main()

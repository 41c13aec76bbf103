#!/usr/bin/env python3
"""The house is not to grow: its ceilings, in lines, and who may include whom. Fails where one is passed.

  tests/house.py            the table; part of `make test`
  tests/house.py --files    and the files of each topic

A ceiling only falls, but for what an issue allows by number. A topic is what a reader opens to follow it from its first
line to its last, headers included. Standard library only.
"""
import re
import sys
from collections import Counter
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SRC = ROOT / "src"

# Rooms, each of which includes only itself and those above it.
ROOMS = {
    "base": 1576, "linalg": 4911, "mesh": 5123, "geometry": 2125, "energy": 3254, "constraint": 3797, "method": 3074,
    "check": 3061, "io": 3862, "problem": 5506, "deck": 1615, "report": 1943, "library": 1100,
    "app": 1434,
}
MOST = {"src/ without lessons and examples": 42810, "src/examples": 900, "src/lessons": 6621, "README.md": 180,
        "Newton::minimise()": 30, "include depth": 10, "a file": 490, "includes beyond the line": 14}
# topic: most files, most lines, the files: both of `name.*` where there are two.
TOPICS = {
    "Algorithm 1": (7, 822, "method/augmented_lagrangian.* method/schedule.hpp method/status.hpp method/functional.hpp "
                    "method/newton.hpp constraint/constraint.hpp"),
    "a Newton step, up to the linear solve": (9, 1058, "method/newton.* method/functional.hpp method/line_search.* "
                                              "method/step_control.hpp method/stopping_tests.hpp "
                                              "method/local_elimination.hpp linalg/linear_solver.hpp"),
    "energy, plain assembly": (10, 1006, "energy/distortion_energy.* energy/group_energy.* lessons/plain_energy.* "
                               "energy/densities.hpp energy/options.hpp "
                               "energy/element_rules.hpp base/small_matrix.hpp"),
    "prescribed positions": (5, 705, "constraint/constraint.hpp constraint/dirichlet.* constraint/trace_space.*"),
    "driver, from main to minimise": (16, 2278, "main.cpp app/commands.hpp app/command_line.cpp app/run/run.cpp "
                                      "deck/make_problem.* problem/problem.* problem/solve.* method/levels.* "
                                      "method/p_norm.* method/continuation.*"),
}
# The line: what a program (a folder of app/) and an example may include beside its own folder. What they still include
# of the rooms below, or of each other, is counted.
PUBLIC = ["almesh.hpp", "app/commands.hpp", "deck/", "report/", "io/mesh_format.hpp", "io/proof_file.hpp", "io/vtk.hpp",
          "base/"]
MOST_OF_PROGRAM = 900


def lines_of(path):
    return len(path.read_text().splitlines())


def room_of(path):
    """The room of a file, "" of what is above all of them."""
    parts = path.relative_to(SRC).parts
    return parts[0] if len(parts) > 1 else ""


def includes_of(path):
    return re.findall(r'^#include "(.+)"', path.read_text(), re.M)


def files_of(pattern):
    found = sorted(SRC.glob(pattern))
    if not found:
        sys.exit(f"tests/house.py: no file src/{pattern}: mend its list of topics")
    return found


@lru_cache(maxsize=None)
def chain(path):
    """The longest chain of includes from this file on, itself first."""
    below = [chain(SRC / name) for name in includes_of(path) if (SRC / name).exists() and SRC / name != path]
    return [path] + max(below, key=len, default=[])


def loop_lines():
    """Lines of Newton::minimise(), from its name to its closing brace."""
    text = (SRC / "method" / "newton.cpp").read_text().splitlines()
    first = next(i for i, line in enumerate(text) if "Newton::minimise(" in line and not line.startswith(" "))
    return next(i for i, line in enumerate(text[first:], 1) if line == "}")


def upward(files):
    """Includes of a room by one that is below it."""
    order = list(ROOMS)
    faults = []
    for path in files:
        room = room_of(path)
        for name in includes_of(path):
            other = name.split("/")[0]
            if room not in order or other not in order or other == room:
                continue
            if order.index(other) < order.index(room):
                continue
            faults.append(f"{path.relative_to(ROOT)} includes {name}: {other}/ is above {room}/")
    return faults


def beyond_the_line(path):
    """What a program or an example includes of the rooms below."""
    own = "/".join(path.relative_to(SRC).parts[:-1]) + "/"
    return [name for name in includes_of(path) if not any(name.startswith(some) for some in (*PUBLIC, own))]


def main():
    everything = sorted(SRC.rglob("*.?pp"))
    lessons = [path for path in everything if room_of(path) == "lessons"]
    examples = [path for path in everything if room_of(path) == "examples"]
    house = [path for path in everything if room_of(path) not in ("lessons", "examples")]
    programs = [path for path in house if room_of(path) == "app" and len(path.relative_to(SRC).parts) > 2]
    faults = []

    def row(name, value, most, files=""):
        print(f"{name:40} {files:>8} {value:7} {most:7}{'' if value <= most else '  <- above its ceiling'}")
        if value > most:
            faults.append(f"{name}: {value}, at most {most}")

    print(f"{'':40} {'files':>8} {'lines':>7} {'most':>7}")
    for topic, (most_files, most_lines, patterns) in TOPICS.items():
        files = [path for pattern in patterns.split() for path in files_of(pattern)]
        row(topic, sum(map(lines_of, files)), most_lines, f"{len(files)}/{most_files}")
        if len(files) > most_files:
            faults.append(f"{topic}: {len(files)} files, at most {most_files}")
        if "--files" in sys.argv[1:]:
            for path in files:
                print(f"  {path.relative_to(ROOT)}: {lines_of(path)}")
    lines = Counter()
    for path in house:
        lines[room_of(path)] += lines_of(path)
    for room, most in ROOMS.items():
        row(room + "/", lines[room], most)
    size = Counter()
    for path in programs:
        size[path.parent] += lines_of(path)
    for folder, count in sorted(size.items()):
        row(f"{folder.relative_to(SRC)}/", count, MOST_OF_PROGRAM)
    longest = max((chain(path) for path in house), key=len)
    largest = max(house, key=lines_of)
    private = {path: beyond_the_line(path) for path in programs + examples}
    for name, value in [("src/ without lessons and examples", sum(map(lines_of, house))),
                        ("src/examples", sum(map(lines_of, examples))),
                        ("src/lessons", sum(map(lines_of, lessons))), ("README.md", lines_of(ROOT / "README.md")),
                        ("Newton::minimise()", loop_lines()), ("include depth", len(longest) - 1),
                        ("a file", lines_of(largest)),
                        ("includes beyond the line", sum(map(len, private.values())))]:
        row(name, value, MOST[name])
    if "--files" in sys.argv[1:]:
        print("  " + " > ".join(str(path.relative_to(SRC)) for path in longest))
        for path, names in private.items():
            print(f"  {path.relative_to(SRC)}: {', '.join(names)}")
    faults += upward(house)
    for fault in faults:
        print(f"tests/house.py: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

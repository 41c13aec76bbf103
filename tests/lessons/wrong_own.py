#!/usr/bin/env python3
"""Tests an almesh of one's own (own.py) with the solutions: that it takes the iterations of almesh_in_one_file on three
meshes and ends at the same q, also with each of its parts from the library; and that it tells which part it is, and
why, where an answer is wrong, crashes or never ends.

  tests/lessons/wrong_own.py [--build FOLDER] [--all]

The wrong answers are those of wrong.txt. One that makes no difference to this solver may run, and then has to come to
the same mesh; every other one has to be told under the name of its part. --all: every part from the library, every
wrong answer, every kind of broken one; otherwise some of them. Exit code 1 where something is not noticed. Standard
library only.
"""
import argparse
import contextlib
import io
import sys
import tempfile
from pathlib import Path

import own
from answers import LESSONS, ROOT, Limits
from one_file import CASES, of_one_file
from wrong import INCLUDES, KINDS, functions, solved, wrong_answers

TIGHT = Limits(seconds=5, memory=512, output=1)
TOLD = 33  # wrong answers that have to be told, of all: what the others get wrong is not used here


def tried(files, choice, build, limits=own.LIMITS, words=tuple(own.CIRCLE)):
    """(what it says where it fails, or ""; the rows of its table)."""
    with tempfile.TemporaryDirectory(prefix="almesh-own-") as results, contextlib.redirect_stdout(io.StringIO()):
        try:
            own.run(own.linked(files, choice, build), words, build, Path(results), limits)
            return "", own.rows_of(Path(results))
        except own.Problem as problem:
            return str(problem), []


def with_answers(build, limits=own.LIMITS, **sources):
    """The same with texts in place of the solutions, named by lesson: _04=text."""
    with tempfile.TemporaryDirectory(prefix="almesh-own-") as name:
        folder, choice = Path(name) / "wrong", own.Choice([], {})
        folder.mkdir()
        for lesson_, source in sources.items():
            (folder / f"{lesson_[1:]}.cpp").write_text(source)
        files = [folder / file.name if (folder / file.name).exists() else file
                 for file in own.sources("solutions", choice)]
        return tried(files, choice, build, limits)


def with_answer(number, source, build, limits=own.LIMITS):
    return with_answers(build, limits, **{f"_{own.lesson_of(number)}": source})


def test_meshes(build, failures):
    """The three meshes of one_file.py: the same updates, Newton steps and q. Those of the circle are returned."""
    choice, steps = own.Choice([], {}), {}
    for mesh, (moving, motion, _) in CASES.items():
        with tempfile.TemporaryDirectory() as folder:
            expected = of_one_file(build, folder, mesh, moving, motion)
        message, rows = tried(own.sources("solutions", choice), choice, build,
                              words=[f"inputs/meshes/{mesh}", moving, *motion.split()])
        found = [[row["update"], int(row["newton"])] for row in rows]
        if message or found != [row[3:] for row in expected] or abs(float(rows[-1]["q"]) - expected[-1][1]) > 1e-9:
            failures.append(f"{mesh}: {message or found}, of the one file {expected}")
        steps[mesh] = [row[4] for row in expected]
    return steps["circle.msh"]


def test_parts(build, every, failures):
    """All parts of the student, all of the library, each of the library alone."""
    expected = test_meshes(build, failures)
    choices = [list(own.PARTS), *([part] for part in own.PARTS if every or part in ("solver", "assembly"))]
    for borrowed in choices:
        choice = own.Choice(borrowed, {})
        message, rows = tried(own.sources("solutions", choice), choice, build)
        steps = [int(row["newton"]) for row in rows]
        if message or not own.reproduces(rows) or steps != expected:
            failures.append(f"with {borrowed} borrowed: {message or own.summary(rows)}, steps {steps}")
    if failure := own.grade("solutions", build):
        failures.append(f"the solutions are no almesh of their own: {failure}")
    return len(choices) + 1


def lesson(number):
    return next(path for path in LESSONS if path.name[:2] == own.lesson_of(number))


def test_wrong(build, every, failures):
    """How many there were, and how many of them were told."""
    entries, count, told = wrong_answers(), 0, 0
    for part in own.PARTS:
        numbers = own.exercises_of(part)
        for number in numbers if every else numbers[:1]:
            for wrong in entries[number] if every else entries[number][-1:]:
                source, problem = wrong.put_into(*solved(lesson(number)))
                message, rows = ("", []) if problem else with_answer(number, source, build)
                count, told = count + 1, told + bool(message)
                if problem or (message and not message.startswith(f"{part} fails")) or (
                        not message and not own.reproduces(rows)):
                    failures.append(f"{number} {wrong.name}: {problem or message or own.summary(rows)}")
    if every and told < TOLD:
        failures.append(f"{told} wrong answers are told, expected {TOLD} at least")
    return count


def test_broken(build, every, failures):
    says = {"this is no C++;": "does not compile", "extern int nowhere(); nowhere();": "do not link",
            "for (;;) sleep(1);": "still waits", "std::exit(0);": "ends the whole program", "throw 1;": "throws"}
    kinds = [kind for kind in KINDS if "inputs/" not in kind[0]]
    parts = list(own.PARTS)
    for k, (line, _) in enumerate(kinds if every else kinds[2:6]):
        part = parts[k % len(parts)]
        number = own.exercises_of(part)[-1]
        source, place = solved(lesson(number))[0], functions(lesson(number))[number]
        message, _ = with_answer(number, f"{INCLUDES}{source[:place]}\n    {line}\n{source[place:]}", build, TIGHT)
        if says.get(line, "") not in message or not (message.startswith(f"{part} fails") or line in says
                                                     or "puts" in line or "notes.txt" in line and "notes" in message):
            failures.append(f"{number} with `{line}`: {message or 'it runs'}")
    helper = "double help(double a) { return a; }\n"
    message, _ = with_answers(build, _09=helper + solved(lesson("9.4"))[0], _10=helper + solved(lesson("10.4"))[0])
    if "two of your files define help(double)" not in message:
        failures.append(f"two functions of one name: {message or 'it runs'}")
    return (len(kinds) if every else 4) + 1


def test_forged(build, failures):
    """An answer that prints and writes what a run of the paper's circle does, and ends the program: as good a run as
    any for the circle, and no other."""
    choice = own.Choice([], {})
    with tempfile.TemporaryDirectory(prefix="almesh-own-") as name:
        results, folder = Path(name), Path(name) / "wrong"
        with contextlib.redirect_stdout(io.StringIO()):
            own.run(own.linked(own.sources("solutions", choice), choice, build), own.CIRCLE, build, results)
        files = "".join(f'std::ofstream("outputs/lessons/12-project/own.{kind}") << R"own({text})own";'
                        for kind, text in (("csv", (results / "own.csv").read_text()), ("vtk", "")))
        forged = (f"{INCLUDES}#include <filesystem>\nstatic const int first = [] {{\n"
                  'std::filesystem::create_directories("outputs/lessons/12-project");\n'
                  f'{files}\nstd::puts("{own.END}"); std::fflush(stdout); _Exit(0); return 0; }}();\n')
        folder.mkdir()
        (folder / "04.cpp").write_text(forged + solved(lesson("4.3"))[0])
        sources = [folder / "04.cpp" if file.name == "04.cpp" else file for file in own.sources("solutions", choice)]
        try:
            message = own.differs(own.linked(sources, choice, build), build)
        except own.Problem as problem:
            message = str(problem)
    if "with the library's parts at" not in message:
        failures.append(f"a run that is forged is taken for one: {message or 'it holds'}")
    return 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("--all", action="store_true")
    options = parser.parse_args()
    build, failures = (ROOT / options.build).resolve(), []
    parts = test_parts(build, options.all, failures)
    wrong = test_wrong(build, options.all, failures)
    broken = test_broken(build, options.all, failures) + test_forged(build, failures)
    print(f"an almesh of one's own: {parts} choices of parts, {wrong} wrong and {broken} broken answers: " +
          (f"{len(failures)} FAILURES" if failures else "the same mesh, or the part at fault is named"))
    print("\n".join(failures), file=sys.stderr, end="\n" if failures else "")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

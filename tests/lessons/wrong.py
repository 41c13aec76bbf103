#!/usr/bin/env python3
"""Tests what checks the answers to the exercises: that wrong answers are refused, with a message that helps, and that
broken ones spoil nothing.

  tests/lessons/wrong.py [--build FOLDER] [--all] [NN ...]    of all lessons, or of those named

Wrong answers are changes of the solutions, five of them or more for each exercise, in wrong.txt:

  1.3 the power of 2D          number of the exercise, what is wrong
  - std::cbrt(det * det)       once in the solution, or in one of the lesson's decks
  + det                        what takes its place; \\n: a new line
  > size                       what the message has to say, for one that helps

  1.3 one for all              or lines at the beginning of a function of the solution
  @ eta_3d                     its name
  + return 1;
  > infinity

The first of every exercise of a lesson are compiled together, so are the second and so on. Broken answers are made
from the solutions: a line that crashes, never ends, prints without end, ... goes into the function of one exercise. Its
row has to give the reason, all other exercises have to hold, and the table has to be whole. --all: a hundred of them;
otherwise one of each kind, and of the wrong answers the first of each exercise. Exit code 1 where something is not
noticed. `answers.py` has the commands. Standard library only.
"""
import argparse
import contextlib
import csv
import io
import os
import re
import sys
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path

from answers import LESSONS, ROOT, Answers, Limits, check, show_one, watch, write

WRONG = Path(__file__).resolve().parent / "wrong.txt"
PER_EXERCISE = 5  # at least
LIMITS = Limits(seconds=30)
TIGHT = Limits(seconds=3, memory=512, output=1)
BROKEN = 100


def solution_of(lesson):
    return ROOT / "src" / "lessons" / "solutions" / f"{lesson.name[:2]}.cpp"


def graded(lesson, source, decks, build, limits):
    """The rows for answers that are the text `source` and the decks {name: text}; None: there is no such file."""
    with tempfile.TemporaryDirectory(prefix="almesh-wrong-") as name:
        folder, number = Path(name), lesson.name[:2]
        if source is not None:
            (folder / f"{number}.cpp").write_text(source)
        (folder / "decks").mkdir()
        for deck, text in decks.items():
            (folder / "decks" / deck).write_text(text)
        answers = Answers(lesson, folder / f"{number}.cpp", folder / "decks", build, f"wrong-{number}")
        answers.program.unlink(missing_ok=True)
        rows = check(answers, limits)
        answers.program.unlink(missing_ok=True)
        return rows


def solved(lesson):
    """(source, decks)"""
    folder = lesson / "solutions"
    return solution_of(lesson).read_text(), {deck.name: deck.read_text() for deck in folder.glob("*.deck")}


# ------------------------------------------------------------------------------------------------- wrong answers

@dataclass
class Wrong:
    exercise: str
    name: str
    old: str
    new: str
    says: str
    function: str

    def put_into(self, source, decks):
        """"" or what is wrong with this entry; the source comes back changed."""
        if self.function:
            begins = list(re.finditer(rf"^[\w:<>, ]+ {self.function}\([^;{{]*\) {{", source, re.MULTILINE))
            if len(begins) != 1:
                return source, f"{self.function}() is {len(begins)} times in the solution, not once"
            return f"{source[:begins[0].end()]}\n{self.new}\n{source[begins[0].end():]}", ""
        places = [name for name, text in decks.items() if self.old in text]
        count = source.count(self.old) + sum(text.count(self.old) for text in decks.values())
        if count != 1:
            return source, f"`{self.old}` is {count} times in the solutions, not once"
        for name in places:
            decks[name] = decks[name].replace(self.old, self.new)
        return source.replace(self.old, self.new), ""


def wrong_answers():
    """{exercise: its wrong answers}"""
    found = {}
    for entry in re.split(r"\n\s*\n", WRONG.read_text()):
        lines = [line for line in entry.split("\n") if line and not line.startswith("#")]
        if not lines:
            continue
        number, name = lines[0].split(" ", 1)
        parts = {mark: "\n".join(line[2:] for line in lines[1:] if line[:1] == mark).replace("\\n", "\n")
                 for mark in "-+>@"}
        found.setdefault(number, []).append(Wrong(number, name, *(parts[mark] for mark in "-+>@")))
    return found


def test_wrong(lesson, build, every, failures):
    """How many wrong answers were tried; what was not noticed goes into `failures`."""
    entries, tried = {number: found for number, found in wrong_answers().items()
                      if number.split(".")[0].zfill(2) == lesson.name[:2]}, 0
    for k in range(max([PER_EXERCISE, *map(len, entries.values())]) if every else 1):
        source, decks = solved(lesson)
        chosen = {number: found[k] for number, found in entries.items() if k < len(found)}
        for wrong in chosen.values():
            source, problem = wrong.put_into(source, decks)
            if problem:
                failures.append(f"{wrong.exercise} {wrong.name}: {problem}")
        for row in graded(lesson, source, decks, build, LIMITS):
            if row.number not in chosen:
                if k < PER_EXERCISE:
                    failures.append(f"{row.number} has no wrong answer {k + 1} in wrong.txt")
                continue
            wrong, tried = chosen[row.number], tried + 1
            if row.holds:
                failures.append(f"{row.number} {wrong.name}: the wrong answer holds")
            elif wrong.says not in row.message:
                failures.append(f"{row.number} {wrong.name}: the message does not say `{wrong.says}`: {row.message}")
    return tried


# ------------------------------------------------------------------------------------------------- broken answers

INCLUDES = "".join(f"#include <{name}>\n" for name in ("cstdio", "cstdlib", "fstream", "unistd.h", "vector"))
RECURSION = ("struct Deep { static int f(int i) { volatile int a[1000]; a[i % 1000] = i; return f(i + 1) + a[0]; } };"
             " if (Deep::f(0) == 1) std::abort();")
# What goes into a function, what its row has to say.
CIRCLE, SQUARE = "inputs/meshes/circle.msh", "inputs/meshes/square.msh"
KINDS = [
    ("this is no C++;", "does not compile"),
    ("extern int nowhere(); nowhere();", "does not compile"),
    ("std::abort();", "crashes (SIGABRT)"),
    ("*static_cast<volatile int*>(nullptr) = 1;", "crashes (SIGSEGV)"),
    (RECURSION, "crashes (SIGSEGV)"),
    ("for (volatile int i = 0;; i = i) {}", "a loop that does not end"),
    ("for (;;) sleep(1);", "still waits"),
    ("for (;;) std::puts(\"I am here, and here, and here\");", "prints or writes more than"),
    ("for (std::vector<double*> all;;) all.push_back(new double[1 << 20]{});", "more memory"),
    ("std::exit(0);", "ends the whole program"),
    ("throw 1;", "throws something"),
    ("throw std::vector<int>().at(1);", "throws an exception"),
    (f'static std::ofstream mesh("{SQUARE}"); mesh << 1;', f"writes or removes {SQUARE}"),
    ("static std::ofstream notes(\"notes.txt\"); notes << 1;", "writes or removes notes.txt"),
    (f'static const int gone = std::remove("{CIRCLE}"); (void)gone;', f"writes or removes {CIRCLE}"),
]


def functions(lesson):
    """{exercise: the place in the solution where the body of its first function begins}, where it has one."""
    source, header = (path.read_text() for path in (
        solution_of(lesson), ROOT / "src" / "lessons" / "exercises" / f"{lesson.name[:2]}.hpp"))
    places = {}
    for number, declaration in re.findall(r"^// (\d+\.\d+)(.*?)(?=^// \d+\.\d+|\Z)", header, re.DOTALL | re.MULTILINE):
        declared = re.search(r"^[\w:<>, ]+ (\w+)\([^;]*\);", declaration, re.MULTILINE)
        defined = declared and re.search(rf"^[\w:<>, ]+ {declared[1]}\([^;{{]*\) {{", source, re.MULTILINE)
        if defined:
            places.setdefault(number, defined.end())
    return places


def test_broken(lesson, broken, build, failures):
    """One program with answers that are broken; broken: [(exercise, place in the solution, one of KINDS)]."""
    source, decks = solved(lesson)
    for _, place, (line, _) in sorted(broken, key=lambda one: -one[1]):
        source = source[:place] + "\n    " + line + "\n" + source[place:]
    kinds = {number: kind for number, _, kind in broken}
    rows = graded(lesson, INCLUDES + source, decks, build, TIGHT)
    for row in rows:
        line, says = kinds.get(row.number, ("", ""))
        if line and says not in row.message:
            failures.append(f"row {row.number} with `{line}` does not say `{says}`: {row.message}")
        if not line and not row.holds and needs_little(row.number):
            failures.append(f"beside {list(kinds)} with {list(kinds.values())} the sound answer {row.number} is "
                            f"refused: {row.message}")
    whole_table(rows, failures)


def broken_programs(lessons, every):
    """[(lesson, broken answers)]: a hundred of one answer each, or else one of each kind, together where they are
    answers to one lesson."""
    places = [(lesson, number, place) for lesson in lessons for number, place in functions(lesson).items()]
    if every:
        chosen = [(places[k * len(places) // BROKEN], KINDS[k % len(KINDS)]) for k in range(BROKEN)]
        return [(lesson, [(number, place, kind)]) for (lesson, number, place), kind in chosen]
    found, together = [], {}
    for k, kind in enumerate(KINDS):
        lesson, number, place = places[k % len(places)]
        if number in (one[0] for one in together.get(lesson, [])):
            found.append((lesson, [(number, place, kind)]))
        else:
            together.setdefault(lesson, []).append((number, place, kind))
    return found + list(together.items())


def needs_little(number):
    """Whether the exercise is not a deck: these may need more than the tight limits."""
    return not number.startswith(("9.5", "11.5", "12."))


def whole_table(rows, failures):
    """What is written can be read again, row for row."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "answers.csv"
        cells = [["lesson", row.number, row.title, "no", row.message] for row in rows]
        write(path, cells)
        with path.open(newline="") as file:
            if list(csv.reader(file))[1:] != cells:
                failures.append("answers.csv is not what was written")


def test_files(lesson, build, failures):
    """Files that are not there or hold no text, and decks that are not there."""
    source, decks = solved(lesson)
    library = source + "\nstatic almesh::BlockCsr of_cells() { return almesh::matrix_of_cells(1, 1, {}, 3); }\n"
    for text, says in ((None, "is missing"), ("\0\1\2", "does not compile"),
                       ('#include "energy/densities.hpp"\n' + source, 'includes "energy/densities.hpp"'),
                       (library, "calls matrix_of_cells")):
        rows = graded(lesson, text, decks, build, TIGHT)
        failures += [f"{row.number}: `{says}` is not said: {row.message}" for row in rows if says not in row.message]
    with_deck = [row for row in graded(lesson, source, {}, build, LIMITS) if not row.holds]
    failures += [f"{row.number}: a deck that is missing is not told: {row.message}" for row in with_deck
                 if ".deck" not in row.message]
    if bool(with_deck) != bool(decks):
        failures.append(f"{lesson.name}: without decks {len(with_deck)} answers are refused")


def test_watch(lesson, build, failures):
    """A save is seen: first the solution with a mistake, then without."""
    source, _ = solved(lesson)
    with tempfile.TemporaryDirectory(prefix="almesh-wrong-") as name:
        answers = Answers(lesson, Path(name) / f"{lesson.name[:2]}.cpp", Path(name), build, f"wrong-{lesson.name[:2]}")
        wrong = wrong_answers()["1.3"][0]
        answers.source.write_text(wrong.put_into(source, {})[0])
        save = threading.Timer(8, lambda: answers.source.write_text(source))
        save.start()
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            watch(answers, rounds=2)
        save.join()
        answers.program.unlink(missing_ok=True)
    parts = printed.getvalue().split("next: 1.3; a hint: make hint-01-3")
    if len(parts) != 2 or "all done" not in parts[1]:
        failures.append(f"watching does not see a save, or not what is next: {printed.getvalue()}")


def test_show(lesson, build, failures):
    """What an answer prints is shown although it holds."""
    source, _ = solved(lesson)
    place = functions(lesson)["1.3"]
    with tempfile.TemporaryDirectory(prefix="almesh-wrong-") as name:
        answers = Answers(lesson, Path(name) / f"{lesson.name[:2]}.cpp", Path(name), build, f"wrong-{lesson.name[:2]}")
        answers.source.write_text(INCLUDES + source[:place] + "\n    std::puts(\"I was here\");\n" + source[place:])
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            code = show_one(answers, "3")
        answers.program.unlink(missing_ok=True)
    if code != 0 or "I was here" not in printed.getvalue() or "1 of 1" not in printed.getvalue():
        failures.append(f"what an answer prints is not shown: {printed.getvalue()}")


# ------------------------------------------------------------------------------------------------- command line

def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("lesson", nargs="*")
    options = parser.parse_args()
    os.environ.setdefault("SEED", "1")
    build = (ROOT / options.build).resolve()
    lessons = [lesson for lesson in LESSONS if not options.lesson or lesson.name[:2] in options.lesson]
    failures = []
    wrong = sum(test_wrong(lesson, build, options.all, failures) for lesson in lessons)
    programs = broken_programs(lessons, options.all)
    for lesson, broken in programs:
        test_broken(lesson, broken, build, failures)
    for lesson in lessons:
        if lesson.name[:2] == "01":
            test_watch(lesson, build, failures)
            test_show(lesson, build, failures)
        if lesson.name[:2] in ("03", "07"):  # without and with a deck
            test_files(lesson, build, failures)
    count = sum(len(broken) for _, broken in programs)
    print(f"{wrong} wrong and {count} broken answers: " + (f"{len(failures)} NOT NOTICED" if failures else
                                                           "each is refused with its reason, and spoils no other"))
    print("\n".join(failures), file=sys.stderr, end="\n" if failures else "")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

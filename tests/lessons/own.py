#!/usr/bin/env python3
"""An almesh of one's own: links what the answers to lessons 1 to 10 leave into Algorithm 1 (src/lessons/own/), and runs
it on the circle of the paper's section 4.1.

  tests/lessons/own.py [--build FOLDER] [exercises | solutions]
  tests/lessons/own.py --borrow "solver trace" [...]   these parts are the library's; `open`: all that are not solved
  tests/lessons/own.py --unchecked [...]               without the checks of the exercises, on one's own risk
  tests/lessons/own.py --run MESH BOUNDARY MOTION ...  another mesh: inputs/meshes/plate.msh plate rotate 30

It tells of each part which exercises it is made of and whose it is. A part whose exercises do not hold is open: then
it says what to do, and nothing is run. What fails in the run is told with the part's name. Results are in
outputs/lessons/12-project/. Exit code 1 where a part is open or fails. Standard library only.
"""
import argparse
import csv
import io
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import answers as grader
import running
from answers import LESSONS, ROOT

# Of each part the exercises that it is made of, and what it does; the names are those of src/lessons/own/parts.cpp.
PARTS = {
    "distortion": ("1.4", "eta of a triangle, infinite where it is inverted"),
    "gradient": ("2.2", "eta_F"),
    "hessian": ("2.4 2.5", "the second derivative of eta^2"),
    "assembly": ("3.1 3.2 3.3 3.4", "gradient and Hessian of the mesh"),
    "projection": ("4.3", "the Hessian where it is indefinite"),
    "line_search": ("4.2 4.5", "the first valid step that satisfies Armijo's condition"),
    "trace": ("7.2", "the scalar product of the boundary"),
    "update": ("7.1", "line 10: the multipliers"),
    "schedule": ("8.3 8.4", "lines 7 and 9 to 21: penalty and tolerances"),
    "solver": ("10.4", "conjugate gradients, for every Newton step"),
    "certificate": ("9.3 9.4", "a proof that no triangle is inverted on the way"),
}
CIRCLE = ["inputs/meshes/circle.msh", "inner", "translate", "8", "0"]
FOLDER = ROOT / "outputs" / "lessons" / "12-project"
LIMITS = grader.Limits(seconds=40, memory=4096, output=16)
END = "the library's certificate of the result: "


def exercises_of(part):
    return PARTS[part][0].split()


def lesson_of(number):
    return number.split(".")[0].zfill(2)


class Problem(Exception):
    """What keeps the parts from being put together or from running, in words for the student."""


@dataclass
class Choice:
    borrowed: list  # parts that are the library's
    failed: dict    # {part: {exercise: message}} of those that are open

    @property
    def own(self):
        return [part for part in PARTS if part not in self.borrowed and part not in self.failed]


# ------------------------------------------------------------------------------------------------- whose parts

def check(kind, build, parts):
    """{part: {exercise: why it does not hold}} of those parts where one does not."""
    numbers = {number for part in parts for number in exercises_of(part)}
    messages = {}
    for lesson in LESSONS:
        wanted = {number for number in numbers if lesson_of(number) == lesson.name[:2]}
        if wanted:
            rows = grader.check(grader.answers_of(lesson, kind, build), numbers=wanted)
            messages |= {row.number: row.message for row in rows if not row.holds}
    failed = {part: {number: messages[number] for number in exercises_of(part) if number in messages}
              for part in parts}
    return {part: found for part, found in failed.items() if found}


def choose(kind, build, words, checked=True):
    unknown = [word for word in words if word not in PARTS and word != "open"]
    if unknown:
        raise Problem(f"there is no part {unknown[0]}; the parts are {', '.join(PARTS)}, and `open` is all that "
                      "are not solved")
    named = [part for part in PARTS if part in words]
    failed = check(kind, build, [part for part in PARTS if part not in named]) if checked else {}
    if "open" in words:
        return Choice([part for part in PARTS if part in named or part in failed], {})
    return Choice(named, failed)


def show(choice):
    print(f"{'part':<12} {'exercises':<20} {'whose':<8} what it does")
    for part, (numbers, what) in PARTS.items():
        whose = "open" if part in choice.failed else "library" if part in choice.borrowed else "yours"
        print(f"{part:<12} {numbers.replace(' ', ', '):<20} {whose:<8} {what}")
    print(f"{len(choice.own)} of {len(PARTS)} parts are yours")
    if choice.failed:
        print("\nopen are:")
        for part, messages in choice.failed.items():
            for number, message in messages.items():
                print(f"  {part:<12} {number:<5} {message if len(message) < 160 else message[:157] + '...'}")
        first = next(iter(next(iter(choice.failed.values()))))
        hint = f"a hint: make hint-{lesson_of(first)}-{first.split('.')[1]}"
        print(f"next: exercise {first}; {hint}\n"
              f"or go on with the library's parts where yours are open: make own-almesh BORROW=open")
    sys.stdout.flush()


# ------------------------------------------------------------------------------------------------- building

def compiled(source, target, command, used):
    """target, made of source; Problem where that does not compile. Kept as long as all it is made of is the same."""
    key = running.digest(*map(str, command), source, *used)
    if running.kept(target, key):
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    command = [*command, "-c", source, "-o", target]
    done = subprocess.run(command, cwd=ROOT, text=True, capture_output=True)
    if done.returncode != 0:
        errors = [line for line in done.stderr.splitlines() if "error" in line] or ["no reason given"]
        raise Problem(f"{running.shown(source)} does not compile: {errors[0].replace(f'{ROOT}/', '')}")
    running.keep(target, key)
    return target


def sources(kind, choice):
    """The files with the answers that the student's parts are made of."""
    lessons = sorted({lesson_of(number) for part in choice.own for number in exercises_of(part)})
    return [ROOT / "src" / "lessons" / kind / f"{lesson}.cpp" for lesson in lessons]


def linked(files, choice, build):
    """The program."""
    command, own = running.compiler(build), build / "lessons" / "own"
    headers = sorted([*(ROOT / "src" / "lessons").glob("*.hpp"), *(ROOT / "src" / "lessons" / "own").glob("*.hpp"),
                      *(ROOT / "src" / "lessons" / "exercises").glob("*.hpp"), build / "libalmesh.a"])
    missing = next((source for source in files if not source.is_file()), None)
    if missing:
        raise Problem(f"{running.shown(missing)} is missing: {running.back(running.shown(missing))}")
    borrowed = " ".join(choice.borrowed)
    objects = [compiled(ROOT / "src" / "lessons" / "own" / "parts.cpp",
                        own / f"parts-{'-'.join(choice.borrowed) or 'all'}.o",
                        [*command, f'-DBORROWED="{borrowed}"'], headers)]
    for source in files:
        name = f"{source.parent.name}-{source.stem}.o"
        objects.append(compiled(source, own / name, [*command, f"-Dlessons=lesson_{source.stem}"], headers))
    made = [build / "src" / "lessons" / "own" / f"{name}.o" for name in ("almesh", "rehearsal")]
    program = own / ("own-almesh" if files else "library-almesh")
    command = [*command, *made, *objects, build / "libalmesh.a", "-o", program]
    done = subprocess.run(command, cwd=ROOT, text=True, capture_output=True)
    if done.returncode == 0:
        return program
    twice = re.search(r"multiple definition of `([^']+)'", done.stderr)
    if twice:
        raise Problem(f"two of your files define {twice[1]} outside of the namespace: write `static` before it in both")
    lacks = re.search(r"undefined reference to `([^']+)'", done.stderr)
    raise Problem(f"the parts do not link: {'there is no ' + lacks[1] if lacks else done.stderr[-300:]}")


# ------------------------------------------------------------------------------------------------- running

def run(program, words, build, results=FOLDER, limits=LIMITS):
    """Problem, with the name of the part that fails where one does; prints what the program says up to then. It runs
    in a folder of its own with a copy of the mesh; what it writes comes to `results`."""
    mesh = ROOT / words[0]
    if not mesh.is_file():
        raise Problem(f"there is no mesh {words[0]}")
    with tempfile.TemporaryDirectory(prefix="almesh-own-") as outside:
        folder, log = Path(outside) / "checkout", Path(outside) / "printed"
        folder.mkdir()
        shutil.copy2(mesh, folder)
        before = grader.contents(folder)
        with log.open("wb") as output:
            begun = grader.processor_time()
            code = grader.run([program, mesh.name, words[1], " ".join(words[2:])], folder, 4 * limits.seconds,
                              grader.bounds(limits, memory=True), output)
        printed, after = grader.text_of(log), grader.contents(folder)
        touched = sorted(str(path) for path in before.keys() | after.keys() if before.get(path) != after.get(path))
        written = folder / "outputs" / "lessons" / "12-project"
        if code == 0 and not touched and END in printed:
            results.mkdir(parents=True, exist_ok=True)
            for name in ("own.csv", "own.vtk"):
                shutil.copy2(written / name, results)
    explain(code, printed, touched, limits, grader.processor_time() - begun)


def explain(code, printed, touched, limits, used):
    """Problem where the run has failed."""
    fails = re.search(r"^FAILS (\w*): (.*)", printed, re.MULTILINE)
    before = (printed[:fails.start()] if fails else printed).strip("\n")
    print(before, end="\n" if before else "", flush=True)
    if fails and fails[1] in PARTS:
        numbers = exercises_of(fails[1])
        raise Problem(f"{fails[1]} fails (exercise{'s' if len(numbers) > 1 else ''} {', '.join(numbers)}): {fails[2]}\n"
                      f"  make check-lesson-{lesson_of(numbers[0])} checks it alone; with the library's: "
                      f"make own-almesh BORROW={fails[1]}")
    if fails:
        raise Problem(f"{fails[2]}\n  borrow these parts one by one to see whose fault it is: make own-almesh "
                      "BORROW=solver")
    if code == 2:
        raise Problem("nothing was run: the line above says why")
    if code != 0 or END not in printed:
        raise Problem(f"an answer {grader.ending(code, limits, used)}")
    if touched:
        raise Problem(f"an answer writes or removes {touched[0]}: answers return their results and touch no files")


def rows_of(folder=FOLDER):
    with (folder / "own.csv").open() as file:
        return list(csv.DictReader(file))


def summary(rows):
    steps = sum(int(row["newton"]) for row in rows)
    return (f"q = {float(rows[-1]['q']):.4f} after {len(rows)} iterations and {steps} Newton steps; "
            "the paper has 0.936 after 6 (Table 1: cut, not rounded)")


def reproduces(rows):
    """Whether q and the iterations are those of the paper, as the program and almesh_in_one_file have them."""
    return (abs(float(rows[-1]["q"]) - 0.93652605) < 1e-6 and len(rows) <= 6 and float(rows[-1]["c"]) <= 1e-7
            and abs(float(rows[-1]["max_eta"]) - 2.742066) < 1e-4)


def rows_on(program, words, build):
    """The table of a run of which nothing is kept."""
    with tempfile.TemporaryDirectory(prefix="almesh-own-") as results, redirect_stdout(io.StringIO()):
        run(program, words, build, Path(results))
        return rows_of(Path(results))


def differs(program, build):
    """"" where the program reproduces the paper's circle, and one moved by as much as nobody can guess, which the
    library's parts tell."""
    rows = rows_on(program, CIRCLE, build)
    if not reproduces(rows):
        return f"{summary(rows)}: that is another minimum"
    moved = [*CIRCLE[:3], f"{random.Random(os.environ.get('SEED')).uniform(5, 8):.4f}", "0"]
    rows, expected = (rows_on(made, moved, build) for made in (program, linked([], Choice(list(PARTS), {}), build)))
    near = all(abs(float(rows[-1][name]) - float(expected[-1][name])) < 1e-5 for name in ("q", "max_eta"))
    return "" if near else (f"the circle moved by {moved[3]} ends at q = {float(rows[-1]['q']):.6f}, with the library's"
                            f" parts at q = {float(expected[-1]['q']):.6f}: make own-almesh RUN='{' '.join(moved)}'")


def grade(kind, build):
    """"" where all parts are the student's and reproduce the paper's circle; else what is missing."""
    try:
        choice = choose(kind, build, [])
        if choice.failed:
            part, messages = next(iter(choice.failed.items()))
            return (f"{len(choice.failed)} of {len(PARTS)} parts are open, the first is {part}: exercise "
                    f"{next(iter(messages))} does not hold yet; make own-almesh has the table")
        return differs(linked(sources(kind, choice), choice, build), build)
    except Problem as problem:
        return str(problem)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("--borrow", default="")
    parser.add_argument("--unchecked", action="store_true")
    parser.add_argument("--run", nargs="+", default=CIRCLE)
    parser.add_argument("answers", nargs="?", choices=("exercises", "solutions"), default="exercises")
    options = parser.parse_args()
    build = (ROOT / options.build).resolve()
    if len(options.run) < 3:
        parser.error("--run MESH BOUNDARY MOTION, for example inputs/meshes/plate.msh plate rotate 30")
    try:
        choice = choose(options.answers, build, options.borrow.replace(",", " ").split(), not options.unchecked)
        show(choice)
        if choice.failed:
            return 1
        run(linked(sources(options.answers, choice), choice, build), options.run, build)
        if options.run == CIRCLE:
            print(summary(rows_of()))
        print(f"results: {FOLDER.relative_to(ROOT)}/own.csv and own.vtk")
        return 0
    except Problem as problem:
        print(f"\n{problem}")
        return 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Checks the answers to the exercises of the course: each in a process and a folder of its own, with limits of time,
memory and output, so that no answer can spoil the others' rows.

  tests/lessons/answers.py [--build FOLDER] [exercises | solutions]   a table, and outputs/lessons/answers.csv
  tests/lessons/answers.py [--build FOLDER] --lesson NN [...]         one lesson, and what a wrong answer shows
  tests/lessons/answers.py [--build FOLDER] --lesson NN --watch       again at each save, and what is next
  tests/lessons/answers.py [--build FOLDER] --lesson NN --show K      exercise K alone, with all that its answer prints
  tests/lessons/answers.py [--build FOLDER] --self-test               the checks themselves: each solution holds, and
                                                                      no template does, and says why

It compiles the answers itself (compiling.py), with the command in FOLDER/flags, under the sanitizers that the compiler
has: a file that is missing is a reason in all rows of its lesson, a function that does not compile in those that use
it. An answer may include headers of the standard library and those of its exercises. The judge, which `make` has built
the parts of, loads no answers: its children do, and send values back, so that only its exit code 0 says that an answer
holds. What an answer writes into its folder is told; what it writes elsewhere cannot be seen. Exit code 1 where an
answer does not hold, or the self-test fails. Standard library only.
"""
import argparse
import csv
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from compiling import compile_answers, judge, names_of_answers
from running import MEGABYTE, ROOT, back, run, sanitizers, shown, text_of

LESSONS = sorted((ROOT / "inputs" / "lessons").glob("[0-9][0-9]-*"))
MESHES = ("circle.msh", "cube.msh", "square.msh")  # of inputs/meshes/, which exercises read
OWN_ALMESH = ("12.6", "an almesh of your own (make own-almesh)")  # made of the answers to all lessons: own.py
EXERCISE = re.compile(r'^EXERCISE\("([\d.]+)", "(.*)"\)', re.MULTILINE)


@dataclass
class Limits:
    seconds: int = 30         # of processor time; four times as much by the clock
    memory: int = 2048        # MB
    output: int = 16          # MB of one file, and of what is printed
    compilation: int = 120    # seconds


@dataclass
class Row:
    number: str
    title: str
    message: str              # "" where the answer holds
    printed: str = ""

    @property
    def holds(self):
        return self.message == ""


@dataclass
class Answers:
    """Where the answers to a lesson are."""
    lesson: Path              # inputs/lessons/NN-name
    source: Path              # NN.cpp
    decks: Path               # the folder with decks, which need not exist
    build: Path
    name: str                 # of the program

    @property
    def number(self):
        return self.lesson.name[:2]

    @property
    def program(self):  # a shared object
        return self.build / "lessons" / f"{self.name}.so"

    @property
    def exercises(self):
        return EXERCISE.findall((ROOT / "tests" / "lessons" / f"{self.number}_check.cpp").read_text())


def answers_of(lesson, kind, build):
    name = {"exercises": "check", "solutions": "checked"}[kind] + "-" + lesson.name[:2]
    return Answers(lesson, ROOT / "src" / "lessons" / kind / f"{lesson.name[:2]}.cpp", lesson / kind, build, name)


# ------------------------------------------------------------------------------------------------- one exercise

def bench(folder, answers):
    """A folder that has of the checkout what an exercise may read; the copy is the answer's to spoil."""
    (folder / "inputs" / "meshes").mkdir(parents=True)
    for name in MESHES:
        shutil.copy2(ROOT / "inputs" / "meshes" / name, folder / "inputs" / "meshes")
    lesson = folder / "inputs" / "lessons" / answers.lesson.name
    shutil.copytree(answers.lesson, lesson, ignore=shutil.ignore_patterns("exercises", "solutions"))
    decks = lesson / "answers"
    shutil.copytree(answers.decks, decks) if answers.decks.is_dir() else decks.mkdir()
    (folder / "outputs").mkdir()
    return decks.relative_to(folder)


def contents(folder):
    """Files that belong to the exercise, and when they were written."""
    return {path.relative_to(folder): path.stat().st_mtime_ns for path in folder.rglob("*")
            if path.is_file() and "outputs" not in path.relative_to(folder).parts[:1]}


def ending(code, limits, used):
    """How a program ended that should have given a verdict; used: seconds of processor time."""
    if code is None:  # on a busy machine a loop may get less than its share
        return (f"is not done after {4 * limits.seconds} s: is there a loop that does not end?"
                if used > limits.seconds / 10 else f"still waits after {4 * limits.seconds} s")
    if code >= 0:
        return f"ends the whole program, with exit code {code}, instead of returning"
    name = signal.Signals(-code).name
    if name == "SIGXCPU" or (name == "SIGKILL" and used >= 0.7 * limits.seconds):
        return f"takes more than {limits.seconds} s: is there a loop that does not end?"
    if name == "SIGXFSZ":
        return f"prints or writes more than {limits.output} MB: is there a loop that does not end?"
    if name == "SIGKILL":
        return "is killed: does it ask for too much memory, or end itself?"
    hint = {"SIGSEGV": ": an index out of range, or a function that calls itself without end?",
            "SIGFPE": ": an integer division by zero?", "SIGABRT": ": a failed assertion, or an index out of range?"}
    return f"crashes ({name}){hint.get(name, '')}"


def bounds(limits, memory=False):
    """What a program with answers may use. Judges limit memory themselves: sanitizers reserve terabytes."""
    found = [(resource.RLIMIT_CPU, limits.seconds), (resource.RLIMIT_FSIZE, limits.output * MEGABYTE),
             (resource.RLIMIT_CORE, 0)]
    if memory and sys.platform == "linux":
        found.append((resource.RLIMIT_AS, limits.memory * MEGABYTE))
    return found


def sentence(verdict, printed, compiled, limits):
    """The judge's verdict in words for the student."""
    said = re.fullmatch(r"(absent|missing|late|ended) (-?[\w.:]{1,40})", verdict)
    kind, rest = said.groups() if said else ("", "")
    if kind == "absent" and rest in map(str, range(len(compiled.absent))):
        return compiled.absent[int(rest)]
    if kind == "missing":
        return compiled.missing.get(rest, f"there is no function {rest}, or one with other arguments")
    if kind == "late":
        return ending(None, limits, float(rest))
    if kind == "ended":
        return found_by_sanitizers(printed) or ending(int(rest), limits, 0)
    return verdict


def found_by_sanitizers(printed):
    """What they say in one line, or ""."""
    place = re.search(r"<stdin>:(\d+)", printed)
    line = f", line {place[1]}" if place else ""
    if found := re.search(r"<stdin>:\d+:\d+: runtime error: (.*)", printed):
        return f"does what C++ does not define{line}: {found[1]}"
    if found := re.search(r"Assertion '(.*)' failed", printed):
        return f"crashes: the assertion {found[1]} of the standard library does not hold: an index out of range?"
    found = re.search(r"ERROR: AddressSanitizer:? ([\w-]+(?: [\w-]+)*)", printed)
    if not found:
        return ""
    if "memory" in found[1] or "allocat" in found[1]:
        return "asks for more memory than it can have"
    access = re.search(r"(READ|WRITE) of size", printed)
    what = {"READ": "reads", "WRITE": "writes"}[access[1]] if access else "misuses"
    return f"{what} memory that is not its own, {found[1].split(' on ')[0]}{line}: an index out of range?"


def processor_time():
    """Of all programs that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def check_one(answers, number, limits, compiled):
    """(message, what it printed)"""
    with tempfile.TemporaryDirectory(prefix="almesh-answer-") as outside:
        folder, verdict, log = Path(outside) / "checkout", Path(outside) / "verdict", Path(outside) / "printed"
        folder.mkdir()
        decks = bench(folder, answers)
        before, begun = contents(folder), processor_time()
        with log.open("wb") as output:
            code = run([judge(answers.number, answers.build), decks, number, verdict, answers.program,
                        str(limits.seconds), str(limits.memory)], folder, 5 * limits.seconds, bounds(limits), output)
        printed = text_of(log)
        said = text_of(verdict) if verdict.is_file() else ""
        if code not in (0, 1) or (code == 1 and not said):
            return f"the judge of this exercise {ending(code, limits, processor_time() - begun)}", printed
        after = contents(folder)
        touched = sorted(str(path) for path in before.keys() | after.keys() if before.get(path) != after.get(path))
        if touched:
            return f"writes or removes {touched[0]}: an answer returns its result and touches no files", printed
        message = sentence(said, printed, compiled, limits) if code == 1 else said
        return message.replace(f"{decks}/", f"{shown(answers.decks)}/"), printed


def check(answers, limits=Limits(), numbers=None):
    """A row for each exercise, or for those in `numbers`, whatever the answers do."""
    compiled = compile_answers(answers.source, answers.number, answers.build, answers.program, limits.compilation)
    rows = []
    for number, title in answers.exercises:
        if numbers is not None and number not in numbers:
            continue
        message, printed = (compiled.failure, "") if compiled.failure else check_one(answers, number, limits, compiled)
        printed = printed.replace("<stdin>", str(shown(answers.source)))  # as the compiler was given it
        rows.append(Row(number, title, " ".join(message.split())[:1000], printed))
    if numbers is None and answers.number == OWN_ALMESH[0][:2] and answers.source.is_relative_to(ROOT):
        import own  # which checks answers itself
        message = own.grade(answers.source.parent.name, answers.build)
        rows.append(Row(*OWN_ALMESH, " ".join(message.split())[:1000]))
    return rows


# ------------------------------------------------------------------------------------------------- tables

def before_report(printed):
    """What an answer has printed without what a sanitizer says of it: its row does."""
    return re.split(r"^(?:=+\n==\d+==|\S+:\d+:\d+: runtime error)", printed, maxsplit=1, flags=re.MULTILINE)[0]


def show(rows):
    said = ""
    for row in rows:
        print(f"  {row.number:<5} {row.title:<50} {'holds' if row.holds else 'does not hold yet'}")
        if not row.holds:
            print(f"        {row.message}" if row.message != said else "        (as above)")
            for line in before_report(row.printed).splitlines()[:10]:
                print(f"        it printed: {line[:100]}")
        said = row.message
    print(f"{sum(row.holds for row in rows)} of {len(rows)} answers hold", flush=True)


def show_one(answers, k):
    """All that the answer to the lesson's exercise k prints, and whether it holds."""
    rows = check(answers, numbers=[f"{int(answers.number)}.{k.split('.')[-1]}"])
    if not rows:
        sys.exit(f"lesson {answers.number} has no exercise {k}: SHOW=1 to {len(answers.exercises)}")
    printed = rows[0].printed or "(it prints nothing)\n"
    print(printed, end="" if printed.endswith("\n") else "\n", flush=True)
    show([replace(rows[0], printed="")])
    return 0 if rows[0].holds else 1


def watch(answers, rounds=None):
    """Checks the answers now and whenever one of their files has been saved, `rounds` times in all; None: for ever."""
    seen = None
    while rounds != 0:
        files = [answers.source, *answers.decks.glob("*.deck")]
        now = {path: path.stat().st_mtime_ns for path in files if path.exists()}
        if now == seen:
            time.sleep(0.3)
            continue
        seen, rounds = now, rounds and rounds - 1
        print(f"\n{time.strftime('%H:%M:%S')}  {shown(answers.source)}")
        rows = check(answers)
        show(rows)
        left = [row.number for row in rows if not row.holds]
        print(f"next: {left[0]}; a hint: make hint-{answers.number}-{left[0].split('.')[1]}" if left else
              "all done: on to the next lesson", flush=True)


def write(path, rows):
    """All of the table or nothing: a reader never finds half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(".unfinished")
    with unfinished.open("w", newline="") as file:
        csv.writer(file).writerows([["lesson", "number", "exercise", "holds", "message"], *rows])
    unfinished.replace(path)


def changed_header(lesson, root=ROOT):
    """A reason where the header of the exercises is not the committed one: answers may include what it includes."""
    name = f"src/lessons/exercises/{lesson.name[:2]}.hpp"
    done = subprocess.run(["git", "status", "--porcelain", "--", name], cwd=root, text=True, capture_output=True)
    return f"{name} is not the course's: {back(name)}" if done.returncode == 0 and done.stdout else ""


def table(kind, build):
    rows = []
    for lesson in LESSONS:
        found, reason = check(answers_of(lesson, kind, build)), changed_header(lesson)
        found = [replace(row, message=reason) for row in found] if reason else found
        rows += [[lesson.name, row.number, row.title, "yes" if row.holds else "no", row.message] for row in found]
        marks = " ".join(f"{row.number}{'+' if row.holds else '-'}" for row in found)
        print(f"{lesson.name:<16} {sum(row.holds for row in found):>2} of {len(found):>2}   {marks}", flush=True)
    held = sum(row[3] == "yes" for row in rows)
    print(f"{'all':<16} {held:>2} of {len(rows):>2}   make check-lesson-NN says what a wrong one shows")
    write(ROOT / "outputs" / "lessons" / "answers.csv", rows)
    return 0 if held == len(rows) else 1


def is_template(lesson):
    """Whether the lesson's exercises are as they were: a student's answers are not for the self-test."""
    number = lesson.name[:2]
    changed = subprocess.run(["git", "status", "--porcelain", "--", f"src/lessons/exercises/{number}.cpp",
                              lesson / "exercises"], cwd=ROOT, text=True, capture_output=True)
    return changed.returncode != 0 or not changed.stdout


def solution_and_template(lesson, build):
    return [check(answers_of(lesson, kind, build)) for kind in ("solutions", "exercises")]


def self_test(build):
    os.environ.setdefault("SEED", "1")
    failures, count = [], 0
    sanitizers(build)  # before each process tries which there are
    with ProcessPoolExecutor(min(4, os.cpu_count() or 1)) as pool:
        checked = list(pool.map(solution_and_template, LESSONS, [build] * len(LESSONS)))
    for lesson, (solved, template) in zip(LESSONS, checked):
        count += len(solved)
        failures += [f"{row.number} {row.title}: the solution does not hold: {row.message}" for row in solved
                     if not row.holds]
        failures += [f"{row.number} {row.title}: the template holds as it is, or fails without a word"
                     for row in template if is_template(lesson) and len(row.message) < 10]
        failures += [f"{row.number} {row.title}: the template does not have what the header declares: {row.message}"
                     for row in template if is_template(lesson) and "there is no function" in row.message]
    print(f"{count} exercises: " + (f"{len(failures)} FAILURES" if failures else
                                    "every solution holds, every template fails with a message"))
    print("\n".join(failures), file=sys.stderr, end="\n" if failures else "")
    return 1 if failures else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("--lesson")
    parser.add_argument("--watch", action="store_true")
    parser.add_argument("--show", metavar="K")
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("--names", metavar="NN", help="what registry.cpp lists of a lesson")
    parser.add_argument("answers", nargs="?", choices=("exercises", "solutions"), default="exercises")
    options = parser.parse_args()
    build = (ROOT / options.build).resolve()
    if options.names:
        print(names_of_answers(options.names))
        return 0
    if options.self_test:
        return self_test(build)
    if not options.lesson:
        return table(options.answers, build)
    lesson = next((lesson for lesson in LESSONS if lesson.name.startswith(options.lesson)), None)
    if lesson is None:
        sys.exit(f"there is no lesson {options.lesson}: 01 to {len(LESSONS)}")
    if options.watch:
        try:
            return watch(answers_of(lesson, options.answers, build))
        except KeyboardInterrupt:
            return 0
    answers = answers_of(lesson, options.answers, build)
    if options.show:
        return show_one(answers, options.show)
    rows = check(answers)
    show(rows)
    return 0 if all(row.holds for row in rows) else 1


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # `| head` is no error
    sys.exit(main())

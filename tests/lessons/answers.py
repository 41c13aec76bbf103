#!/usr/bin/env python3
"""Checks the answers to all exercises of the course.

  tests/lessons/answers.py [--build FOLDER] [exercises | solutions]   a table, and outputs/lessons/answers.csv
  tests/lessons/answers.py [--build FOLDER] --self-test               the checks themselves: each solution holds, and
                                                                      no template does, and says why

The programs build/lessons/check-NN and solved-NN are made by `make check-lessons` and `make lessons`. Exit code 1 where an
answer does not hold, or the self-test fails. Standard library only.
"""
import argparse
import csv
import io
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
LESSONS = sorted((ROOT / "inputs" / "lessons").glob("[0-9][0-9]-*"))
PROGRAM = {"exercises": "check", "solutions": "solved"}


def check(lesson, answers, build):
    """Rows [number, title, "yes" or "no", message]."""
    program = ROOT / build / "lessons" / f"{PROGRAM[answers]}-{lesson.name[:2]}"
    if not (ROOT / "tests" / "lessons" / f"{lesson.name[:2]}_check.cpp").exists():
        return []
    done = subprocess.run([program, lesson.relative_to(ROOT) / answers, "--csv"], cwd=ROOT, text=True,
                          stdout=subprocess.PIPE, timeout=120)
    if done.returncode not in (0, 1):
        sys.exit(f"{program} ended with exit code {done.returncode}")
    return list(csv.reader(io.StringIO(done.stdout)))


def table(answers, build):
    rows = []
    for lesson in LESSONS:
        found = check(lesson, answers, build)
        rows += [[lesson.name, *row] for row in found]
        marks = " ".join(f"{number}{'+' if holds == 'yes' else '-'}" for number, _, holds, _ in found)
        print(f"{lesson.name:<16} {sum(row[2] == 'yes' for row in found):>2} of {len(found):>2}   {marks}", flush=True)
    held = sum(row[3] == "yes" for row in rows)
    print(f"{'all':<16} {held:>2} of {len(rows):>2}   make check-lesson-NN says what a wrong one shows")
    path = ROOT / "outputs" / "lessons" / "answers.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([["lesson", "number", "exercise", "holds", "message"], *rows])
    return 0 if held == len(rows) else 1


def is_template(lesson):
    """Whether nothing has been written into the lesson's exercises yet: a student's answers are not for the self-test."""
    number = lesson.name[:2]
    changed = subprocess.run(["git", "status", "--porcelain", "--", f"src/lessons/exercises/{number}.cpp",
                              lesson / "exercises"], cwd=ROOT, text=True, capture_output=True)
    return changed.returncode != 0 or not changed.stdout


def self_test(build):
    failures, count = [], 0
    for lesson in LESSONS:
        solved, template = (check(lesson, answers, build) for answers in ("solutions", "exercises"))
        count += len(solved)
        failures += [f"{number} {title}: the solution does not hold: {message}"
                     for number, title, holds, message in solved if holds != "yes"]
        failures += [f"{number} {title}: the template holds as it is, or fails without a word"
                     for number, title, holds, message in template
                     if is_template(lesson) and (holds == "yes" or len(message) < 10)]
    print(f"{count} exercises: " + (f"{len(failures)} FAILURES" if failures else
                                    "every solution holds, every template fails with a message"))
    print("\n".join(failures), file=sys.stderr, end="\n" if failures else "")
    return 1 if failures else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("answers", nargs="?", choices=PROGRAM, default="exercises")
    options = parser.parse_args()
    return self_test(options.build) if options.self_test else table(options.answers, options.build)


if __name__ == "__main__":
    sys.exit(main())

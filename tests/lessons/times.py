#!/usr/bin/env python3
"""How long a lesson takes, estimated from what is in its handout: a table; with a folder of a build the seconds that
its commands take here, too.

  tests/lessons/times.py [--build FOLDER]   the table
  tests/lessons/times.py --check            whether the handouts' lines "Time." agree with it to ten minutes

Nobody was timed. Counted are the words in front of the exercises, without programs and outputs; the commands shown; the
exercises but for the last, which says itself that it takes an hour, and what they ask for besides: "3.1, too" in the
header of the lesson. Assumed are the five numbers below: a text with formulas is read with a pen in the hand, about a
fifth as fast as a novel. Standard library only.
"""
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
WORDS_A_MINUTE = 50
MINUTES_A_COMMAND, MINUTES_TO_PREDICT, MINUTES_AN_EXERCISE, MINUTES_BESIDES = 1.5, 3, 12, 5
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.M | re.S)
BESIDES = re.compile(r"^// \d+\.[1-5], too", re.M)
CLAIM = re.compile(r"\*\*Time\.\*\* (\d+) minutes: (\d+) to read and run, (\d+) for the exercises")


def rounded(minutes):
    return 5 * round(minutes / 5)


def counts(path):
    """(words, commands, exercises, what these ask for besides) of a handout."""
    handout, number = path.read_text(), path.parent.name[:2]
    besides = BESIDES.findall((ROOT / "src" / "lessons" / "exercises" / f"{number}.hpp").read_text())
    commands = sum(len(re.findall(r"^\$ ", block, re.M)) for kind, block in BLOCK.findall(handout) if kind == "console")
    lesson, exercises = BLOCK.sub("", handout).split("\n## Exercises", 1)
    return len(lesson.split()), commands, len(re.findall(r"^[1-5]\. ", exercises.split("\n## ")[0], re.M)), len(besides)


def minutes(words, commands, exercises, besides):
    """(to read and run, for the exercises)."""
    return (rounded(words / WORDS_A_MINUTE + MINUTES_A_COMMAND * commands + MINUTES_TO_PREDICT),
            rounded(MINUTES_AN_EXERCISE * exercises + MINUTES_BESIDES * besides))


def seconds(build, number):
    start = time.monotonic()
    subprocess.run([ROOT / "tests" / "documents.py", "--build", build, "--show", number], check=True,
                   stdout=subprocess.DEVNULL)
    return time.monotonic() - start


def table(handouts, build):
    head = ["Lesson", "Words", "Commands", "Exercises", "Besides", "Read and run", "Solve", "In all"]
    head += ["time to run"] if build else []
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for path in handouts:
        counted = counts(path)
        read, solve = minutes(*counted)
        row = [path.parent.name[:2], *counted, f"{read} min", f"{solve} min", f"{read + solve} min"]
        print("| " + " | ".join(map(str, row)) + " |" + (f" {seconds(build, row[0]):.0f} s |" if build else ""))


def check(handouts):
    wrong = 0
    for path in handouts:
        claim = CLAIM.search(path.read_text())
        if not claim:
            continue
        read, solve = minutes(*counts(path))
        said = [int(number) for number in claim.groups()]
        if said[0] != said[1] + said[2] or abs(said[1] - read) > 10 or abs(said[2] - solve) > 10:
            wrong += 1
            print(f"{path.relative_to(ROOT)}: it says {said[0]} minutes, {said[1]} and {said[2]}; "
                  f"counted: {read + solve} minutes, {read} and {solve}")
    return 1 if wrong else 0


def main(words):
    handouts = sorted((ROOT / "inputs" / "lessons").glob("[0-9]*/README.md"))
    if words == ["--check"]:
        return check(handouts)
    if words and (len(words) != 2 or words[0] != "--build"):
        sys.exit("usage: times.py [--build FOLDER] or times.py --check")
    table(handouts, Path(words[1]).resolve() if words else None)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

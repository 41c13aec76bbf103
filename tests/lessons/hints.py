#!/usr/bin/env python3
"""Hints for the exercises of the course, two for each in hints.txt: a nudge, and nearly the answer.

  tests/lessons/hints.py 04-2 [--more]   the first hint for exercise 4.2; --more: and the second
  tests/lessons/hints.py --self-test     whether each exercise has its two

Standard library only.
"""
import re
import signal
import sys
import textwrap
from pathlib import Path

from answers import EXERCISE, OWN_ALMESH, ROOT

HINTS = Path(__file__).resolve().parent / "hints.txt"


def hints():
    """{exercise: its hints}"""
    blocks = [[line for line in block.split("\n") if line and not line.startswith("#")]
              for block in re.split(r"\n\s*\n", HINTS.read_text())]
    return {block[0]: block[1:] for block in blocks if block}


def self_test():
    exercises = {number for check in (ROOT / "tests" / "lessons").glob("*_check.cpp")
                 for number, _ in EXERCISE.findall(check.read_text())} | {OWN_ALMESH[0]}
    found = hints()
    failures = [f"{number} is no exercise" for number in found if number not in exercises]
    failures += [f"{number} has {len(found.get(number, []))} hints, not two" for number in sorted(exercises)
                 if len(found.get(number, [])) != 2]
    print("\n".join(failures) if failures else f"{len(exercises)} exercises: each has two hints")
    return 1 if failures else 0


def main(words):
    if words == ["--self-test"]:
        return self_test()
    named = re.fullmatch(r"0*(\d+)-(\d+)", words[0]) if words else None
    found = hints().get(f"{named[1]}.{named[2]}") if named else None
    if not found:
        sys.exit("there is no such exercise: `make hint-04-2` is a hint for exercise 4.2")
    for hint in found if "--more" in words else found[:1]:
        print(textwrap.fill(hint, 100, initial_indent="  ", subsequent_indent="  "))
    if "--more" not in words:
        print(f"(nearly the answer: make hint-{words[0]} MORE=1)")
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # `| head` is no error
    sys.exit(main(sys.argv[1:]))

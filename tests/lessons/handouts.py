#!/usr/bin/env python3
"""Runs every command of the handouts, inputs/lessons/NN-name/README.md, and compares what it prints with what the
handout shows.

  tests/lessons/handouts.py [--build FOLDER] [NN ...]           compare; all lessons where none is named
  tests/lessons/handouts.py [--build FOLDER] --show NN [...]    only run, and print what the commands print
  tests/lessons/handouts.py [--build FOLDER] --update NN [...]  put what they print into the handout: read it then

A handout's blocks ```console hold commands (`$ ` first) and their output. A line `...` stands for any lines. Words are
compared one by one:

  times (a number before or with `s` or `ms`), memory (`MB`, `GB`), `threads`   not compared
  integers                                                                      equal
  numbers of magnitude 1e-6 and more                                            to 1 %, or half a unit of the last digit
  smaller ones                                                                  to a factor of 10; below 1e-12 all equal

Every line of a block ```cpp must be in the lesson's program or in its exercises, one after the other: code that is
shown is code that runs. `build/` and `./almesh` are those of --build. Exit code 1 where something differs. Standard
library only.
"""
import argparse
import concurrent.futures
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
LESSONS = ROOT / "inputs" / "lessons"
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
TIMES = re.compile(r"\b\d[\d.e+-]*\s?(ms|s|MB|GB|threads?)\b")
SECONDS = 120  # of one command


def blocks(text, language):
    """(first line, lines) of every block of the language."""
    lines, found, start = text.split("\n"), [], None
    for i, line in enumerate(lines):
        if line.startswith("```"):
            if start is not None:
                if lines[start - 1].strip() == "```" + language:
                    found.append((start, lines[start:i]))
                start = None
            else:
                start = i + 1
    return found


def commands(lines):
    """(command, place of its first line of output, lines of output) of a console block."""
    starts = [i for i, line in enumerate(lines) if line.startswith("$ ")]
    return [(lines[i][2:], i + 1, lines[i + 1:end]) for i, end in zip(starts, starts[1:] + [len(lines)])]


def run(command, build):
    """What it prints (both streams); what went wrong, or ""."""
    actual = re.sub(r"(?<![\w/])\./almesh\b", f"{build}/almesh", re.sub(r"(?<![\w./])build/", f"{build}/", command))
    try:
        done = subprocess.run(actual, shell=True, cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return "", f"took more than {SECONDS} s"
    text = done.stdout.replace(f"{build}/almesh", "./almesh").replace(f"{build}/", "build/")
    ended = f"ended with exit code {done.returncode} (show it: `; echo exit code $?`)"
    return text, "" if done.returncode == 0 else ended


def near(a, b):
    """Whether the words are the same or numbers that are near enough."""
    numbers_a, numbers_b = list(NUMBER.finditer(a)), list(NUMBER.finditer(b))
    if a == b:
        return True
    if not numbers_a or len(numbers_a) != len(numbers_b) or NUMBER.sub("#", a) != NUMBER.sub("#", b):
        return False
    return all(near_numbers(x.group(), y.group()) for x, y in zip(numbers_a, numbers_b))


def near_numbers(a, b):
    if re.fullmatch(r"[-+]?\d+", a) and re.fullmatch(r"[-+]?\d+", b):
        return int(a) == int(b)
    x, y = float(a), float(b)
    if max(abs(x), abs(y)) < 1e-12:
        return True
    if max(abs(x), abs(y)) < 1e-6:
        return x * y > 0 and 0.1 <= x / y <= 10
    return abs(x - y) <= 0.01 * max(abs(x), abs(y)) or abs(x - y) <= 1.01 * last_digit(a)


def last_digit(text):
    """Half a unit of the last digit that is shown."""
    mantissa, _, exponent = text.lower().partition("e")
    return 0.5 * 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def same_line(shown, printed):
    shown, printed = TIMES.sub("TIME", shown).split(), TIMES.sub("TIME", printed).split()
    return len(shown) == len(printed) and all(map(near, shown, printed))


def first_difference(shown, printed):
    """None, or (line of shown, text of printed there). `...` in shown matches any lines, also none."""
    if not shown:
        return None if not printed else (0, printed[0])
    if shown[0].strip() == "...":
        if any(first_difference(shown[1:], printed[i:]) is None for i in range(len(printed) + 1)):
            return None
        after = next((i for i, line in enumerate(printed) if shown[1:] and same_line(shown[1], line)), len(printed))
        where, text = first_difference(shown[1:], printed[after:])
        return where + 1, text
    if not printed:
        return 0, "(nothing more)"
    if not same_line(shown[0], printed[0]):
        return 0, printed[0]
    rest = first_difference(shown[1:], printed[1:])
    return rest and (rest[0] + 1, rest[1])


def trimmed(lines):
    """Without blank lines at the end."""
    lines = [line.rstrip() for line in lines]
    while lines and not lines[-1]:
        lines.pop()
    return lines


def contains(source, lines):
    """Whether the lines stand in the source one after the other, apart from blanks around them."""
    source, lines = [line.strip() for line in source.split("\n")], [line.strip() for line in trimmed(lines)]
    return any(source[i:i + len(lines)] == lines for i in range(len(source) - len(lines) + 1))


def check_code(handout, text):
    number = handout.parent.name[:2]
    sources = [*ROOT.glob(f"src/lessons/{number}_*.cpp"), *ROOT.glob(f"src/lessons/exercises/{number}.*")]
    return [f"{handout.relative_to(ROOT)}:{start + 1}: this code is neither in the lesson's program nor its exercises"
            for start, lines in blocks(text, "cpp")
            if not any(contains(path.read_text(), lines) for path in sources)]


def compare(handout, build):
    """Differences, as texts."""
    text = handout.read_text()
    differences = check_code(handout, text)
    for start, lines in blocks(text, "console"):
        for command, first, shown in commands(lines):
            printed, failure = run(command, build)
            place = f"{handout.relative_to(ROOT)}:{start + first}: {command}"
            if failure:
                differences.append(f"{place}\n    {failure}\n{printed[-2000:]}")
                continue
            difference = first_difference(trimmed(shown), trimmed(printed.split("\n")))
            if difference:
                line, got = difference
                there = trimmed(shown)[line] if line < len(trimmed(shown)) else "(nothing more)"
                differences.append(f"{place}\n    line {start + first + 1 + line} shows  {there}\n"
                                   f"    the program prints  {got}")
    return differences


def update(handout, build):
    """Puts what the commands print in place of what is shown, unless that has a line `...`."""
    lines = handout.read_text().split("\n")
    for start, block in reversed(blocks("\n".join(lines), "console")):
        for command, first, shown in reversed(commands(block)):
            if any(line.strip() == "..." for line in shown):
                continue
            printed, failure = run(command, build)
            if failure:
                print(f"{command}: {failure}", file=sys.stderr)
            lines[start + first:start + first + len(shown)] = trimmed(printed.split("\n"))
    handout.write_text("\n".join(lines))


def show(handout, build):
    for _, lines in blocks(handout.read_text(), "console"):
        for command, _, _ in commands(lines):
            printed, failure = run(command, build)
            print(f"$ {command}\n{printed}{failure}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("--show", action="store_true")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("lesson", nargs="*")
    options = parser.parse_args()
    handouts = [path for path in sorted(LESSONS.glob("[0-9][0-9]-*/README.md"))
                if not options.lesson or path.parent.name[:2] in options.lesson]
    if not handouts:
        sys.exit("no such lesson")
    if options.show or options.update:
        for handout in handouts:
            (show if options.show else update)(handout, options.build)
        return 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda handout: compare(handout, options.build), handouts))
    for handout, differences in zip(handouts, results):
        count = sum(len(commands(lines)) for _, lines in blocks(handout.read_text(), "console"))
        print(f"{handout.parent.name:<16} {count:>3} commands  {'as shown' if not differences else 'DIFFERS'}")
    for difference in sum(results, []):
        print(difference, file=sys.stderr)
    return 1 if any(results) else 0


if __name__ == "__main__":
    sys.exit(main())

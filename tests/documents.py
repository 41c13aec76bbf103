#!/usr/bin/env python3
"""Runs every command that the project's documents show and compares what it prints with what the document shows. The
documents are README.md, the README.md of each folder, the pages inputs/*.md, and the handouts,
inputs/lessons/NN-name/README.md.

  tests/documents.py [--build FOLDER] [DOCUMENT ...]        compare; all documents where none is named (NN: a handout)
  tests/documents.py [--build FOLDER] --slow [DOCUMENT ...] compare, also the blocks that are marked as slow
  tests/documents.py [--build FOLDER] --show NN [...]       only run, and print what the commands print
  tests/documents.py [--build FOLDER] --update DOCUMENT     put what they print into the document: read it then
  tests/documents.py --self-test                            whether a stale number, a failing command, ... are noticed

Blocks ```console hold commands (`$ ` first) and their output. A line `...` stands for any lines. Words are compared one
by one:

  times (a number before or with `s` or `ms`), memory (`MB`, `GB`), `threads`   not compared
  integers                                                                      equal
  other numbers                                                                 to a unit of the last digit shown
  those below 1e-12, which are made of rounding errors                          all equal

Comments in the lines above a block or a table, which a reader does not see, say how it is checked:

  <!-- slow -->            runs with --slow only, in the checkout itself
  <!-- before: COMMAND --> is run before the block
  <!-- file: NAME -->      the block is the contents of this file
  <!-- needs: COMMAND -->  the block is left out, with a message, where this command fails
  <!-- within: 2 % -->     numbers of the block that are no integers may differ by so much; for rounding that grows
  <!-- table: COMMAND -->  prints the table below; columns named `time ...` or `share ...` are left out
  <!-- in: FILE before: TEXT -->   the block ```cpp below goes into this file of a copy of the source, before the line
                                   with this text
  <!-- edit: FILE: OLD => NEW -->  this change is made in the copy
  <!-- in the copy -->     the block ```console below runs in the copy, built with what was put into it (with --slow)

The commands of a README that are not slow run in a folder of their own with links to the checkout, so that they leave
nothing behind; its path is shown as /home/you/almesh. There `paraview FILE` only sees that the file is one of VTK's. The
commands of a handout run in the checkout.

Every line of a block ```cpp of a handout must be in the lesson's program or its exercises, one after the other. Files
that a README names must exist, and what every document refers to: links with their anchors, sections by name (the
README of src/, "A density"), sections, lessons and exercises by number. `build/` and `./almesh` are those of --build.
Exit code 1 where something differs. Standard library only.
"""
import argparse
import concurrent.futures
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LESSONS = ROOT / "inputs" / "lessons"
FOLDERS = ("inputs/lessons", "outputs", "src", "tests", "plot")
PAGES = [*sorted((ROOT / "inputs").glob("*.md")), *sorted(LESSONS.glob("[a-z]*.md")),
         *(ROOT / folder / "README.md" for folder in FOLDERS)]
READMES = [ROOT / "README.md", *PAGES]
SHOWN_ROOT = "/home/you/almesh"
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
INTEGER = re.compile(r"[-+]?\d+")
TIMES = re.compile(r"\b\d[\d.e+-]*\s?(ms|s|MB|GB|threads?)\b")
COMMENT = re.compile(r"<!-- (.*) -->")
FILE_NAME = re.compile(r"`((?:[\w.-]+/)*[\w-]+\.(?:cpp|hpp|py|deck|msh|md|geo|csv|txt|sh|png))`")
LINK = re.compile(r"\]\(([^)\s]+)\)")
BY_NAME = re.compile(r"((?:[\w./-]+/)?(?:README|\w[\w-]*\.md)(?:\.md)?)`?[^\".]{0,60} \"([A-Z][^\"]+)\""
                     r"(?: and \"([^\"]+)\")?")
BY_TOPIC = re.compile(r"README(?:\.md)?`?'s section on \w+")
SECTION_OF_LESSON = re.compile(r"section (\d+) of lesson (\d+)|lesson (\d+), section (\d+)")
OF_LESSON = re.compile(r"\b[Ll]essons? (\d+)(?:(?:,| to| and) (\d+))*")
EXERCISE = re.compile(r"\b[Ee]xercises? (\d+)\.(\d+)\b")
NOT_COMPARED = re.compile(r"(time|share)\b")  # at the beginning of a column's name
SECONDS, SLOW_SECONDS = 120, 7200  # of one command


# ------------------------------------------------------------------------------------------------- parts of a document

@dataclass
class Block:
    """Lines of a document: `kind` is the language of a fenced block, or `table`; `start` the index of its first line."""
    kind: str
    start: int
    lines: list
    marks: list = field(default_factory=list)

    def values(self, name):
        """What the comments above say after `name: `."""
        return [mark[len(name) + 2:] for mark in self.marks if mark.startswith(name + ": ")]

    @property
    def within(self):
        """The relative difference that its numbers may have."""
        return max([float(value.removesuffix(" %")) / 100 for value in self.values("within")], default=0.0)

    @property
    def slow(self):
        return "slow" in self.marks or "in the copy" in self.marks


def blocks_of(text):
    """All blocks, in order, each with the comments in the lines above it."""
    lines, found, marks, i = text.split("\n"), [], [], 0
    while i < len(lines):
        line, kind, end = lines[i].strip(), None, i
        if line.startswith("```"):
            kind, start = line[3:], i + 1
            end = next((j for j in range(start, len(lines)) if lines[j].strip() == "```"), len(lines))
        elif line.startswith("|"):
            kind, start = "table", i
            end = next((j for j in range(start, len(lines)) if not lines[j].strip().startswith("|")), len(lines))
        if kind is not None:
            found.append(Block(kind, start, lines[start:end], marks))
            i, marks = (end if kind == "table" else end + 1), []
            continue
        comment = COMMENT.fullmatch(line)
        marks = [*marks, comment.group(1)] if comment else marks if not line else []
        i += 1
    return found


def commands(lines):
    """(command, place of its first line of output, lines of output) of a console block."""
    starts = [i for i, line in enumerate(lines) if line.startswith("$ ")]
    return [(lines[i][2:], i + 1, lines[i + 1:end]) for i, end in zip(starts, starts[1:] + [len(lines)])]


# ------------------------------------------------------------------------------------------------- running commands

class Checkout:
    """Runs commands in the checkout."""

    def __init__(self, build, seconds=SECONDS):
        self.build, self.seconds = build, seconds

    def run(self, command):
        """What it prints (both streams); what went wrong, or ""."""
        actual = re.sub(r"(?<![\w/])\./almesh\b", f"{self.build}/almesh",
                        re.sub(r"(?<![\w./])build/", f"{self.build}/", command))
        text, failure = run_in(ROOT, actual, self.seconds)
        return text.replace(f"{self.build}/almesh", "./almesh").replace(f"{self.build}/", "build/"), failure


class Scratch:
    """Runs commands in a folder of its own that looks like a checkout in which nothing has been run."""

    def __init__(self, build):
        self.folder = Path(tempfile.mkdtemp(prefix="almesh-documents-")).resolve()
        for entry in ROOT.iterdir():
            if not entry.name.startswith((".", "build", "outputs", "almesh")):
                (self.folder / entry.name).symlink_to(entry)
        (self.folder / "almesh").symlink_to(ROOT / build / "almesh")
        (self.folder / "build").symlink_to(ROOT / build)
        (self.folder / "outputs").mkdir()

    def run(self, command):
        text, failure = run_in(self.folder, re.sub(r"^paraview ", "grep -qa 'vtk DataFile' ", command), SECONDS)
        return text.replace(str(self.folder), SHOWN_ROOT), failure

    def write(self, name, lines):
        (self.folder / name).write_text("\n".join(lines) + "\n")

    def remove(self):
        shutil.rmtree(self.folder)


class Copy:
    """A copy of the checkout, into which a document's examples are put; built when a command is first run in it."""

    def __init__(self, build):
        self.folder = Path(tempfile.mkdtemp(prefix="almesh-examples-")).resolve()
        for entry in ("src", "tests", "inputs"):
            shutil.copytree(ROOT / entry, self.folder / entry)
        shutil.copy2(ROOT / "Makefile", self.folder)
        shutil.copytree(ROOT / build, self.folder / build)
        (self.folder / "outputs").mkdir()
        self.build, self.built = build, False

    def insert(self, file, anchor, lines):
        """"" or what went wrong."""
        path = self.folder / file
        old = path.read_text().split("\n") if path.exists() else []
        places = [i for i, line in enumerate(old) if anchor in line]
        if len(places) != 1:
            return f"`{anchor}` is in {len(places)} lines of {file}, not in one"
        path.write_text("\n".join(old[:places[0]] + lines + old[places[0]:]))
        return ""

    def write(self, name, lines):
        (self.folder / name).write_text("\n".join(lines) + "\n")

    def edit(self, file, old, new):
        path = self.folder / file
        text = path.read_text() if path.exists() else ""
        if text.count(old) != 1:
            return f"`{old}` is {text.count(old)} times in {file}, not once"
        path.write_text(text.replace(old, new))
        return ""

    def run(self, command):
        if not self.built:
            self.built = True
            text, failure = run_in(self.folder, f"make BUILD={self.build} almesh", SLOW_SECONDS)
            if failure:
                return text, f"the copy of the source with the examples does not build: {failure}"
        return run_in(self.folder, command, SLOW_SECONDS)

    def remove(self):
        shutil.rmtree(self.folder)


def run_in(folder, command, seconds):
    # A make that a command starts is nobody's child.
    environment = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}
    for library in (Path(folder) / "build").resolve().glob("libalmesh.so.*"):
        environment["ALMESH_LIBRARY"] = str(library)  # of the module for Python
    try:
        done = subprocess.run(command, shell=True, cwd=folder, text=True, env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=seconds)
    except subprocess.TimeoutExpired:
        return "", f"took more than {seconds} s"
    ended = f"ended with exit code {done.returncode} (show it: `; echo exit code $?`)"
    return done.stdout, "" if done.returncode == 0 else ended


# ------------------------------------------------------------------------------------------------- comparing texts

def near(a, b, within=0.0):
    """Whether the words are the same or numbers that are near enough; a is the one shown."""
    numbers_a, numbers_b = list(NUMBER.finditer(a)), list(NUMBER.finditer(b))
    if a == b:
        return True
    if not numbers_a or len(numbers_a) != len(numbers_b) or NUMBER.sub("#", a) != NUMBER.sub("#", b):
        return False
    return all(near_numbers(x.group(), y.group(), within) for x, y in zip(numbers_a, numbers_b))


def near_numbers(a, b, within):
    if INTEGER.fullmatch(a) and INTEGER.fullmatch(b):
        return int(a) == int(b)
    x, y = float(a), float(b)
    if max(abs(x), abs(y)) < 1e-12:
        return True
    return abs(x - y) <= max(1.01 * last_digit(b if INTEGER.fullmatch(a) else a), within * max(abs(x), abs(y)))


def last_digit(text):
    """A unit of the last digit that is shown."""
    mantissa, _, exponent = text.lower().partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def same_line(shown, printed, within=0.0):
    shown, printed = TIMES.sub("TIME", shown).split(), TIMES.sub("TIME", printed).split()
    return len(shown) == len(printed) and all(near(a, b, within) for a, b in zip(shown, printed))


def first_difference(shown, printed, within=0.0):
    """None, or (line of shown, text of printed there). `...` in shown matches any lines, also none."""
    at = 0
    while shown[at:] and shown[at].strip() != "...":
        if at == len(printed):
            return at, "(nothing more)"
        if not same_line(shown[at], printed[at], within):
            return at, printed[at]
        at += 1
    if at == len(shown):
        return None if at == len(printed) else (at, printed[at])
    rest, shown = printed[at:], shown[at + 1:]
    starts = [i for i in range(len(rest) + 1) if not shown or i == len(rest) or same_line(shown[0], rest[i], within)]
    differences = [first_difference(shown, rest[i:], within) for i in starts]
    if not shown or None in differences:
        return None
    where, text = differences[0]
    return at + 1 + where, text


def trimmed(lines):
    """Without blank lines at the end."""
    lines = [line.rstrip() for line in lines]
    while lines and not lines[-1]:
        lines.pop()
    return lines


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def without_times(lines):
    """Rows of a table with the columns that are not compared left empty."""
    names = cells(lines[0]) if lines else []
    return [" | ".join("" if at < len(names) and i > 0 and NOT_COMPARED.match(names[at]) else cell
                       for at, cell in enumerate(cells(line))) for i, line in enumerate(lines)
            if not re.fullmatch(r"[\s|:-]+", line)]


# ------------------------------------------------------------------------------------------------- what a document names

def contains(source, lines):
    """Whether the lines stand in the source one after the other, apart from blanks around them."""
    source, lines = [line.strip() for line in source.split("\n")], [line.strip() for line in trimmed(lines)]
    return any(source[i:i + len(lines)] == lines for i in range(len(source) - len(lines) + 1))


def check_code(path, blocks):
    """Of a handout: code that is shown is code that runs."""
    number = path.parent.name[:2]
    sources = [*ROOT.glob(f"src/lessons/{number}_*.cpp"), *ROOT.glob(f"src/lessons/exercises/{number}.*")]
    return [f"{shown(path)}:{block.start + 1}: this code is neither in the lesson's program nor its exercises"
            for block in blocks
            if block.kind == "cpp" and not any(contains(source.read_text(), block.lines) for source in sources)]


def headings(text):
    return re.findall(r"^#+ (.*)$", re.sub(r"```.*?```", "", text, flags=re.DOTALL), flags=re.MULTILINE)


def anchors(text):
    """The headings of a document as GitHub makes them anchors."""
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings(text)}


def handout(number):
    return next(iter(LESSONS.glob(f"{int(number):02}-*/README.md")), None)


def check_references(path, text):
    """Links lead somewhere; sections, lessons and exercises that are named or numbered are there."""
    prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    missing = []
    for link in LINK.findall(prose):
        target, _, anchor = link.partition("#")
        to = path.parent / target if target else path
        if not link.startswith("http") and not (to.exists() and (not anchor or anchor in anchors(to.read_text()))):
            missing.append(f"the link to {link} leads nowhere")
    prose = re.sub(r"\s+", " ", prose)
    for file, *names in BY_NAME.findall(prose):
        file += "" if file.endswith(".md") else ".md"
        places = [place / file for place in (ROOT, path.parent) if (place / file).exists()]
        for name in filter(None, names):
            if not any(heading == name for place in places for heading in headings(place.read_text())):
                missing.append(f'{file} has no section "{name}"')
    missing += [f"{match}: sections are named by their titles" for match in BY_TOPIC.findall(prose)]
    for numbers in SECTION_OF_LESSON.findall(prose):
        section, lesson = numbers[:2] if numbers[0] else reversed(numbers[2:])
        to = handout(lesson)
        if not to or not any(re.match(rf"{section}\b", heading) for heading in headings(to.read_text())):
            missing.append(f"lesson {lesson} has no section {section}")
    for match in OF_LESSON.finditer(prose):
        missing += [f"there is no lesson {n}" for n in re.findall(r"\d+", match.group()) if not handout(n)]
    for lesson, exercise in EXERCISE.findall(prose):
        to = handout(lesson)
        if not to or not re.search(rf"^{exercise}\. \*\*", to.read_text().partition("## Exercises")[2], re.MULTILINE):
            missing.append(f"there is no exercise {lesson}.{exercise}")
    return [f"{shown(path)}: {what}" for what in missing]


def check_names(path, text):
    """Of a README: files that it names are there."""
    prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    missing = []
    known = {file.name for folder in ("src", "tests", "plot", "inputs") for file in (ROOT / folder).rglob("*")}
    for name in FILE_NAME.findall(prose):
        places = [ROOT, path.parent, ROOT / "src"]
        there = any((place / name).exists() for place in places) if "/" in name else name in known
        of_source = "/" in name or name.endswith((".cpp", ".hpp", ".py"))
        if of_source and not there and not name.startswith("outputs/"):
            missing.append(f"{shown(path)}: there is no file {name}")
    return missing


def shown(path):
    return path.relative_to(ROOT) if path.is_relative_to(ROOT) else path.name


# ------------------------------------------------------------------------------------------------- a document

class Document:
    """A document and the places where its commands run."""

    def __init__(self, path, build, slow):
        self.path, self.build, self.slow = path, build, slow
        self.handout = path.parent.parent == LESSONS
        self.text = path.read_text()
        self.blocks = blocks_of(self.text)
        self.scratch, self.copy = None, None
        self.checked, self.left_out, self.differences = 0, 0, []

    def place(self, block):
        if "in the copy" in block.marks:
            return self.copy
        if self.handout or block.slow:
            return Checkout(self.build, SLOW_SECONDS if block.slow else SECONDS)
        self.scratch = self.scratch or Scratch(self.build)
        return self.scratch

    def note(self, line, what, text):
        self.differences.append(f"{shown(self.path)}:{line}: {what}\n    {text}")

    def check(self):
        self.differences += check_code(self.path, self.blocks) if self.handout else check_names(self.path, self.text)
        self.differences += check_references(self.path, self.text)
        for block in self.blocks:
            self.check_block(block)
        self.close()
        return self

    def close(self):
        for folder in (self.scratch, self.copy):
            if folder:
                folder.remove()

    def check_block(self, block):
        self.check_example(block)
        if block.slow and not self.slow:
            self.left_out += 1
        elif self.prepare(block):
            for command in block.values("table"):
                self.compare_table(self.place(block), block, command)
            for command, first, lines in commands(block.lines) if block.kind == "console" else []:
                self.compare(self.place(block), block, command, first, lines)

    def prepare(self, block):
        """Does what the comments say that is done before the block; whether its commands can run here."""
        if self.slow and (block.values("edit") or block.values("in")):
            self.apply(block)
        for command in block.values("needs"):
            if self.place(block).run(command)[1]:
                print(f"{shown(self.path)}:{block.start}: left out, as `{command}` fails here")
                return False
        for name in block.values("file"):
            self.place(block).write(name, block.lines)
        for command in block.values("before"):
            self.compare(self.place(block), block, command, 0, None)
        return True

    def check_example(self, block):
        """Whether the source has the places at which examples are put into it."""
        places = [value.split(" before: ") for value in block.values("in")]
        places += [value.split(" => ")[0].split(": ", 1) for value in block.values("edit")]
        for file, text in places:
            count = (ROOT / file).read_text().count(text) if (ROOT / file).exists() else 0
            if count != 1:
                self.note(block.start, "example", f"`{text}` is {count} times in {file}, not once")

    def apply(self, block):
        """Puts an example into the copy."""
        self.copy = self.copy or Copy(self.build)
        for value in block.values("edit"):
            file, _, change = value.partition(": ")
            failure = self.copy.edit(file, *change.replace("\\n", "\n").split(" => "))
            if failure:
                self.note(block.start, "edit", failure)
        for value in block.values("in"):
            file, anchor = value.split(" before: ")
            failure = self.copy.insert(file, anchor, block.lines)
            if failure:
                self.note(block.start, "in", failure)

    def compare(self, place, block, command, first, lines):
        """Runs the command; its output is compared with the lines, where there are any to compare it with."""
        self.checked += 1
        line = block.start + first
        printed, failure = place.run(command)
        if failure:
            return self.note(line, command, f"{failure}\n{printed[-2000:]}")
        if lines is None:
            return None
        lines = trimmed(lines)
        difference = first_difference(lines, trimmed(printed.split("\n")), block.within)
        if difference:
            at, got = difference
            there = lines[at] if at < len(lines) else "(nothing more)"
            self.note(line, command, f"line {line + 1 + at} shows  {there}\n    the program prints  {got}")

    def compare_table(self, place, block, command):
        self.checked += 1
        printed, failure = place.run(command)
        if failure:
            return self.note(block.start, command, f"{failure}\n{printed[-2000:]}")
        lines, rows = without_times(block.lines), [row for row in printed.split("\n") if row.startswith("|")]
        difference = first_difference(lines, without_times(rows), block.within)
        if difference:
            at, got = difference
            self.note(block.start, command, f"the table shows  {lines[at] if at < len(lines) else '(nothing more)'}\n"
                                            f"    the command prints  {got}")

    def update(self):
        """Puts what the commands print in place of what is shown, unless that has a line `...`."""
        lines, changes = self.text.split("\n"), []
        for block in self.blocks:
            if (block.slow and not self.slow) or not self.prepare(block):
                continue
            for command in block.values("table"):
                rows = [row for row in self.place(block).run(command)[0].split("\n") if row.startswith("|")]
                changes.append((block.start, block.start + len(block.lines), rows))
            for command, first, old in commands(block.lines) if block.kind == "console" else []:
                printed, failure = self.place(block).run(command)
                if failure:
                    print(f"{command}: {failure}", file=sys.stderr)
                if not any(line.strip() == "..." for line in old):
                    start = block.start + first
                    changes.append((start, start + len(old), trimmed(printed.split("\n"))))
        for start, end, new in reversed(changes):
            lines[start:end] = new
        self.path.write_text("\n".join(lines))
        self.close()

    def show(self):
        for block in self.blocks:
            for command, _, _ in commands(block.lines) if block.kind == "console" else []:
                printed, failure = self.place(block).run(command)
                print(f"$ {command}\n{printed}{failure}", flush=True)
        self.close()


# ------------------------------------------------------------------------------------------------- self-test

def self_test():
    """A document that holds is passed, and each way in which one can be wrong is noticed."""
    def differences(text, slow=False):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "README.md"
            path.write_text(text)
            return Document(path, "build", slow).check()

    def console(command, *lines, mark=""):
        return "\n".join([mark, "```console", f"$ {command}", *lines, "```", ""])

    def table(command, *lines):
        return "\n".join([f"<!-- table: {command} -->", *lines, ""])

    rows = "printf '| deck | q | time |\\n|---|---|---|\\n| a | 0.93%s | 2.5 |\\n' 65"
    holds = {
        "what is printed": console("printf 'a 1\\nb 2\\n'", "a 1", "b 2"),
        "another time": console("echo took 0.31 s, 5 MB", "took 0.02 s, 7 MB"),
        "the last digit": console("echo 0.93652", "0.9365"),
        "a unit of the last digit": console("echo 0.9366", "0.9365"),
        "a rounding error": console("echo 3.1e-16", "1.8e-16"),
        "a number within its tolerance": console("echo 1.01e-3", "1.00e-3", mark="<!-- within: 2 % -->"),
        "lines left out": console("seq 9", "1", "...", "8", "9"),
        "a file of its own": console("echo 5 > made-here && cat made-here", "5"),
        "a command before": console("cat made-here", "6", mark="<!-- before: echo 6 > made-here -->"),
        "a file that is shown": "<!-- file: here -->\n```\n6\n```\n" + console("cat here", "6"),
        "a table": table(rows, "| deck | q | time |", "|---|---|---|", "| a | 0.9365 | 9.9 |"),
        "a slow command, left out": console("false", mark="<!-- slow -->"),
        "a link and a file": "[README](README.md#one) and `src/main.cpp`\n# One\n",
        "sections by name": 'README.md, "One two" and "Three", and `src/README.md`, "A\ndensity"\n# One two\n# Three\n',
        "a lesson and an exercise": "lessons 1, 3 and 12, exercise 4.6\n",
    }
    wrong = {
        "a stale count": console("echo 12 steps", "11 steps"),
        "a stale number": console("echo q 0.9367", "q 0.9365"),
        "a stale number of seven digits": console("echo 1519.4267", "1530.1069"),
        "a stale small number": console("echo 1.125e-08", "1.129e-08"),
        "a number that is no integer any more": console("echo 5.3", "5"),
        "a number beyond its tolerance": console("echo 1.05e-3", "1.00e-3", mark="<!-- within: 2 % -->"),
        "a missing line": console("printf 'a\\nb\\n'", "a"),
        "a missing line after `...`": console("seq 9", "1", "...", "8"),
        "a line too many": console("echo a", "a", "b"),
        "another word": console("echo converged", "stalled"),
        "a failing command": console("echo a; false", "a"),
        "a failing command before": console("echo a", "a", mark="<!-- before: false -->"),
        "a stale cell": table(rows, "| deck | q | time |", "|---|---|---|", "| a | 0.9165 | 2.5 |"),
        "a missing row": table(rows, "| deck | q | time |", "|---|---|---|"),
        "a link to nowhere": "[there](nowhere.md)\n",
        "a heading that is not there": "[there](README.md#two)\n# One\n",
        "a section by name that is not there": 'the README of this program, "How this code\nreads the paper"\n# One\n',
        "the second of two that is not there": 'the README\'s sections "One" and "What is, and why"\n# One\n',
        "a section by its topic": "the README's section on speed\n",
        "a section of a lesson that has no such number": "section 3 of lesson 4\n",
        "a lesson that is not there": "lessons 4 and 14\n",
        "an exercise that is not there": "exercise 4.9\n",
        "an example for a place that is not there": "<!-- in: src/main.cpp before: nothing -->\n```cpp\n```\n",
        "a file that is not there": "`src/method/nothing.cpp`\n",
    }
    failures = [f"{name}: {found.differences}" for name, text in holds.items()
                if (found := differences(text)).differences]
    failures += [f"{name} is not noticed" for name, text in wrong.items() if not differences(text).differences]
    if not differences(console("false", mark="<!-- slow -->"), slow=True).differences:
        failures.append("a slow command that fails is not noticed")
    if (ROOT / "made-here").exists():
        failures.append("a command has left a file in the checkout")
    for failure in failures:
        print(f"documents: {failure}", file=sys.stderr)
    if not failures:
        print(f"documents: {len(holds)} that hold pass, {len(wrong) + 1} that are wrong are noticed")
    return 1 if failures else 0


# ------------------------------------------------------------------------------------------------- command line

def named(names):
    handouts = sorted(LESSONS.glob("[0-9][0-9]-*/README.md"))
    if not names:
        return [*READMES, *handouts]
    found = [path for name in names for path in (handouts if re.fullmatch(r"\d\d", name) else [Path(name).resolve()])
             if not re.fullmatch(r"\d\d", name) or path.parent.name[:2] == name]
    if not found or not all(path.exists() for path in found):
        sys.exit("no such document")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("--slow", action="store_true")
    parser.add_argument("--show", action="store_true")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("document", nargs="*")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    documents = [Document(path, options.build, options.slow) for path in named(options.document)]
    if options.show or options.update:
        for document in documents:
            document.show() if options.show else document.update()
        return 0
    with concurrent.futures.ThreadPoolExecutor(1 if options.slow else 2) as pool:
        list(pool.map(Document.check, documents))
    for document in documents:
        slow = f", {document.left_out} slow ones left out (make readmes)" if document.left_out else ""
        verdict = "DIFFERS" if document.differences else "as shown"
        print(f"{str(shown(document.path).parent if document.handout else shown(document.path)):<32} "
              f"{document.checked:>3} commands  {verdict}{slow}")
    for document in documents:
        for difference in document.differences:
            print(difference, file=sys.stderr)
    return 1 if any(document.differences for document in documents) else 0


if __name__ == "__main__":
    sys.exit(main())

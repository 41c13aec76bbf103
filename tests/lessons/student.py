#!/usr/bin/env python3
"""Exports the course for students: the files of this checkout without solutions, as a folder that stands alone.

  tests/lessons/student.py FOLDER        FOLDER must not exist yet; uncommitted files stay behind
  tests/lessons/student.py --self-test [BUILD]   whether an export has no solutions and can check answers; with the
                                         folder of a build: whether an almesh of one's own runs there

Left out are the solutions, what quotes them, and the git history. In the handouts what the solutions print is shown as
what `make check-lesson-NN` prints when all is done. Standard library only.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from answers import OWN_ALMESH, ROOT
from own import PARTS

LEFT_OUT = re.compile(r"(^|/)solutions/|^inputs/lessons/paper-solutions\.md$|^tests/lessons/(wrong|student)")
# Lines of the course's README that are of no use without solutions.
OF_LECTURERS = re.compile(r"olutions|^\| `make (lessons|wrong-answers|student)")
# What handouts show of the solutions, and the same as students have it.
OF_STUDENTS = [(re.compile(r"```console\n\$ build/lessons/solved-(\d\d) \S+"), r"```\n$ make check-lesson-\1"),
               (re.compile(r"```console\n\$ tests/lessons/own\.py --build \S+ \S+"), r"```\n$ make own-almesh"),
               (re.compile(r"(  12\.5 .*\n)5 of 5"),
                rf"\1  {OWN_ALMESH[0]}  {OWN_ALMESH[1]:<50} holds\n6 of 6")]


def export(folder):
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, text=True, capture_output=True, check=True).stdout
    for name in listed.split("\0"):
        if not name or LEFT_OUT.search(name) or not (ROOT / name).is_file():
            continue
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, target)
        if re.fullmatch(r"inputs/lessons/\d\d-[\w-]+/README\.md", name):
            text = target.read_text()
            for shown, instead in OF_STUDENTS:
                text = shown.sub(instead, text)
            target.write_text(text)
        if name == "inputs/lessons/README.md":
            kept = [line for line in target.read_text().split("\n") if not OF_LECTURERS.search(line)]
            target.write_text(re.sub(r"\n{3,}", "\n\n", "\n".join(kept)))


def self_test(build):
    failures = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "course"
        export(folder)
        files = [path for path in folder.rglob("*") if path.is_file()]
        names = [str(path.relative_to(folder)) for path in files]
        failures += [f"{name} is there" for name in names if "solution" in name and "lessons/" in name]
        texts = {path: path.read_text() for path in files if path.suffix in (".md", ".txt", ".py", ".hpp", ".cpp")}
        telling = {line for path in (ROOT / "src" / "lessons" / "solutions").glob("*.cpp")
                   for line in path.read_text().split("\n") if "return " in line and len(line.strip()) > 60}
        programs = "".join(path.read_text() for path in (ROOT / "src" / "lessons").glob("*.?pp"))
        telling = {line for line in telling if line not in programs}  # helpers that the lessons show
        failures += [f"{path.relative_to(folder)} has the solution `{line.strip()}`" for path, text in texts.items()
                     for line in telling if line in text and "lessons" in str(path)]
        for target in ("check-lesson-07", "lesson-07", "hint-07-1", "check-lessons", "own-almesh"):
            done = subprocess.run(["make", "-n", target], cwd=folder, text=True, capture_output=True)
            if done.returncode != 0 or "solved" in done.stdout:
                failures.append(f"make {target} does not work in the export: {done.stderr}")
        if build:
            command = ["tests/lessons/own.py", "--build", build, "--unchecked", "--borrow", " ".join(PARTS)]
            done = subprocess.run(command, cwd=folder, text=True, capture_output=True)
            if done.returncode != 0 or "q = 0.9365 after 5 iterations" not in done.stdout:
                failures.append(f"an almesh of one's own does not run in the export: {done.stdout}{done.stderr}")
    print("\n".join(failures) if failures else "the course without solutions stands alone")
    return 1 if failures else 0


def main(words):
    if words[:1] == ["--self-test"]:
        return self_test(Path(words[1]).resolve() if words[1:] else None)
    if len(words) != 1 or Path(words[0]).exists():
        sys.exit("usage: student.py FOLDER, which must not exist yet (make student TO=FOLDER)")
    export(Path(words[0]).resolve())
    print(f"{words[0]}: the course without solutions; students start with inputs/lessons/01-distortion/README.md")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""Exports the course for students: what they need of this checkout, without solutions, as a folder that stands alone,
and the same as an archive. The library comes along, built, with the program and the checks of the exercises.

  tests/lessons/student.py --build BUILD --flags FLAGS --parts "FILE ..." FOLDER
  tests/lessons/student.py --build BUILD --flags FLAGS --parts "FILE ..." --self-test

BUILD is the folder that has the program; the parts, files in it, are what `make check-lesson-NN` and `make own-almesh`
need; FLAGS are the CXXFLAGS that they were built with. FOLDER must not exist yet; uncommitted files stay behind. The
self-test exports, and runs there what students run.

Of the checkout go: the source of the library and the lessons, the handouts and what is in their folders, what their
commands read, the scripts of their pictures with all that they import, and the judge. In the handouts what the
solutions print is shown as what `make check-lesson-NN` prints when all is done; links to what stays behind are plain
words. Standard library only.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

from answers import OWN_ALMESH, ROOT
from own import PARTS

ALWAYS = re.compile(r"Makefile|LICENSE|src/.+|inputs/lessons/.+|outputs/README\.md|tests/(documents|verify)\.py|"
                    r"tests/support/prefix\.hpp|tests/lessons/.+|plot/lessons/([^/]+\.png|\w+\.py|pages/\w+\.html)|"
                    r"README\.md|plot/(compare|paper_tables)\.py|tests/method/sliding_constraint_test\.cpp")
NEVER = re.compile(r"(^|/)solutions/|/slides\.(md|py|html)$|"
                   r"^inputs/lessons/(paper-solutions|exam|exam-solutions|plans)\.md$|^tests/lessons/(wrong|student|times)")
# Files whose commands and keys name others.
NAMING = re.compile(r"^inputs/.+\.(md|deck|sh)$|^src/lessons/|^tests/lessons/.+\.(cpp|hpp|py)$|^plot/")
NAME = re.compile(r"[\w./-]+\.(?:msh|deck|mtx|csv|py|cpp|hpp)\b")
QUOTED = re.compile(r'"([\w/-]+)"')  # a mesh of inputs/meshes/, or a deck, as programs and scripts name it
IMPORT = re.compile(r"^(?:import|from) (\w+)", re.M)
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#]*)(#[^)\s]*)?\)")
# Paragraphs and rows of the course's README that are of no use to students.
OF_LECTURERS = re.compile(r"olutions|For the lecturer|^\*\*(Grading|Slides|What is compared)|^`make paper figures|"
                          r"^\| `make (lessons|wrong|student|slides|animation)")
# Targets that the export's `make help` lists.
OF_STUDENTS = re.compile(r"^(all|help|help-all|lesson-%|check-lesson-%|watch-%|hint-%|own-almesh|check-lessons|examples|"
                         r"paper|compare):")
SHOWN = [(re.compile(r"```console\n\$ build/lessons/solved-(\d\d) \S+"), r"```\n$ make check-lesson-\1"),
         (re.compile(r"```console\n\$ tests/lessons/own\.py --build \S+ \S+"), r"```\n$ make own-almesh"),
         (re.compile(r"(  12\.5 .*\n)5 of 5"), rf"\1  {OWN_ALMESH[0]}  {OWN_ALMESH[1]:<50} holds\n6 of 6")]
README = """# A course on nonlinear mesh optimisation with constraints

Start with [lesson 1](inputs/lessons/01-distortion/README.md); [all lessons](inputs/lessons/README.md). You need make,
g++ or clang++ and Python 3; for the pictures numpy and matplotlib.

    make lesson-01          builds a lesson's programs, runs the commands of its handout, draws its picture
    make check-lesson-01    checks your answers, src/lessons/exercises/01.cpp; make watch-01: at each save
    make hint-01-2          a hint for exercise 1.2
    make help               all of it

The library comes built, for {machine}. It is built anew (minutes) where it does not run, and
if you remove the file build/prebuilt: do so before you change anything in src/ outside of src/lessons/. What follows is
the page of the program itself.

"""


# ------------------------------------------------------------------------------------------------- what goes

def listed():
    names = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, text=True, capture_output=True, check=True).stdout
    return {name for name in names.split("\0") if name and (ROOT / name).is_file()}


def named_in(name, there):
    """Files of the checkout that a file names, by their path from the root, from its folder or from inputs/."""
    text = (ROOT / name).read_text(errors="replace")
    places = [Path("."), Path(name).parent, Path("inputs")]
    found = {os.path.normpath(place / word) for word in NAME.findall(text) for place in places}
    if name.startswith(("src/lessons/", "plot/")):
        for word in QUOTED.findall(text):
            found |= {f"inputs/meshes/{word}.msh", f"inputs/{word}.deck"}
    if name.startswith("plot/"):
        found |= {f"plot/{module}.py" for module in IMPORT.findall(text)}
    return found & there


def chosen():
    there = {name for name in listed() if not NEVER.search(name)}
    names = {name for name in there if ALWAYS.fullmatch(name)}
    todo = [name for name in names if NAMING.search(name)]
    while todo:
        more = named_in(todo.pop(), there) - names
        names |= more
        todo += [name for name in more if NAMING.search(name)]
    return sorted(names)


# ------------------------------------------------------------------------------------------------- what becomes of it

def without_links(text, name, names):
    """Links to files that stay behind become their words."""
    folders = {str(folder) for known in names for folder in Path(known).parents}

    def words(link):
        target = os.path.normpath(Path(name).parent / link[3]) if link[3] else name
        kept = target in names or target in folders or "://" in link[3]
        return link[0] if kept else link[2]

    return LINK.sub(words, text)


def of_students(text, name, names):
    """The text of a file as students have it."""
    if name == "Makefile":
        lines = [line if OF_STUDENTS.match(line) else re.sub(r" *##.*", "", line) if re.match(r"[a-z%-]+:.*##", line)
                 else line for line in text.split("\n")]
        return re.sub(r"^clean:.*\n(\t.*\n)+", "", "\n".join(lines), flags=re.M)  # it would remove what has come along
    if name == "inputs/lessons/README.md":
        parts = [part if part.startswith("|") else "" if OF_LECTURERS.search(part) else part
                 for part in text.split("\n\n")]
        text = "\n\n".join(part for part in parts if part)
        text = "\n".join(line for line in text.split("\n") if not OF_LECTURERS.search(line))
    for shown, instead in SHOWN if re.fullmatch(r"inputs/lessons/\d\d-[\w-]+/README\.md", name) else []:
        text = shown.sub(instead, text)
    return without_links(text, name, names) if name.endswith(".md") else text


def export(folder, built):
    names = chosen()
    for name in names:
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, target)
        if name == "Makefile" or name.endswith(".md"):
            target.write_text(of_students(target.read_text(), name, set(names)))
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, text=True, capture_output=True).stdout
    (folder / "COMMIT").write_text(commit)
    page = folder / "README.md"
    page.write_text(README.format(machine=machine(built.flags)) + page.read_text())
    for path in {built.folder / "almesh", *map(Path, built.parts)}:
        target = folder / "build" / path.relative_to(built.folder)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(path, target)
    (folder / "build" / "prebuilt").write_text(f"{built.flags}\n")


def machine(flags):
    system = os.uname()
    level = re.search(r"-march=(\S+)", flags)
    return f"{system.sysname} on {system.machine}" + (f", -march={level[1]}" if level else "")


def archive(folder):
    path = folder.with_name(folder.name + ".tar.xz")
    with tarfile.open(path, "w:xz", preset=6) as file:
        file.add(folder, folder.name)
    return path


def size_of(folder):
    files = [path for path in folder.rglob("*") if path.is_file()]
    return len(files), sum(path.stat().st_size for path in files) / 1e6


# ------------------------------------------------------------------------------------------------- self-test

def telling_lines():
    """Long lines of solutions that no program of the lessons has."""
    lines = {line for path in (ROOT / "src" / "lessons" / "solutions").glob("*.cpp")
             for line in path.read_text().split("\n") if "return " in line and len(line.strip()) > 60}
    programs = "".join(path.read_text() for path in (ROOT / "src" / "lessons").glob("*.?pp"))
    return {line for line in lines if line not in programs}


def self_test(built):
    failures = []

    def make(*words):
        done = subprocess.run(["make", *words], cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env={name: value for name, value in os.environ.items() if not name.startswith("MAKE")})
        compiled = re.findall(r"CXX\s+(\S*src/(?!lessons|examples)\S+)", done.stdout)
        failures.extend(f"make {words[0]} compiles {name}, which comes along" for name in compiled[:1])
        return done

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "course"
        export(folder, built)
        files = [path for path in folder.rglob("*") if path.is_file()]
        names = {str(path.relative_to(folder)) for path in files}
        failures += [f"{name} is there" for name in names if re.search(r"solution|exam|slides|wrong", name)
                     and "lessons/" in name]
        texts = {path: path.read_text() for path in files if path.suffix in (".md", ".txt", ".py", ".hpp", ".cpp")}
        telling = telling_lines()
        failures += [f"{path.relative_to(folder)} has the solution `{line.strip()}`" for path, text in texts.items()
                     for line in telling if line in text and "lessons" in str(path)]
        if "of 6 answers hold" not in (done := make("check-lesson-01")).stdout:
            failures.append(f"make check-lesson-01 does not work in the export: {done.stdout}")
        for target, says in (("hint-07-1", ""), ("lesson-01", "4330.1271"), ("help", "check-lesson-NN")):
            done = make(target, "PYTHON=false")
            if done.returncode != 0 or says not in done.stdout:
                failures.append(f"make {target} does not work in the export: {done.stdout}")
        lessons = [name[15:17] for name in names if re.match(r"inputs/lessons/\d\d-.*/README", name)]
        targets = ["check-lessons", "watch-09", "own-almesh", *(f"lesson-{number}" for number in lessons)]
        done = make("-n", *targets)
        if done.returncode != 0 or "solved" in done.stdout:
            failures.append(f"make {' '.join(targets)} does not work in the export: {done.stdout}")
        done = make("own-almesh", "UNCHECKED=1", f"BORROW={' '.join(PARTS)}", "PYTHON=false")
        if done.returncode != 0 or "q = 0.9365 after 5 iterations" not in done.stdout:
            failures.append(f"an almesh of one's own does not run in the export: {done.stdout}")
    print("\n".join(failures) if failures else "the course without solutions stands alone")
    return 1 if failures else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True)
    parser.add_argument("--flags", required=True)
    parser.add_argument("--parts", required=True, type=str.split)
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("to", nargs="?", type=Path, metavar="FOLDER")
    built = parser.parse_args()
    built.folder = Path(built.build)
    os.chdir(ROOT)
    if built.self_test:
        return self_test(built)
    if built.to is None or built.to.exists():
        sys.exit("FOLDER must be given, and must not exist yet: make student TO=FOLDER")
    export(built.to.resolve(), built)
    count, megabytes = size_of(built.to)
    packed = archive(built.to.resolve())
    print(f"{built.to}: the course without solutions, {count} files, {megabytes:.1f} MB; packed: {packed.name}, "
          f"{packed.stat().st_size / 1e6:.1f} MB")
    print("students start with inputs/lessons/01-distortion/README.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())

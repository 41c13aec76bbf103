#!/usr/bin/env python3
"""Runs each target that `make help-all` lists once, at its smallest size, and prints a table: whether it works here, or
what it needs that is missing.

  tests/targets.py [--quick | --all] [NAME ...]   all but those of hours, those of seconds, all; or those named
  --python PROGRAM                                the Makefile's PYTHON
  --logs build/targets                            folder for what they print

`make check-targets`, with QUICK=1 or ALL=1, or TARGETS="bench page". Settings of make, such as BUILD=build-test, go to
every target. `meshes` and `clean` change what is committed or built, so they work on a copy. A target of make help-all
that is not in the table below is a failure, and so is one that make help-all does not list. Exit code 1 where one fails.
Standard library only.
"""
import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SIZES = ["seconds", "minutes", "hours"]
# As from a shell, with the settings but without the jobs of the make that has started this.
ENVIRONMENT = {**os.environ, "MAKEFLAGS": re.sub(r"-j\S*|--jobserver\S+", "", os.environ.get("MAKEFLAGS", "")),
               "MAKELEVEL": "0"}
PATIENCE = {"seconds": 1200, "minutes": 3600, "hours": 12 * 3600}
# What may be missing: how to see that it is there, a program or a command, and Debian's packages that bring it.
NEEDS = {
    "numpy": ("@python -c 'import numpy'", "python3-numpy"),
    "matplotlib": ("@python -c 'import numpy, matplotlib'", "python3-numpy python3-matplotlib"),
    "scipy": ("@python -c 'import scipy'", "python3-scipy"),
    "pillow": ("@python -c 'import PIL'", "python3-pil"),
    "gmsh for Python": ("@python -c 'import gmsh'", "python3-gmsh"),
    "gmsh": ("command -v gmsh", "gmsh"),
    "CalculiX": ("command -v ccx", "calculix-ccx"),
    "VTK": ("@python -c 'import vtk'", "python3-vtk9"),
    "clang++": ("command -v clang++", "clang"),
    "npm": ("command -v npm", "npm"),
    "git": ("command -v git", "git"),
    "CHOLMOD": (".ci/find-cholmod", "libsuitesparse-dev libopenblas0-pthread"),
    "Slurm": ("command -v sbatch && test $(id -u) = 0", "slurm-wlm, as root"),
    "Chromium": ("command -v chromium || command -v chromium-browser || command -v google-chrome", "chromium npm"),
    "pandoc": ("command -v pandoc", "pandoc"),
    "emscripten": ("command -v em++", "emscripten"),
    "models": ("ls /usr/share/opencascade/data/*/*.brep /usr/share/doc/gmsh-doc/doc/gmsh/demos/*/*.st*p.gz",
               "occt-misc gmsh-doc"),
}


@dataclass
class Target:
    name: str                 # as in make help-all
    size: str = "seconds"     # of an idle machine with two cores, when the programs are built
    settings: list = field(default_factory=list)
    needs: list = field(default_factory=list)
    goal: str = ""            # of make, where it is not the name
    before: str = ""          # a command
    copy: list = field(default_factory=list)  # works in a folder with copies of these
    waits: bool = False       # does not end by itself


TARGETS = [
    Target("all"),
    Target("run"),
    Target("help"),
    Target("help-all"),
    Target("test", "hours"),
    Target("quick", "minutes", ["ONLY=line_search"]),
    Target("examples"),
    Target("lib", "minutes"),
    Target("install", settings=["PREFIX=@folder/tree"]),
    Target("uninstall", settings=["PREFIX=@folder/tree"]),
    Target("dist", needs=["git"]),
    Target("test-install", "minutes"),
    Target("wheel", "minutes", copy=["Makefile", "src", "packaging", "LICENSE", "README.md"]),
    Target("doors", settings=["DECKS=circle targets/flap"]),
    Target("proofs", settings=["MESHES=inputs/meshes/square.msh", "QUICK=1"]),
    Target("long-tests", "minutes"),
    Target("oracle", "minutes", ["DECKS=circle"], ["numpy"]),
    Target("asan", "hours"),
    Target("mutants", "hours", ["ONLY=polish.cpp"]),
    Target("fuzz", "minutes", ["MINUTES=1", "HARNESSES=deck"], ["clang++"]),
    Target("matrix", "hours", ["ONLY=g++-O2"]),
    Target("reproduce", "minutes", ["QUICK=1"]),
    Target("bench", "minutes", ["QUICK=1"]),
    Target("compare-cholmod", "minutes", needs=["CHOLMOD"]),
    Target("lesson-NN", goal="lesson-01"),
    Target("check-lesson-NN", goal="check-lesson-01", settings=["ANSWERS=solutions"]),
    Target("watch-NN", goal="watch-01", waits=True),
    Target("hint-NN", goal="hint-01-1"),
    Target("own-almesh", settings=["ANSWERS=solutions"]),
    Target("slides", needs=["pandoc", "Chromium"]),
    Target("student", "minutes", settings=["TO=@folder/course"]),
    Target("check-lessons", settings=["ANSWERS=solutions"]),
    Target("lessons", "hours"),
    Target("wrong-answers", "hours"),
    Target("readmes", "minutes", ["ONLY=plot/README.md"], ["matplotlib"]),
    Target("paper", "minutes"),
    Target("gauntlet", "minutes"),
    Target("slurm", "minutes", needs=["Slurm"]),
    Target("certificates", settings=["ELEMENTS=10"]),
    Target("untangle", settings=["ONLY=tri-random"]),
    Target("improve", settings=["ONLY=square"]),
    Target("records", settings=["MESHES=inputs/meshes/square.msh", "CORNERS=1"], needs=["numpy", "scipy"]),
    Target("patch", settings=["MESHES=tests/io/data"]),
    Target("judges", settings=["ONLY=gmsh-square"], needs=["gmsh for Python", "VTK", "numpy"]),
    Target("generated", settings=["ONLY=17"]),
    Target("compare-gmsh", "minutes", ["ONLY=torus"], ["gmsh for Python", "numpy"]),
    Target("compare-improve", "minutes", ["QUICK=1"], ["gmsh for Python", "numpy", "scipy"]),
    Target("cad-models", "minutes", ["MODELS=inputs/cad --only torus --edges 6"], ["gmsh for Python"]),
    Target("cad-examples", "minutes", ["ONLY=component8"], ["gmsh for Python", "models"]),
    Target("coupling", "minutes"),
    Target("calculix", "minutes", ["ONLY=tee", "INPUTS=--only beam8"], ["CalculiX", "gmsh for Python", "matplotlib"]),
    Target("drift", "minutes", needs=["matplotlib", "scipy"]),
    Target("derivatives", settings=["ONLY=circle"]),
    Target("defaults", settings=["ONLY=grown"]),
    Target("page", needs=["npm"], settings=["DECK=inputs/circle.deck"]),
    Target("test-page", "minutes", needs=["npm", "Chromium"]),
    Target("wasm", "minutes", needs=["npm", "emscripten"]),
    Target("test-wasm", "minutes", needs=["npm", "emscripten", "Chromium"]),
    Target("quality", settings=["RESULTS=outputs/square"], needs=["matplotlib"],
           before="./almesh improve inputs/meshes/square.msh"),
    Target("animation", needs=["matplotlib", "pillow"], settings=["RESULTS=outputs/square"],
           before="./almesh improve inputs/meshes/square.msh"),
    Target("compare", "minutes", needs=["matplotlib"]),
    Target("figures", settings=["ONLY=fig01"], needs=["matplotlib"],
           before="./almesh inputs/circle.deck"),
    Target("meshes", "minutes", needs=["gmsh"], copy=["Makefile", "inputs"]),
    Target("clean", copy=["Makefile"]),
]


def listed():
    """The names in make help-all."""
    text = subprocess.run(["make", "--no-print-directory", "help-all"], cwd=ROOT, stdout=subprocess.PIPE, text=True,
                          check=True, env=ENVIRONMENT).stdout
    return re.findall(r"^([a-zA-Z-]+) {2,}", text, re.M)


class Runner:
    def __init__(self, python, logs, folder):
        self.python, self.logs, self.folder = python, logs, Path(folder)
        logs.mkdir(parents=True, exist_ok=True)

    def filled(self, text):
        return text.replace("@python", self.python).replace("@folder", str(self.folder))

    def missing(self, target):
        """Packages."""
        found = []
        for need in target.needs:
            test, packages = NEEDS[need]
            if subprocess.run(self.filled(test), shell=True, cwd=ROOT, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL).returncode:
                found += [word for word in packages.split(" ") if word not in found]
        return " ".join(found)

    def run(self, target):
        """What came of it, and whether that is as it should be."""
        if packages := self.missing(target):
            return f"not here: {packages}", True
        cwd = ROOT
        for name in target.copy:
            cwd = self.folder / target.name
            cwd.mkdir(exist_ok=True)
            copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
            copy(ROOT / name, cwd / name)
        command = ["make", "--no-print-directory", target.goal or target.name, *map(self.filled, target.settings)]
        log = self.logs / f"{target.name}.txt"
        with log.open("w") as out:
            if target.before:
                subprocess.run(self.filled(target.before), shell=True, cwd=ROOT, stdout=out, stderr=out)
            process = subprocess.Popen(command, cwd=cwd, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                       start_new_session=True, env=ENVIRONMENT)
            code = self.ended(process, 6 if target.waits else PATIENCE[target.size])
        if code == (None if target.waits else 0):
            return "works", True
        lines = log.read_text(errors="replace").strip().splitlines()
        how = "did not end" if code is None else "ended by itself" if target.waits else f"exit code {code}"
        return f"FAILS, {how}: {lines[-1] if lines else 'no output'} ({log})", False

    @staticmethod
    def ended(process, seconds):
        """The exit code, None where it did not end in time: it and all that it has started are ended then."""
        try:
            return process.wait(seconds)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()
            return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--logs", type=Path, default=ROOT / "build" / "targets")
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    names, known = listed(), [target.name for target in TARGETS]
    names = [name for name in names if name != "check-targets"]
    faults = [f"{name}: in make help-all, but not in tests/targets.py" for name in names if name not in known]
    faults += [f"{name}: in tests/targets.py, but not in make help-all" for name in known if name not in names]
    faults += [f"{name}: no such target" for name in options.names if name not in known]
    largest = "hours" if options.all else "seconds" if options.quick else "minutes"
    print(f"{'target':16}  {'seconds':>7}  result")
    with tempfile.TemporaryDirectory() as folder:
        runner = Runner(options.python, options.logs.resolve(), folder)
        for target in TARGETS:
            if options.names and target.name not in options.names:
                continue
            start = time.monotonic()
            if not options.names and SIZES.index(target.size) > SIZES.index(largest):
                result, good = f"left out: takes {target.size}", True
            else:
                result, good = runner.run(target)
            print(f"{target.name:16}  {time.monotonic() - start:7.1f}  {result}", flush=True)
            faults += [] if good else [target.name]
    print("\n".join(faults) if faults else "all that was run works")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

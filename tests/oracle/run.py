#!/usr/bin/env python3
"""Looks for false sentences: runs decks and generated cases, and compares what files and console claim with what the
meshes are, without anything of src/.

    tests/oracle/run.py [--program PROGRAM] [--seconds N] [--quick] [NAME ...]

NAME: part of the name of a deck in inputs/ (circle, cells/kinds) or of a case of cases.py (bulge, crack); default: all.
--quick: the cases, and the decks of a second. A run that takes longer than N seconds (60) is left out. A line for each
run; exit code 1 where anything false was found. Needs numpy."""
import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    import numpy
except ImportError:  # Debian's Python has it where another one stands first
    if sys.executable != "/usr/bin/python3" and not subprocess.run(["/usr/bin/python3", "-c", "import numpy"],
                                                                   capture_output=True).returncode:
        os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])
    sys.exit("tests/oracle needs numpy (Debian: apt-get install python3-numpy): nothing was checked")

ROOT = Path(__file__).resolve().parents[2]
import cases  # noqa: E402
from checks import Check  # noqa: E402
from meshes import read  # noqa: E402
from motions import Deck  # noqa: E402

QUICK = ["circle", "circle-refined-1", "channel-bump", "cells/circle-turned", "cells/kinds-2", "cells/kinds-4",
         "cells/rotor", "cells/twist-90", "cad/torus", "inner/layer", "inner/moved", "inner/solid", "slide/bump",
         "slide/onto-bump", "slide/rotor", "targets/dent", "targets/flap", "targets/wave", "targets/from-wave"]


def run(almesh, deck, keys, output, seconds):
    """The Check of a run, or None where it took too long."""
    keys = [*keys, f"output={output}", "vtk=none"]
    try:
        done = subprocess.run([almesh, str(deck), *keys], capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return None
    return Check(Deck(deck, keys), done.stdout + done.stderr, done.returncode, output)


def decks():
    found = {str(p.relative_to(ROOT / "inputs").with_suffix("")): p for p in sorted((ROOT / "inputs").rglob("*.deck"))}
    first = {"targets/wave": found.pop("targets/wave")}  # another deck takes its walls
    return {**first, **{name: p for name, p in found.items() if not name.startswith("lessons")}}


def advice(check, almesh, deck, seconds):
    """What a message says to try has to be accepted by the same command."""
    known = {line.split()[0] for line in subprocess.run([almesh, "--keys"], capture_output=True, text=True).stdout
             .splitlines() if re.match(r"[a-z_0-9]+ ", line)}
    for text in re.findall(r"\btry (.*)", check.console):
        for key, value in re.findall(r"\b(\w+) ?= ?([\w.+-]+)", text):
            if key in known:
                again = run(almesh, deck, [f"{key}={value.rstrip('.')}"], check.output.parent / "advice", seconds)
                if again and again.code == 1:
                    check.say(f"the advice {key} = {value} is refused: {again.console.strip().splitlines()[-1][:100]}")


def one_case(name, almesh, folder, seconds):
    make, expected = cases.CASES[name]
    made, lines, suffix = make()
    mesh = folder / ("mesh" + suffix)
    cases.write_su2(made, mesh) if suffix == ".su2" else made.write(mesh)
    deck = folder / "case.deck"
    deck.write_text("\n".join([f"mesh = {mesh.name}", *lines, "threads = 1", ""]))
    check = run(almesh, deck, [], folder / "results", seconds)
    if check:
        check.all()
        final = next((f for f in (check.output / "final.msh", check.output / "final.su2") if f.exists()), None)
        expected(check, read(final) if final else None)
        advice(check, almesh, deck, seconds)
    return check


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="./almesh")
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("names", nargs="*", metavar="NAME")
    asked = parser.parse_args()
    wanted = lambda name: not asked.names or any(part in name for part in asked.names)
    false = late = count = 0
    with tempfile.TemporaryDirectory() as temporary:
        folder, wave = Path(temporary), Path(temporary) / "targets/wave/final.msh"
        todo = [(name, None) for name in cases.CASES if wanted(name)]
        todo += [(name, path) for name, path in decks().items()
                 if wanted(name) and (not asked.quick or name in QUICK)]
        if any(name == "targets/from-wave" for name, _ in todo) and not any(name == "targets/wave" for name, _ in todo):
            todo.insert(0, ("targets/wave", decks()["targets/wave"]))
        for name, path in todo:
            begin = time.time()
            if path is None:
                (folder / name).mkdir()
                check = one_case(name, str(Path(asked.program).resolve()), folder / name, asked.seconds)
            else:
                keys = [f"boundary all=mesh {wave}"] if name == "targets/from-wave" else []
                check = run(str(Path(asked.program).resolve()), path, keys, folder / name, asked.seconds)
                if check:
                    check.all()
            took, count = time.time() - begin, count + 1
            findings = check.findings if check else []
            verdict = f"{len(findings)} FALSE" if findings else "nothing false" if check else "too slow, not checked"
            print(f"{name:<32} {took:6.1f} s  {'' if not check else check.code}  {verdict}", flush=True)
            for text in findings:
                print("    " + text, flush=True)
            false, late = false + bool(findings), late + (check is None)
    print(f"{count} runs: {false} with something false" + (f", {late} too slow" if late else ""))
    return 1 if false else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Input files of CalculiX as almesh takes them: each .inp (or .inp.gz) of some folders is

  1. read, or refused with a sentence: counted, each kind of refusal with its files;
  2. written again: with every boundary fixed to the last byte, sheared with other coordinates alone (tests/patch.py);
  3. solved as before where it has moved as a whole, where that changes no result: the tables of ccx agree.

  plot/coupling/calculix_decks.py [--solve 10] [--all] [--only WORD] [FOLDER ...]

Without a folder, those of calculix-ccx-test. --solve: so many are solved; --all: all names are listed; --only: files
with a word in their names. `make calculix`; Debian: calculix-ccx, calculix-ccx-test. Exit code 1 where 2 or 3 does not
hold."""
import argparse
import gzip
import os
import re
import sys
from collections import defaultdict
from pathlib import Path

import clients

EXAMPLES = "/usr/share/doc/calculix-ccx-test/examples/test"
clients.need("calculix-ccx calculix-ccx-test python3-numpy", "ccx", "numpy")

import numpy as np

import calculix_files as ccx

sys.path.append("tests")
import patch

# What knows where the origin is (masses of modes are about it), or has no table to compare, or repeats no digits.
PLACED = (r"^\*(TRANSFORM|ORIENTATION|SYSTEM|INCLUDE|RESTART|FLUID|CYCLIC|DISTRIBUTION|ROBUST|SENSITIVITY|FILM|"
          r"FRICTION|RADIATE)|CENTRIF|CORIO|TYPE=[DA]*C*AX|FREQUENCY|USER")
TABLES = r"^\*(NODE|EL|CONTACT) PRINT"
AGREES = 1e-5  # of the largest number of a table; ccx writes seven digits


def copies(folders, into):
    """All input files, plain, in one folder: a file may include another."""
    for folder in folders:
        for file in sorted(Path(folder).rglob("*.inp*")):
            text = gzip.decompress(file.read_bytes()) if file.suffix == ".gz" else file.read_bytes()
            (into / file.name.removesuffix(".gz")).write_bytes(text)
    return sorted(into.glob("*.inp"))


def refusal(said, file):
    """The sentence without the names and numbers of this file."""
    line = next((line for line in said.splitlines() if line.startswith("almesh: ")), said.strip().splitlines()[-1])
    line = re.sub(r"(?<![\w.])[-+]?\d[\d.e+-]*(?!D)", "N", line.replace("almesh: ", "").replace(f"{file}", "FILE"))
    return re.sub(r"(?<=only elements of type ).*", "...", line)


def kind_of(word):
    """What checks say of a file, without the line of its run, which may be one of a table."""
    return word.split(": ")[0].replace("cannot be run", "cannot be run, or not be written as .inp")


def worst(before, after):
    """The largest difference of the tables, relative to the largest number of each; None where they are others."""
    if [title for title, _ in before] != [title for title, _ in after]:
        return None
    largest = 0.0
    for (_, a), (_, b) in zip(before, after):
        if a.shape != b.shape:
            return None
        largest = max(largest, abs(a - b).max() / max(abs(a[:, 1:]).max(initial=0), 1e-300))
    return largest


def can_be_compared(checker, file):
    """Nodes without elements, those of springs and rigid bodies too, stay where they are when the mesh moves."""
    text = file.read_text(errors="replace")
    told, of, not_of = checker.run("info", file).stdout, *(re.compile(words, re.M | re.I) for words in (TABLES, PLACED))
    return of.search(text) and not not_of.search(text) and "without an element" not in told


def solve_moved(checker, file, folder):
    """How far results are apart when the whole mesh has moved, or a word on why nothing is said."""
    taken, _ = ccx.run(folder, file.stem, 60)
    before = ccx.tables(folder / f"{file.stem}.dat") if taken else []
    if not before:
        return "not solved, or no tables"
    final, code, last = checker.moved(file, "translate 0.25 -0.5" + (" 0.125" if checker.is_solid(file) else ""))
    if final is None or code != 0:
        return f"not moved: {last}"
    moved = folder / f"{file.stem}-moved.inp"
    moved.write_bytes(final.read_bytes())
    taken, said = ccx.run(folder, moved.stem, 60)
    if not taken:
        return None
    return worst(before, ccx.tables(folder / f"{moved.stem}.dat"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--solve", type=int, default=10)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("folder", nargs="*", default=[EXAMPLES])
    options = parser.parse_args()
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    folder = clients.new_folder("calculix_decks")
    files = [file for file in copies(options.folder, folder) if options.only in file.name]
    checker = patch.Checker("almesh", 20)
    refused, words, agree, faults, apart = defaultdict(list), defaultdict(list), [], [], 0.0
    for file in files:
        done = checker.run("quality", file)
        if done.returncode not in (0, 4):
            refused[refusal(done.stdout, file)].append(file.stem)
            continue
        word, is_fault = checker.check(file)
        words[kind_of(word)].append(file.stem)
        faults += [f"{file.name}: {word}"] if is_fault else []
        is_new = options.solve > 10 or file.stem[:4] not in {name[:4] for name in agree}
        if word or len(agree) == options.solve or not is_new or not can_be_compared(checker, file):
            continue
        difference = solve_moved(checker, file, folder)
        if isinstance(difference, str):
            words["solving it: " + kind_of(difference)].append(file.stem)
        elif difference is None or difference > AGREES:
            faults.append(f"{file.name}: moved as a whole, ccx has other results: {difference}")
        else:
            agree.append(file.stem)
            apart = max(apart, difference)
    read = len(files) - sum(map(len, refused.values()))
    print(f"{len(files)} input files: {read} read, {len(files) - read} refused")
    for kind, names in sorted(refused.items(), key=lambda item: -len(item[1])):
        print(f"  {len(names):3} refused: {kind}: {', '.join(names[:None if options.all else 3])}")
    print(f"{len(words[''])} come back byte for byte, and moved with other coordinates alone")
    for word, names in words.items():
        if word:
            print(f"  {len(names):3} left out: {word}: {', '.join(names[:None if options.all else 3])}")
    print(f"{len(agree)} solved alike where the mesh has moved as a whole, to {apart:.0e}: {', '.join(agree)}")
    print("".join(f"{fault}\n" for fault in faults), end="")
    return 1 if faults or not agree else 0


if __name__ == "__main__":
    sys.exit(main())

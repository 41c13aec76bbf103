#!/usr/bin/env python3
"""Plants the changes of mutants.txt in the program, one at a time, and sees whether the tests notice.

  tests/mutants/mutants.py [--jobs N] [--whole] [ONLY ...]   plant them all, or those that have one of the words
  tests/mutants/mutants.py --check                           only see that every change fits the source

A block of mutants.txt is a file of src/ and the tests that are to notice, where these are not the file's own
(src/method/polish.cpp has tests/method/polish_test.cpp); a text that occurs in the file exactly once, after `- `; what is
put in its place, after `+ `; and what is wrong then, in words.

A change is noticed where a test fails or crashes. A test that does not end in time has not noticed. --whole: changes
that the named tests pass over are shown to all others before they count as survivors. With a changed header the named
tests alone are compiled anew at first, and where these pass, all that includes it. Works on copies of the project in
build-mutants/, one for each job. Exit code 1 where one survives, hangs the tests or does not compile. Standard library
only.
"""
import argparse
import filecmp
import os
import queue
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / "build-mutants"
TABLE = Path(__file__).with_name("mutants.txt")
PATIENCE, LEAST_SECONDS = 20, 60  # a test hangs that takes so many times as long as without the change, and so long
WHOLE_SECONDS = 3600              # of all tests


@dataclass
class Mutant:
    line: int
    file: str
    tests: list
    old: str
    new: str
    reason: str

    def __str__(self):
        return f"{self.file}: {self.reason}"


def read_table():
    mutants, line = [], 1
    for block in TABLE.read_text().split("\n\n"):
        rows = [row for row in block.split("\n") if row and not row.startswith("#")]
        if rows:
            file, *tests = rows[0].split()
            part = {mark: [row[2:] for row in rows[1:] if row[:2] == mark] for mark in ("- ", "+ ")}
            reason = " ".join(row for row in rows[1:] if row[:2] not in part)
            own = re.sub(r"^src/(.*)\.[ch]pp$", r"tests/\1_test.cpp", file)
            mutants.append(Mutant(line, file, tests or [own], "\n".join(part["- "]), "\n".join(part["+ "]), reason))
        line += block.count("\n") + 2
    return mutants


def faults(mutants):
    """What does not fit the source, as texts."""
    found = []
    for m in mutants:
        path = ROOT / m.file
        count = path.read_text().count(m.old) if m.old and path.is_file() else 0
        if count != 1:
            found.append(f"{m.line}: `{m.old}` occurs {count} times in {m.file}, not once")
        if m.old == m.new or not m.reason:
            found.append(f"{m.line}: a change needs two texts and a reason")
        found += [f"{m.line}: there is no {test}" for test in m.tests if not (ROOT / test).is_file()]
    return [f"{TABLE.relative_to(ROOT)}:{fault}" for fault in found]


def mirror(source, target, times=True, skipped=r"$."):
    """Makes the target like the source, so that make builds only what differs.

    times: compare and keep those of files; else contents, and a file that differs is new. skipped: names in the folder
    itself that are left alone on both sides."""
    target.mkdir(parents=True, exist_ok=True)
    wanted = {entry.name: entry for entry in os.scandir(source) if not re.fullmatch(skipped, entry.name)}
    for entry in os.scandir(target):
        if entry.name not in wanted and not re.fullmatch(skipped, entry.name):
            shutil.rmtree(entry.path) if entry.is_dir() else os.remove(entry.path)
    for name, entry in wanted.items():
        if entry.is_dir():
            mirror(Path(entry.path), target / name, times)
        elif not (target / name).is_file() or not same(entry, target / name, times):
            (shutil.copy2 if times else shutil.copy)(entry.path, target / name)


def same(entry, path, times):
    if not times:
        return filecmp.cmp(entry.path, path, shallow=False)
    here, there = path.stat(), entry.stat()
    return (here.st_size, here.st_mtime_ns) == (there.st_size, there.st_mtime_ns)


def build(tree, jobs, tests=()):
    """Builds a program of these tests, or of all; what the compiler said where that fails, else ""."""
    compiler = os.environ.get("CXX", "g++")
    if shutil.which("ccache") and "ccache" not in compiler:
        compiler = f"ccache {compiler}"
    environment = {**os.environ, "MAKELEVEL": "1"}
    environment.pop("MAKEFLAGS", None)
    command = ["make", f"-j{jobs}", f"CXX={compiler}", "CXXFLAGS=-O1 -march=native", "COMMIT=mutants", "BUILD=build",
               "JOINED=no", "build/almesh-tests"]
    if tests:
        support = [str(path.relative_to(ROOT)) for path in sorted((ROOT / "tests/support").glob("*.cpp"))]
        command.append("TESTS=" + " ".join(["tests/main.cpp", *support, *tests]))
    done = subprocess.run(command, cwd=tree, env=environment, text=True, capture_output=True)
    return "" if done.returncode == 0 else done.stdout + done.stderr


def run_tests(tree, tests, seconds):
    """(the first test case that fails, or "" where none does and None where they do not end; cases run; seconds)."""
    command = ["build/almesh-tests", "--abort-after=1", "--no-colors=true"]
    if tests:
        command.append("--source-file=" + ",".join(f"*{test}" for test in tests))
    environment = {"OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "1000", **os.environ}
    start = time.monotonic()
    try:
        done = subprocess.run(command, cwd=tree, env=environment, text=True, errors="replace", stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=seconds)
    except subprocess.TimeoutExpired:
        return None, 0, seconds
    case = re.search(r"^TEST CASE:\s+(.*)", done.stdout, re.M)
    cases = re.search(r"test cases:\s+(\d+)", done.stdout)
    failed = "" if done.returncode == 0 else case.group(1) if case else f"exit code {done.returncode}"
    return failed, int(cases.group(1)) if cases else 0, time.monotonic() - start


def plant(mutant, tree, whole_tree, limits, all_tests):
    """(whether a test noticed, which one or what happened instead, seconds)."""
    path, is_header = tree / mutant.file, mutant.file.endswith(".hpp")
    time_before = path.stat().st_mtime_ns
    path.write_text(path.read_text().replace(mutant.old, mutant.new))
    if is_header:
        os.utime(path, ns=(time_before, time_before + 1))  # older than any object, and not the time of the original
        for test in mutant.tests:
            (tree / "build" / test).with_suffix(".o").unlink()
    try:
        for tests in [mutant.tests] * (1 + is_header) + [[]] * all_tests:
            if message := build(tree, 1, tests):
                return False, "DOES NOT COMPILE\n" + message[-2000:], 0
            failed, _, seconds = run_tests(tree, tests, limits.get(tuple(tests), WHOLE_SECONDS))
            if failed != "":
                break
            path.touch()
        text = "HANGS" if failed is None else f'noticed by "{failed}"' if failed else "SURVIVES"
        return bool(failed), text, seconds
    finally:
        mirror(whole_tree, tree)


def unmutated_times(mutants, tree):
    """Seconds after which the tests of each mutant count as hanging."""
    limits = {}
    for tests in sorted({tuple(m.tests) for m in mutants}):
        failed, cases, seconds = run_tests(tree, tests, WHOLE_SECONDS)
        if failed or cases == 0:
            sys.exit(f"{' '.join(tests)}: {failed or 'no test'}, without any change")
        limits[tests] = max(LEAST_SECONDS, PATIENCE * seconds)
    return limits


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("only", nargs="*")
    options = parser.parse_args()
    mutants = read_table()
    if found := faults(mutants):
        sys.exit("\n".join(found))
    if options.check:
        print(f"{len(mutants)} changes of {TABLE.relative_to(ROOT)} fit the source")
        return 0
    mutants = [m for m in mutants if not options.only or any(word in f"{m} {m.new}" for word in options.only)]
    jobs = max(1, min(options.jobs, len(mutants)))
    start = time.monotonic()
    whole, trees = BUILD / "whole", queue.Queue()
    mirror(ROOT, whole, False, r"\.git|build.*|outputs|almesh")
    if message := build(whole, options.jobs):
        sys.exit(message[-5000:])
    limits = unmutated_times(mutants, whole)
    for job in range(jobs):
        mirror(whole, BUILD / str(job))
        trees.put(BUILD / str(job))
    print(f"{len(mutants)} changes; the tests are built and pass without them ({time.monotonic() - start:.0f} s)",
          flush=True)

    def one(mutant):
        tree = trees.get()
        noticed, text, seconds = plant(mutant, tree, whole, limits, options.whole)
        trees.put(tree)
        print(f"{mutant}\n    {text} ({seconds:.0f} s)", flush=True)
        return noticed, mutant, text

    with ThreadPoolExecutor(jobs) as pool:
        results = list(pool.map(one, mutants))
    missed = [(mutant, text) for noticed, mutant, text in results if not noticed]
    print(f"{len(mutants)} changes planted, {len(mutants) - len(missed)} noticed, {len(missed)} not "
          f"({time.monotonic() - start:.0f} s)")
    for mutant, text in missed:
        print(f"{TABLE.relative_to(ROOT)}:{mutant.line}: {mutant}: {text.splitlines()[0]}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Tests that a grade is that of the answers: attacks on the judge, on what an answer may include and on what is kept of
earlier answers are refused with a reason, and what does not compile spoils nothing else.

  tests/lessons/wrong_grades.py [--build FOLDER]

Exit code 1 where something passes. `answers.py` has the commands. Standard library only.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import own
from answers import LESSONS, ROOT, Answers, Limits, changed_header, check
from definitions import definitions
from running import sanitizers
from wrong import functions, solved, whole_table

LIMITS = Limits(seconds=4, memory=512, output=1)
SYSTEM = "".join(f"#include <{name}>\n" for name in ("cstdio", "cstdlib", "cstring", "fstream", "iterator", "string",
                                                      "fcntl.h", "unistd.h"))
# Finds, among the words of the command that checks, the file of the verdict, and says there that all is well.
FORGED = SYSTEM + r"""
namespace {
void forge() {
    for (const std::string& process : {std::string("self"), std::to_string(getppid())}) {
        std::ifstream file("/proc/" + process + "/cmdline");
        const std::string words((std::istreambuf_iterator<char>(file)), {});
        for (std::size_t i = 0; i < words.size(); i += std::strlen(&words[i]) + 1)
            if (std::strstr(&words[i], "verdict")) std::ofstream(&words[i]).flush();
    }
}
}
"""
EVERYWHERE = "for (int file = 3; file < 64; ++file) {}"
INITIALISER = "static const int first = [] {{ {} return 0; }}();\n"
# (what it is, what comes before the template, what its rows say). Nothing of it may hold.
ATTACKS = [
    ("ends the program while it is loaded", SYSTEM + INITIALISER.format("_Exit(0);"), "ends the whole program"),
    ("forges an empty verdict while it is loaded", FORGED + INITIALISER.format("forge(); _Exit(0);"),
     "ends the whole program"),
    ("forges an empty verdict at exit", FORGED + INITIALISER.format(
        "std::atexit([] { forge(); _Exit(0); }); std::exit(1);"), "ends the whole program"),
    ("forges an empty verdict at exit, later", FORGED + INITIALISER.format("std::atexit([] { forge(); _Exit(0); });"),
     ""),
    ("writes into all files", SYSTEM + INITIALISER.format(
        EVERYWHERE.format('if (write(file, "vvvvvvvvvvvvvvvvvvvvvvvv", 24) < 0) continue;')), ""),
    ("closes all files", SYSTEM + INITIALISER.format(EVERYWHERE.format("close(file);")), "ends the whole program"),
    ("kills the judge", "#include <signal.h>\n" + SYSTEM + INITIALISER.format("kill(getppid(), SIGKILL);"),
     "calls kill"),
    ("kills the judge in assembler", INITIALISER.format('asm("nop");'), "has asm"),
    ("prints what holds", SYSTEM + INITIALISER.format('std::puts("  1.1   holds\\n6 of 6 answers hold"); _Exit(0);'),
     "ends the whole program"),
]
# The number 1, as a child would send it.
SENDING = ("const struct [[gnu::packed]] { char kind; unsigned long size; double value; } sent = {'v', 8, 1};"
           "for (int file = 3; file < 64; ++file) if (write(file, &sent, sizeof sent) < 0) continue;"
           "for (;;) sleep(1);")
# No right answer where the judge's memory can be written.
INTRUDING = 'if (std::fopen(("/proc/" + std::to_string(getppid()) + "/mem").c_str(), "r+")) return 0;'
SOLUTION = "lessons/solutions/01.cpp"
INCLUDES = [f"#include <{SOLUTION}>\n", f'#define OF <{SOLUTION}>\n#include OF\n', f"# /**/ include \"{SOLUTION}\"\n",
            f'#if __has_include("{SOLUTION}")\n#include "{SOLUTION}"\n#endif\n',
            f"#include \"{ROOT}/src/{SOLUTION}\"\n",
            f"#include <../src/{SOLUTION}>\n", f"#inc\\\nlude \"{SOLUTION}\"\n", f"#include_next <{SOLUTION}>\n"]
# (lesson, what is put before the solution, what all rows say)
BORROWED = [
    ("01", '#include <energy/densities.hpp>\n', 'includes "energy/densities.hpp"'),
    ("01", '#line 1 "/usr/include/math.h"\n', "#line"),
    ("01", '/* a comment\n*/ # /**/ 1 "/usr/include/math.h" 3\n', "#line"),
    ("03", '#include "lessons/exercises/03.hpp"\n#define JOIN(a, b) a##b\nstatic almesh::BlockCsr of_cells() {\n'
           '    return almesh::JOIN(matrix_of_, cells)(1, 1, {}, 3);\n}\n', "calls matrix_of_cells"),
    ("04", "namespace almesh {\nvoid diagonalise(int n, double* A, double* V);\n}\n"
           "void part(double* A) { almesh::diagonalise(2, A, A + 4); }\n", "calls diagonalise"),
    ("04", 'void taken(int n, double* A, double* V) asm("_ZN6almesh11diagonaliseEiPdS0_");\n'
           "void part(double* A) { taken(2, A, A + 4); }\n", "has asm"),
    ("04", "[[gnu::no_sanitize_address]] void past(double* a) { a[1] = 0; }\n", "has no_sanitize_address"),
    ("04", '#define UNSEEN(of) __attribute__((no_sanitize(of)))\n'
           'UNSEEN("address") void past(double* a) { a[1] = 0; }\n', "has no_sanitize"),
    ("04", 'extern "C" void __asan_report_store8(unsigned long) {}\n', "has __asan_report_store8"),
    ("12", '#include "lessons/exercises/12.hpp"\n#define OF distortion\n'
           "double eta(const almesh::Mat<2>& F) { return almesh::OF <2>(F, 0.0); }\n", "calls distortion"),
]


def lesson(number):
    return next(lesson for lesson in LESSONS if lesson.name.startswith(number))


def rows_of(number, source, build, numbers=None):
    """Those of the exercises in `numbers`, or all, for answers that are the text `source`."""
    with tempfile.TemporaryDirectory(prefix="almesh-wrong-") as name:
        path = Path(name) / f"{number}.cpp"
        path.write_text(source)
        decks = lesson(number) / "solutions"
        answers = Answers(lesson(number), path, decks, build, f"wrong-{number}-{os.getpid()}")
        rows = check(answers, LIMITS, numbers)
        remove(answers.program)
        return rows


def remove(program):
    for path in (program, program.with_name(program.name + ".made")):
        path.unlink(missing_ok=True)


def template(number):
    return (ROOT / "src" / "lessons" / "exercises" / f"{number}.cpp").read_text()


def expect_rows(name, rows, says, failures, holds=False):
    """Each row does not hold and says so, or each holds."""
    for row in rows:
        if row.holds != holds or says not in row.message:
            failures.append(f"{name}: {row.number} {'holds' if row.holds else row.message}, expected "
                            f"{says or ('that it holds' if holds else 'a reason')}")
    whole_table(rows, failures)


def test_attacks(build):
    failures = []
    for name, before, says in ATTACKS:
        expect_rows(name, rows_of("01", before + template("01"), build, ["1.1", "1.5"]), says, failures)
    for include in INCLUDES:
        rows = rows_of("01", include + template("01"), build)
        expect_rows(include, rows, f'includes "{SOLUTION}"', failures)
    for number, before, says in BORROWED:
        expect_rows(before, rows_of(number, before + solved(lesson(number))[0], build), says, failures)
    in_function = FORGED + with_line("1.3", "forge(); _Exit(0);")
    rows = rows_of("01", in_function, build)
    expect_rows("_Exit in a function", [row for row in rows if row.number == "1.3"], "ends the whole program", failures)
    expect_rows("beside it", [row for row in rows if row.number != "1.3"], "", failures, holds=True)
    rows = rows_of("04", with_line("4.5", "try { f1(-1); } catch (...) {}"), build, ["4.5"])
    expect_rows("catches what a callback says", rows, "a derivative is called where f is infinite or nan", failures)
    rows = rows_of("01", SYSTEM + with_line("1.3", SENDING), build, ["1.3"])
    expect_rows("sends a result itself, and never ends", rows, ", expected ", failures)
    if os.geteuid() != 0:  # who may open all memory
        rows = rows_of("01", SYSTEM + with_line("1.5", INTRUDING), build, ["1.5"])
        expect_rows("opens the judge's memory", rows, "", failures, holds=True)
    return len(ATTACKS) + len(INCLUDES) + len(BORROWED) + 3 + (os.geteuid() != 0), failures


def with_line(number, line, source=None):
    """The solution with a line at the beginning of that exercise's function."""
    of = lesson(number.split(".")[0].zfill(2))
    text, place = source or solved(of)[0], functions(of)[number]
    return f"{text[:place]}\n    {line}\n{text[place:]}"


def test_memory(build):
    """Writes past the end, which the other tests of these exercises do not see."""
    failures = []
    if not sanitizers(build):
        return 0, failures
    source, _ = solved(lesson("03"))
    past = re.sub(r"(std::vector<double> g\(2 \* nodes, 0\.0\);)", r"\1\n    g.data()[2 * nodes] = 0;", source, count=1)
    rows = rows_of("03", past, build)
    expect_rows("3.3 past the end", [row for row in rows if row.number == "3.3"], "writes memory", failures)
    expect_rows("beside it", [row for row in rows if row.number != "3.3"], "", failures, holds=True)
    rows = rows_of("04", with_line("4.4", "H.value.data()[H.value.size()] = 0;"), build)
    expect_rows("4.4 past the end", [row for row in rows if row.number == "4.4"], "writes memory", failures)
    rows = rows_of("04", with_line("4.4", "const int n = 2147483647 - fixed[0]; g[0] += n + 2 * fixed[0];"), build)
    expect_rows("4.4 overflows", [row for row in rows if row.number == "4.4"], "what C++ does not define", failures)
    return 3, failures


def test_kept(build):
    """An older template over good answers, and back: the text decides, not the time of the file."""
    failures = []
    with tempfile.TemporaryDirectory(prefix="almesh-wrong-") as name:
        answers = Answers(lesson("01"), Path(name) / "01.cpp", Path(name), build, "wrong-kept")
        for text, holds in ((solved(lesson("01"))[0], True), (template("01"), False), (solved(lesson("01"))[0], True)):
            answers.source.write_text(text)
            os.utime(answers.source, (0, 0))
            expect_rows("kept", check(answers, LIMITS), "", failures, holds)
        remove(answers.program)
    with tempfile.TemporaryDirectory(prefix="almesh-own-") as name:
        source, target = Path(name) / "01.cpp", Path(name) / "01.o"
        made = []
        for text in ("int a() { return 1; }\n", "int a() { return 2; }\n"):
            source.write_text(text)
            os.utime(source, (0, 0))
            made.append(own.compiled(source, target, ["c++"], []).read_bytes())
        if made[0] == made[1]:
            failures.append("own.py takes an object that was made of another text")
    return 4, failures


def test_header(failures):
    """A header that comes with the answers is noticed."""
    with tempfile.TemporaryDirectory(prefix="almesh-wrong-") as name:
        header = Path(name) / "src" / "lessons" / "exercises" / "01.hpp"
        header.parent.mkdir(parents=True)
        said = []
        git = ["git", "-c", "user.name=a", "-c", "user.email=a@b"]
        for text in ("#pragma once\n", '#include "lessons/solutions/01.cpp"\n'):
            header.write_text(text)
            for words in () if said else (["init", "-q"], ["add", "."], ["commit", "-qm", "a"]):
                subprocess.run([*git, *words], cwd=name, check=True)
            said.append(changed_header(lesson("01"), name))
    if said[0] or "01.hpp is not the course's" not in said[1]:
        failures.append(f"a header that is not the committed one: {said}")
    return 1


# ------------------------------------------------------------------------------------------- what does not compile

# (what is done to the solution of lesson 1, the exercises that do not hold, what they say)
ALL = [f"1.{k}" for k in range(1, 7)]
MISTAKES = [
    ("a mistake in a function", lambda s: with_line("1.3", "this is no C++;", s), ["1.3"], "does not compile"),
    ("two mistakes", lambda s: with_line("1.3", "int a = b;", with_line("1.5", "return c;", s)), ["1.3", "1.5"],
     "was not declared|undeclared"),
    ("no such function", lambda s: with_line("1.3", "extern int nowhere(); nowhere();", s), ["1.3"], "nowhere"),
    ("a head that does not compile", lambda s: s.replace("double eta_3d(const", "doubel eta_3d(const"), ["1.3"],
     "doubel"),
    ("other arguments", lambda s: s.replace("double eta_3d(const Mat<3>& F)", "double eta_3d(Mat<3> F)"), ["1.3"],
     "no function eta_3d"),
    ("a brace missing", lambda s: with_line("1.3", "{", s), ["1.3"], "brace"),
    ("a brace too many", lambda s: s.replace("double stretch_of", "}\n\ndouble stretch_of"), ["1.4"], "brace"),
    ("a brace missing at the end", lambda s: re.sub(r"\}(\s*\}[^}]*)$", r"\1", s), ["1.6"], "brace"),
    ("no semicolon", lambda s: with_line("1.4", "double a = 1", s), ["1.4"], "expected"),
    ("nothing", lambda s: "", ALL, "there is no function"),
    ("outside of functions", lambda s: s + "\nint = 3;\n", ALL, "does not compile"),
    ("a header that is not there", lambda s: "#include <nowhere>\n" + s, ALL,
     "nowhere"),
]


def test_mistakes(build):
    failures = []
    source, _ = solved(lesson("01"))
    for name, change, numbers, says in MISTAKES:
        changed = change(source)
        if changed == source:
            failures.append(f"{name}: nothing is changed in the solution")
        for row in rows_of("01", changed, build):
            if row.holds == (row.number in numbers) or not (row.holds or re.search(says, row.message)):
                failures.append(f"{name}: {row.number} {row.message or 'holds'}")
    return len(MISTAKES), failures


def test_definitions(failures):
    """Functions are found in all that the course has, each with braces that match."""
    for path in sorted((ROOT / "src" / "lessons").rglob("*.cpp")):
        text = path.read_text()
        found = definitions(text)
        lines = re.findall(r"^(?!class|struct|enum|namespace|public)\w[^;{}()=]*\([^;{}]*\)[^;{}()]*\{", text, re.M)
        if len(found) < len(lines) or not all(function.is_whole for function in found):
            failures.append(f"{path}: {len(found)} functions, expected {len(lines)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    build, failures = (ROOT / parser.parse_args().build).resolve(), []
    os.environ.setdefault("SEED", "1")
    test_definitions(failures)
    headers = test_header(failures)
    sanitizers(build)  # before each process tries which there are
    with ProcessPoolExecutor(min(4, os.cpu_count() or 1)) as pool:
        done = [pool.submit(test, build) for test in (test_attacks, test_mistakes, test_memory, test_kept)]
        counts, found = zip(*(one.result() for one in done))
    failures += [failure for each in found for failure in each]
    mistakes, attacks = counts[1], headers + sum(counts) - counts[1]
    print(f"{attacks} attacks on a grade and {mistakes} mistakes that do not compile: " + (
        f"{len(failures)} FAILURES" if failures else "each is refused with its reason, and spoils no other"))
    print("\n".join(failures), file=sys.stderr, end="\n" if failures else "")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

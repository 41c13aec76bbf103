"""Compiles the answers to a lesson into a shared object, which the judge's children load, and links the judge.

What is compiled is what the preprocessor gives, after foreign.py has looked at it. A function that does not compile is
replaced by a call of almesh_absent(), so that the others can be graded. Standard library only.
"""
import re
import resource
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from definitions import definitions
from foreign import (LIBRARY, RELOCATED, UNWATCHED, closure, foreign_file, own_part, refused_symbol, symbols,
                     without_texts)
from running import (MEGABYTE, NO_UNDEFINED, ROOT, WATCHED, back, compiler, digest, keep, kept, of_built, run,
                     sanitizers, shown, text_of)

TESTS = ROOT / "tests" / "lessons"


# ------------------------------------------------------------------------------------------------- answers

@dataclass
class Compiled:
    failure: str = ""                            # why there is no shared object, "" where there is one
    absent: list = field(default_factory=list)   # of each function that does not compile the reason
    missing: dict = field(default_factory=dict)  # of those that are left out by name


class Refused(Exception):
    pass


@dataclass
class Source:
    """An answer on its way to the compiler."""
    path: Path
    number: str
    text: str
    build: Path

    @property
    def header(self):
        return f"lessons/exercises/{self.number}.hpp"

    @property
    def flags(self):
        sanitize = sanitizers(self.build)
        return ["-D_GLIBCXX_ASSERTIONS", "-g1", *sanitize, *(WATCHED if sanitize else [])]

    def errors_in(self, log):
        """[(line, or None; what is said)]"""
        found, place = [], None
        for line in text_of(log).splitlines():
            at = re.search(r"<stdin>:(\d+)", line)
            place = int(at[1]) if at else place
            if re.search(r"\berror:|undefined reference|multiple definition", line):
                said = line.replace(f"{ROOT}/", "").replace("<stdin>", str(shown(self.path)))
                found.append((place, re.sub(r"^\S*ld: ", "", said)))
                place = None
            elif found and found[-1][0] is None and at:
                found[-1] = (place, found[-1][1])
        return found or [(None, (text_of(log).splitlines() or ["no reason given"])[0])]

    def step(self, command, folder, seconds, given=None):
        """None, or errors."""
        log = folder / "log"
        with log.open("wb") as output:
            code = run(command, ROOT, seconds, [(resource.RLIMIT_FSIZE, 512 * MEGABYTE)], output, given)
        if code is None:
            raise Refused(f"takes more than {seconds} s to compile")
        return None if code == 0 else self.errors_in(log)

    def compile(self, text, folder, seconds, target):
        """The shared object of the text; errors, or None."""
        command = compiler(self.build, read_once=False)
        (folder / "text").write_text(text)
        with (folder / "text").open() as given:
            files = ["-MD", "-MF", folder / "files", "-iquote", self.path.parent]
            errors = self.step([*command, *self.flags, *files, "-E", "-x", "c++", "-", "-o", folder / "plain"], folder,
                               seconds, given)
        if (folder / "files").is_file():
            self.refuse_file((folder / "files").read_text(errors="replace"), tuple(command))
        if errors:
            return errors
        code = (folder / "plain").read_text(errors="replace")
        self.refuse_words(own_part(code))
        first = '# 1 "<stdin>"\n'  # after what the compiler puts before every file
        declared = code.replace(first, f'extern "C" [[noreturn]] void almesh_absent(int);\n{first}', 1)
        (folder / "answers.ii").write_text(declared)
        errors = self.step([*command, *self.flags, "-x", "c++-cpp-output", "-c", folder / "answers.ii", "-o",
                            folder / "answers.o"], folder, seconds)
        if errors:
            return errors
        if reason := refused_symbol(folder / "answers.o", self.header):
            raise Refused(reason)
        return self.step([*command, *self.flags, "-shared", *NO_UNDEFINED, folder / "answers.o", *self.objects,
                          *self.placeholders(folder / "answers.o"), "-o", target], folder, seconds)

    @property
    def objects(self):
        return [self.build / "tests" / "lessons" / f"{self.number}_registry.o", self.build / "libalmesh.a"]

    def placeholders(self, obj):
        """For functions of the exercises that are not defined."""
        wanted = [name for name in symbols(self.objects[0], "-u") if "6almesh7lessons" in name]
        there = set(symbols(obj, "--defined-only"))
        return [f"-Wl,--defsym={name}=almesh_missing" for name in wanted if name not in there]

    def refuse_file(self, dependencies, command):
        if path := foreign_file(dependencies, self.header, command):
            name = str(shown(path)).removeprefix("src/")
            raise Refused(f'includes "{name}": an answer stands on the standard library and on {self.number}.hpp')

    def refuse_words(self, code):
        code = without_texts(code)
        if found := LIBRARY.search(code):
            raise Refused(f"calls {found[1].strip(' <')}, which is the library's: write what it does yourself")
        if found := UNWATCHED.search(code):
            raise Refused(f"has {found[1]}: an answer is written in C++ alone, and the sanitizers watch it")


def compile_answers(path, number, build, target, seconds):
    """The answers in the file `path` as the shared object `target`."""
    if not path.is_file():
        return Compiled(f"{shown(path)} is missing: {back(shown(path))}")
    source = Source(path, number, text_of(path, MEGABYTE), build)
    if RELOCATED.search(source.text.replace("\\\n", "")):
        return Compiled(f"{shown(path)} says that its lines are those of another file (#line)")
    tools = [Path(__file__).with_name(f"{name}.py") for name in ("compiling", "foreign", "definitions")]
    key = digest(source.text, str(path), *compiler(build, read_once=False), *source.flags, *closure(source.header),
                 *map(of_built, source.objects), *tools)
    if found := kept(target, key):
        return Compiled("", found["absent"], found["missing"])
    target.parent.mkdir(parents=True, exist_ok=True)
    target.unlink(missing_ok=True)
    try:
        with tempfile.TemporaryDirectory(prefix="almesh-compile-") as folder:
            result = compile_parts(source, Path(folder), seconds, target)
    except Refused as reason:
        return Compiled(f"{shown(path)} {reason}")
    if not result.failure:
        keep(target, key, absent=result.absent, missing=result.missing)
    return result


def compile_parts(source, folder, seconds, target):
    """Compiles; where functions do not, the others."""
    functions = definitions(source.text)
    reasons = {}                      # of functions without their bodies, in the order in which they are found
    gone = {}                         # of those of which even the head does not compile
    for function in functions:
        if not function.is_whole:
            reasons[function] = "a brace is missing, or there is one too many"
    unfinished = dict(reasons)
    for _ in range(12):
        errors = source.compile(rewritten(source.text, list(reasons), gone), folder, seconds, target)
        if not errors:
            name = shown(source.path)
            return Compiled("", [f"{name} does not compile: {reasons[function]}" for function in reasons],
                            {function.name: f"{name} does not compile: {reason}" for function, reason in gone.items()})
        if not spread(errors, functions, reasons, gone):
            break
    first = next(iter(unfinished.values()), None) or errors[0][1]
    return Compiled(f"{shown(source.path)} does not compile: {first}")


def spread(errors, functions, reasons, gone):
    """Puts each function with an error among those to be left out; False where there is none that could be."""
    found, before = False, {*reasons}
    for line, said in errors:
        function = next((f for f in functions if line and f.first <= line <= f.last), None)
        if function is None or function in gone:
            continue
        if function in before:
            gone[function], found = reasons[function], True
        elif function not in reasons:
            reasons[function], found = said, True
    return found


def rewritten(text, absent, gone):
    """The text with calls of almesh_absent() for bodies; lines stay where they are."""
    for function in sorted([*absent], key=lambda f: -f.start):
        lines = "\n" * text.count("\n", function.start if function in gone else function.body, function.end)
        if function in gone:
            text = text[:function.start] + lines + text[function.end:]
        else:
            text = text[:function.body] + f"{{ almesh_absent({absent.index(function)});{lines}}}" + text[function.end:]
    return text


# ------------------------------------------------------------------------------------------------- judges

def judge(number, build):
    """The program that judges a lesson's answers."""
    objects = [build / "tests" / "lessons" / f"{name}.o" for name in (f"{number}_check", "exercise", "child")]
    parts, target = [*objects, build / "libalmesh.a"], build / "lessons" / f"judge-{number}"
    command = [*compiler(build, read_once=False), *sanitizers(build), *parts, "-ldl", "-o", target]
    key = digest(*map(str, command), *map(of_built, parts))
    if not kept(target, key):
        target.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run(command, cwd=ROOT, check=True)
        keep(target, key)
    return target


def names_of_answers(number):
    """What a lesson's check file lists as answers: for the Makefile, which compiles registry.cpp with them."""
    text = (TESTS / f"{number}_check.cpp").read_text()
    members = [f"{kind}::{name.strip()}" for kind, names in re.findall(r"^MEMBER_ANSWERS\((\w+),([^)]*)\)", text, re.M)
               for name in names.split(",")]
    functions = [name.strip() for names in re.findall(r"^ANSWERS\(([^)]*)\)", text, re.M) for name in names.split(",")]
    return ", ".join(functions + members)

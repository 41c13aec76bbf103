"""What the course's scripts share: commands with limits, the compiler, and programs that are kept.

A program is kept beside a hash of all that it is made of, texts, objects and flags; times of files play no part.
Standard library only.
"""
import ctypes
import hashlib
import json
import os
import resource
import shlex
import signal
import subprocess
import sys
import tempfile
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
MEGABYTE = 1 << 20
NO_UNDEFINED = ["-Wl,--no-undefined"] if sys.platform == "linux" else []
SANITIZERS = [["-fsanitize=address,undefined"], ["-fsanitize=address,undefined", "-shared-libasan"], []]
WATCHED = ["-fno-sanitize-recover=all", "-fno-sanitize=null,alignment,vptr"]
# Signals stay signals, so that they have the same sentences with and without sanitizers.
SIGNALS = ("segv", "sigbus", "abort", "sigfpe", "sigill")
SANITIZING = {"ASAN_OPTIONS": ":".join(["detect_leaks=0", *(f"handle_{name}=0" for name in SIGNALS)])}
PERSONALITY = getattr(ctypes.CDLL(None), "personality", None) if sys.platform == "linux" else None
ADDRESSES_ARE_NOT_RANDOM = 0x0040000
# Of the trial: a function in a shared object, and a program that loads it.
OBJECT = """extern "C" [[gnu::visibility("default")]] int a(const int* p, int i) { return p[i] + i; }
"""
LOADER = """#include <dlfcn.h>
int main(int count, char** words) {
    void* const a = dlsym(dlopen(words[1], RTLD_NOW), "a");
    const int two[2] = {count, count};
    return a ? reinterpret_cast<int (*)(const int*, int)>(a)(two, 1) : 7;
}
"""


def environment():
    return {**os.environ, **SANITIZING, "OMP_NUM_THREADS": "1", "LC_ALL": "C"}


def run(command, folder, seconds, limits=None, output=None, given=None):
    """The exit code (negative: a signal; None: took too long). Nothing that it has started goes on."""
    def prepare():
        if PERSONALITY:
            PERSONALITY(ADDRESSES_ARE_NOT_RANDOM)  # where it may: another run has the same addresses
        for kind, most in limits or []:
            later = 2 if kind == resource.RLIMIT_CPU else 0  # first SIGXCPU, then SIGKILL
            resource.setrlimit(kind, (most, most + later))
    process = subprocess.Popen(command, cwd=folder, stdin=given or subprocess.DEVNULL, stdout=output,
                               stderr=subprocess.STDOUT, env=environment(), preexec_fn=prepare, start_new_session=True)
    try:
        return process.wait(seconds)
    except subprocess.TimeoutExpired:
        return None
    finally:
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        process.wait()


def text_of(path, most=20000):
    with path.open("rb") as file:
        return file.read(most).decode(errors="replace").replace("\0", "?")


def shown(path):
    return path.relative_to(ROOT) if path.is_relative_to(ROOT) else path


def back(name):
    """How to get a template again: a student's export has no git."""
    return (f"`git checkout {name}` brings the template back" if (ROOT / ".git").exists() else
            "get the template again from where the course came from")


def compiler(build, read_once=True):
    """The Makefile's command for what waits for the library: it optimises little, and reads once what most files
    include of the standard library."""
    flags, prefix = shlex.split((build / "flags").read_text()), build / "prefix" / "waiting.hpp"
    little = ["-O1"] if {"-O2", "-O3"} & set(flags) else []
    once = ["-include", prefix] if read_once and prefix.with_suffix(".hpp.gch").exists() else []
    return [*flags, "-Wno-error", *little, *once]


# ------------------------------------------------------------------------------------------------- what is kept

def digest(*parts):
    """Of texts, and of the contents of files."""
    found = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, Path) else str(part).encode()
        found.update(len(data).to_bytes(8, "little") + data)
    return found.hexdigest()


def of_built(path):
    """The digest of what make has built, read once."""
    state = path.stat()
    return digest_of(path, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=None)
def digest_of(path, *_):
    return digest(path)


def kept(target, key):
    """What was noted beside the program `target`, if it was made of the same; otherwise None."""
    try:
        noted = json.loads(target.with_name(target.name + ".made").read_text())
        return noted if noted["key"] == key and noted["itself"] == digest(target) else None
    except (OSError, ValueError, KeyError):
        return None


def keep(target, key, **notes):
    target.with_name(target.name + ".made").write_text(json.dumps({"key": key, "itself": digest(target), **notes}))


@lru_cache(maxsize=None)
def sanitizers(build):
    """Flags with which a shared object can be loaded and is watched; none where the compiler has no such thing."""
    command = compiler(build, read_once=False)
    note, key = build / "lessons" / "sanitizers", digest(*command)
    note.parent.mkdir(parents=True, exist_ok=True)
    if found := kept(note, key):
        return found["flags"]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "a.cpp").write_text(OBJECT)
        (folder / "m.cpp").write_text(LOADER)
        for flags in SANITIZERS:
            made = all(run([*command, *flags, *more], folder, 60, output=subprocess.DEVNULL) == 0 for more in (
                [*WATCHED, "-shared", *NO_UNDEFINED, "a.cpp", "-o", "a.so"], ["m.cpp", "-ldl", "-o", "m"]))
            load = [folder / "m", "./a.so"]  # some sanitizers cannot bear all of the random addresses
            if made and all(run(load, folder, 60, output=subprocess.DEVNULL) == 3 for _ in range(10)):
                break
    note.write_text(shlex.join(flags) + "\n")
    keep(note, key, flags=flags)
    return flags

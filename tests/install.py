#!/usr/bin/env python3
"""Installs almesh into a folder, uses what is there, and nothing else, and uninstalls it: `make test-install`.

  tests/install.py [--qemu] [--dist] [MAKE'S ARGUMENTS ...]    BUILD=build-test CXXFLAGS=-O2

Clients in C and C++ are built by pkg-config, Python's use what is installed and a wheel, the library shows the functions
of almesh.h alone, the meshes of a client are those of the program to the last bit, the manual page has no warnings.
--qemu: the client runs on a Nehalem, as an emulator has it (qemu-user), built with PORTABLE=1; the C library has other
last digits of pow() there, which these decks do not see. --dist: the tarball is unpacked and builds the program without
git.
Standard library only.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DECKS = ["circle", "cells/circle", "curving", "targets/flap"]
CLIENT = r"""
#include <almesh.h>
#include <stdio.h>
int main(int argc, char **argv) {
    almesh_mesh *mesh;
    int code = almesh_read_deck(argv[1], &mesh);
    if (!code) code = almesh_move(mesh);
    if (!code) code = almesh_save(mesh, argv[2]);
    if (code) fprintf(stderr, "%s\n", almesh_error());
    return argc == 3 ? code : 1;
}
"""


PYTHON = "import almesh, sys; m = almesh.read_deck(sys.argv[1]); assert m.move().certified; m.save(sys.argv[2])"


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          **options)
    if done.returncode:
        sys.exit(f"tests/install.py: {' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def demand(holds, what):
    if not holds:
        sys.exit(f"tests/install.py: {what}")


def in_wheel(work, library):
    """The environment of an empty one of Python into which the wheel was installed, without a network."""
    wheel = run(sys.executable, ROOT / "packaging/wheel.py", library, "0", work).strip()
    run(sys.executable, "-m", "venv", "--without-pip", work / "venv")
    packages = run(work / "venv/bin/python", "-c", "import site; print(site.getsitepackages()[0])").strip()
    run(sys.executable, "-m", "pip", "install", "-q", "--no-index", "--no-deps", "--target", packages, wheel)
    return {**os.environ, "PYTHONPATH": packages}


def files_of(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir())


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--qemu", action="store_true")
    parser.add_argument("--dist", action="store_true")
    parser.add_argument("make", nargs="*")
    options = parser.parse_args()
    portable = ["PORTABLE=1"] if options.qemu else []
    make = ["make", "-s", "-C", ROOT, *portable, *options.make]
    work = Path(tempfile.mkdtemp(prefix="almesh-install-"))
    prefix = work / "tree"
    try:
        run(*make, "install", f"PREFIX={prefix}")
        installed = files_of(prefix)
        lib = prefix / "lib"
        shown = re.findall(r" [A-TV-Z] (\S+)", run("nm", "-D", "--defined-only", lib / "libalmesh.so"))
        header = set(re.findall(r"\b(almesh_\w+)\(", (prefix / "include/almesh.h").read_text()))
        demand(set(shown) == header, f"libalmesh.so and almesh.h differ: {sorted(set(shown) ^ header)}")
        demand("libalmesh.so.0" in run("readelf", "-d", lib / "libalmesh.so"), "no soname")

        environment = {**os.environ, "PKG_CONFIG_PATH": str(lib / "pkgconfig"), "LD_LIBRARY_PATH": str(lib)}

        def flags(package):
            return run("pkg-config", "--cflags", "--libs", package, env=environment).split()

        examples = prefix / "share/almesh/examples"
        (work / "client.c").write_text(CLIENT)
        for source, program in ((work / "client.c", "client"), (examples / "shapes.c", "shapes")):
            run("cc", "-std=c99", "-Wall", "-Wextra", "-Werror", source, *flags("almesh"), "-lm", "-o", program,
                cwd=work)
        shutil.copytree(examples, work / "examples")
        run("c++", "-std=c++20", "examples/first.cpp", "-I.", *flags("almesh-c++"), "-o", "first", cwd=work)
        demand("certified valid and injective" in run("./first", cwd=work), "the client in C++")
        said = run("./shapes", examples / "circle.msh", work, 3, cwd=work, env=environment)
        demand("3 shapes made" in said, f"shapes: {said}")
        run(prefix / "bin/almesh", examples / "circle.deck", cwd=work)

        under = ["qemu-x86_64", "-cpu", "Nehalem"] if options.qemu else []
        decks = DECKS[:3] if options.qemu else DECKS  # sin() of the last one is the processor's
        for deck in decks:
            path = ROOT / "inputs" / (deck + ".deck")
            said = run(*under, "./client", path, "client.msh", cwd=work, env=environment)
            demand(said == "", f"the library has printed: {said}")
            run(prefix / "bin/almesh", path, f"output={work}/out", cwd=work)
            demand((work / "client.msh").read_bytes() == (work / "out/final.msh").read_bytes(), f"{deck}: other bits")

        module = [sys.executable, "-c", PYTHON, ROOT / "inputs/circle.deck", "module.msh"]
        run(*module, cwd=work, env={**os.environ, "PYTHONPATH": str(prefix / "share/almesh/python")})
        run(*module[:-1], "out/circle.msh", cwd=work, env=in_wheel(work, lib / "libalmesh.so"))
        run(prefix / "bin/almesh", ROOT / "inputs/circle.deck", f"output={work}/out", cwd=work)
        for mesh in ("module.msh", "out/circle.msh"):
            demand((work / mesh).read_bytes() == (work / "out/final.msh").read_bytes(), f"{mesh}: other bits")

        page = prefix / "share/man/man1/almesh.1"
        if shutil.which("groff"):
            demand(run("groff", "-ww", "-man", "-Tutf8", "-z", page) == "", "warnings of groff")
        completion = f"source {prefix}/share/bash-completion/completions/almesh; COMP_CWORD=2; " \
                     f"COMP_WORDS=({prefix}/bin/almesh a.deck omega_s); _almesh; echo ${{COMPREPLY[@]}}"
        demand(run("bash", "-c", completion) == "omega_star=\n", "completion")

        run(*make, "uninstall", f"PREFIX={prefix}")
        demand(files_of(prefix) == [], f"left after uninstall: {files_of(prefix)}")
        for goal in ("install", "uninstall"):
            done = subprocess.run([*map(str, make), goal, f"PREFIX={work}/a b"], capture_output=True, text=True)
            demand(done.returncode and "have no blanks" in done.stderr, f"{goal} with a blank in PREFIX")
        run(*make, "install", f"DESTDIR={work}/stage", "PREFIX=/usr")
        demand(files_of(work / "stage/usr") == installed, "DESTDIR has other files")
        demand(str(work) not in (work / "stage/usr/lib/pkgconfig/almesh.pc").read_text(), "almesh.pc has DESTDIR")
        if options.dist:
            run(*make, "dist")
            tarball = next(ROOT.glob("almesh-*.tar.gz"))
            run("tar", "-xf", tarball, "-C", work)
            source = next(work.glob("almesh-[0-9]*"))
            run("make", "-s", "-C", source, "almesh", *options.make)
            commit = run("git", "-C", ROOT, "rev-parse", "--short", "HEAD").strip()
            demand(commit in run(source / "almesh", "--version"), "the tarball does not know its commit")
        print(f"{len(installed)} files installed, used and removed; {len(shown)} functions; {len(decks)} decks with "
              f"the bits of the program{' on the baseline' * options.qemu}")
    finally:
        shutil.rmtree(work)


if __name__ == "__main__":
    main()

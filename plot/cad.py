"""What the tables of CAD meshes share: gmsh in a process of its own, its optimisers, almesh and its certificate."""
import contextlib
import gzip
import lzma
import re
import shutil
import subprocess
import sys
import time

import runs

ROOT = runs.OUTPUTS.parent
UNPACK = {".gz": gzip.decompress, ".xz": lzma.decompress}
# gmsh's option Mesh.HighOrderOptimize
OPTIMISERS = {1: ["HighOrder"], 2: ["HighOrderElastic", "HighOrder"], 3: ["HighOrderElastic"],
              4: ["HighOrderFastCurving"]}


def start_gmsh(**numbers):
    """The module gmsh, on one thread and without its messages; numbers: those that its scripts define."""
    import gmsh
    gmsh.initialize(["gmsh", *(word for name, value in numbers.items() for word in ("-setnumber", name, str(value)))])
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    return gmsh


def unpacked(file, folder):
    """The file, or what it has compressed, written into the folder."""
    if file.suffix not in UNPACK:
        return file
    plain = folder / file.stem
    plain.write_bytes(UNPACK[file.suffix](file.read_bytes()))
    return plain


def optimise(gmsh, optimiser):
    """Its seconds; 0: none. gmsh fails where it leaves elements worse than it aims at: the mesh is what it left."""
    start = time.perf_counter()
    with contextlib.suppress(Exception):
        for method in OPTIMISERS.get(optimiser, []):
            gmsh.model.mesh.optimize(method)
    return time.perf_counter() - start


def in_process(script, function, *arguments, limit):
    """(exit code, words that `script --function arguments` prints, last line of its errors); the code is None where it
    takes longer than the limit in seconds."""
    command = [sys.executable, script, "--" + function.__name__, *map(str, arguments)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=limit)
    except subprocess.TimeoutExpired:
        return None, [], f"over {limit} s"
    return done.returncode, done.stdout.split(), (done.stderr.splitlines() or [f"exit code {done.returncode}"])[-1]


def certificate(mesh):
    """(elements, number of those not certified as text, or "overlaps") by `almesh quality`."""
    text = subprocess.run([ROOT / "almesh", "quality", mesh], capture_output=True, text=True).stdout
    elements = sum(map(int, re.findall(r"(\d+) (?:tetrahedra|hexahedra|prisms|pyramids)", text.split("\n")[0])))
    found = re.search(r"NOT certified valid: (.*);", text)
    if found:  # "3 elements proved invalid, 1 undecided"
        return elements, str(sum(int(count) for count in re.findall(r"\d+", found[1])))
    return elements, "0" if "\ncertified injective" in text else "overlaps"


def run_almesh(mesh, output, settings, limit):
    """With a fixed boundary, on one thread, results in the folder `output`: (exit code, summary, seconds of the
    process). The code is None where it takes longer than the limit in seconds, the summary where there is none."""
    deck = output.with_suffix(".deck")
    deck.write_text(f"mesh = {mesh}\noutput = {output}\nboundary all = fixed\nthreads = 1\nvtk = none\n")
    shutil.rmtree(output, ignore_errors=True)
    start = time.perf_counter()
    try:
        code = subprocess.run([ROOT / "almesh", deck, *settings], capture_output=True, timeout=limit).returncode
    except subprocess.TimeoutExpired:
        code = None
    seconds = time.perf_counter() - start
    return code, runs.summary(output) if (output / "summary.txt").exists() else None, seconds

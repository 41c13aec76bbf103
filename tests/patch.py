#!/usr/bin/env python3
"""The file that came in is the file that goes out: for each mesh file in some folders that is valid,

  1. with every boundary fixed (ideal = given) the final mesh is the same file, to the last byte;
  2. sheared by its boundary it differs from the file only in coordinates: in text, numbers with a decimal form between
     the lines that begin and end the nodes, in binary, bytes of that part, in a file of the same length; of VTU all
     arrays but the points are the same, and all text but their coding and the offsets;
  3. that one, read again, is certified.

  tests/patch.py [--program ./almesh] [--most BYTES] [--seconds N] [--all] PATH ...    files, or folders with them

--most: larger files are left out; --seconds: of a run at most (60); --all: list those that are left out, too. A file is
left out where `almesh quality` does not certify it, and from 2 and 3 where the run does not converge; both are counted.
Exit code 1 where one of the three does not hold. Standard library only.
"""
import argparse
import base64
import re
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

ENDINGS = {ending: ending for ending in (".msh", ".su2", ".inp", ".vtu")} | {".vtk": "-mesh.vtk"}  # of final meshes
# Where nodes begin and end; the numbers behind are what may differ.
NODES = {".msh": (rb"\$(?:Nodes|ParametricNodes|NOD)\s", rb"\$(?:EndNodes|EndParametricNodes|ENDNOD)"),
         ".su2": (rb"NPOIN\s*=", rb"(?:\n\s*[A-Z_]+\s*=|\Z)"),
         ".inp": (rb"(?mi)^[ \t]*\*NODE[ \t]*(?:,[^\n]*)?\n", rb"(?m)^[ \t]*\*[A-Za-z]"),
         ".vtk": (rb"\nPOINTS\s", rb"\n\s*(?:CELLS|CELL_TYPES|FIELD|METADATA|POINT_DATA|CELL_DATA)\s")}
NUMBER = rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?"


def parts_of(text, ending):
    """What is outside of the nodes, with their places marked, and the nodes."""
    begin, end = NODES[ending]
    outside, inside, at = [], [], 0
    for found in re.finditer(begin, text):
        if found.end() < at:
            continue
        stop = re.compile(end).search(text, found.end())
        stop = stop.start() if stop else len(text)
        outside.append(text[at:found.end()])
        inside.append(text[found.end():stop])
        at = stop
    return outside + [text[at:]], inside


def is_binary(text):
    return b"BINARY" in text[:600] or re.match(rb"\s*\$MeshFormat\s+[\d.]+ 1 ", text) is not None


def vtu_arrays(text):
    """The text without arrays and offsets, and the bytes of each array that is not the points."""
    head, _, rest = text.partition(b"<AppendedData")
    data = rest[rest.find(b"_") + 1:]
    number = "<Q" if b'header_type="UInt64"' in head else "<I"
    size = struct.calcsize(number)
    is_compressed = b"vtkZLibDataCompressor" in head

    def take(block, count, is_text):
        length = (count + 2) // 3 * 4 if is_text else count
        return (base64.b64decode(block[:length]) if is_text else block[:count])[:count], block[length:]

    def array(block, is_text):
        first = struct.unpack(number, take(block, size, is_text)[0])[0]
        if not is_compressed:
            return take(block, size + first, is_text)[0][size:]
        header, block = take(block, (3 + first) * size, is_text)
        lengths = [value[0] for value in struct.iter_unpack(number, header)][3:]
        block = take(block, sum(lengths), is_text)[0]
        return b"".join(zlib.decompress(block[sum(lengths[:k]):sum(lengths[:k + 1])]) for k in range(first))

    arrays = []
    for found in re.finditer(rb"<DataArray([^>]*)>([^<]*)", head):
        if head.rfind(b"<Points", 0, found.start()) > head.rfind(b"</Points", 0, found.start()):
            continue
        if offset := re.search(rb'offset="(\d+)"', found[1]):
            arrays.append(array(data[int(offset[1]):], b'"base64"' in rest[:100]))
        else:
            arrays.append(array(found[2].strip(), True) if b'format="binary"' in found[1] else found[2])
    return re.sub(rb"(?<=>)[^<]*", b"", re.sub(rb'offset="\d+"', b"", head)), arrays


def difference(before, after, ending):
    """Why the files do not differ in coordinates alone, or ""."""
    if ending == ".vtu":
        return "" if vtu_arrays(before) == vtu_arrays(after) else "more differs than the points"
    outside, inside = parts_of(before, ending)
    outside_after, inside_after = parts_of(after, ending)
    if is_binary(before):
        places = [len(part) for part in outside + inside] == [len(part) for part in outside_after + inside_after]
        return "" if places and outside == outside_after else "bytes outside of the nodes differ, or the length"
    if outside != outside_after:
        return "text outside of the nodes differs"
    for a, b in zip(inside, inside_after):
        if re.split(NUMBER, a) != re.split(NUMBER, b):
            return "text between the numbers of nodes differs"
        for x, y in zip(re.findall(NUMBER, a), re.findall(NUMBER, b)):
            if x != y and float(x.lower().replace(b"d", b"e")) == float(y):
                return f"{x.decode()} is written as {y.decode()}"
    return ""


class Checker:
    def __init__(self, program, seconds):
        self.program, self.seconds = Path(program).resolve(), seconds
        self.folder = tempfile.TemporaryDirectory()

    def run(self, *arguments):
        return subprocess.run([str(self.program), *map(str, arguments)], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace")

    def moved(self, path, motion):
        """The final mesh of a run, and its exit code and last line."""
        folder = Path(self.folder.name)
        output = folder / "out"
        deck = folder / "patch.deck"
        deck.write_text(f"mesh = {path.resolve()}\nboundary all = {motion}\nideal = given\nvtk = none\n"
                        f"output = {output}\nmax_seconds = {self.seconds}\n")
        for old in output.glob("final*"):
            old.unlink()
        done = self.run(deck)
        final = output / ("final" + ENDINGS[path.suffix])
        last = (done.stdout.strip().splitlines() or [""])[-1]
        return final if final.exists() else None, done.returncode, last

    def is_solid(self, path):
        return re.search(r"tetrahedr|hexahedr|prism|pyramid", self.run("info", path).stdout) is not None

    def check(self, path):
        """A word on the file, and whether it is a fault."""
        if self.run("quality", path).returncode != 0:
            return "not certified as it is", False
        before = path.read_bytes()
        final, code, last = self.moved(path, "fixed")
        if final is None or code not in (0, 3, 4):
            return f"cannot be run: {last}", False
        if final.read_bytes() != before:
            return "with every boundary fixed other bytes come back", True
        final, code, last = self.moved(path, 'expression "x + 0.05*y" "y"' + (' "z"' if self.is_solid(path) else ""))
        if final is None or code != 0:
            return f"the same bytes; not moved: {last}", False
        after = final.read_bytes()
        if after == before:
            return "nothing has moved", True
        if why := difference(before, after, path.suffix):
            return why, True
        if self.run("quality", final).returncode != 0:
            return "what was certified is not when it is read again", True
        return "", False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=Path(__file__).resolve().parent.parent / "almesh")
    parser.add_argument("--most", type=int)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("path", nargs="+", type=Path)
    options = parser.parse_args()
    checker = Checker(options.program, options.seconds)
    files = sorted(file for path in options.path for file in (path.rglob("*") if path.is_dir() else [path])
                   if file.suffix in ENDINGS and (options.most is None or file.stat().st_size <= options.most))
    good, faults, left_out = 0, 0, 0
    for file in files:
        word, is_fault = checker.check(file)
        good += not word
        faults += is_fault
        left_out += bool(word) and not is_fault
        if is_fault or (word and options.all):
            print(f"{file}: {word}", flush=True)
    print(f"patch: {good} files come back, the same and moved; {left_out} left out; {faults} faults")
    return 1 if faults or not good else 0


if __name__ == "__main__":
    sys.exit(main())

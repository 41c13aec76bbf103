#!/usr/bin/env python3
"""One HTML file of a run's results, which opens in a browser without a network: the mesh, turned and zoomed with the
mouse, its frames, its worst elements and the tables.

  plot/page.py [RESULTS ...]     writes RESULTS/page.html of each folder of results; outputs/circle where none is named
  plot/page.py --fetch           only fetches three.js into ~/.cache/almesh, for a machine that will have no network

The page is viewer/page.html with its scripts, three.js, and the nodes, faces and cell data of the meshes put into it. A
face with nodes x_a of degree p > 1 is drawn as small triangles with corners x = sum_a N_a x_a. Nodes are rounded to a
2000th of the shortest edge of a cell. Python's standard library only, and npm once: it fetches three.js.
"""
import base64
import gzip
import hashlib
import html
import io
import json
import os
import re
import subprocess
import sys
import tarfile
from array import array
from math import dist
from pathlib import Path

import page_tables
import vtk_file

HERE = Path(__file__).resolve().parent
THREE = "three-0.185.0"
THREE_SHA512 = "+yRrcRO2iZa8uzvNNl0d7cL4huhgKgBvVJ0njcTe8xFqZ6DMAFZdCKDP91SEAuj25bNAj7k1QQdf+srZywVK6w=="
THREE_FILES = {"three-core": "build/three.core.min.js", "three": "build/three.module.min.js",
               "orbit-controls": "examples/jsm/controls/OrbitControls.js"}
MOST_NUMBERS = 15_000_000  # of all frames; of more only every second, third, ... is shown

# What cell data mean: name, explanation, whether the largest (1) or the least (-1) are the worst.
FIELDS = {
    "distortion": ("distortion η", "compared with the initial mesh; no unit, 1: undistorted", 1),
    "quality": ("quality 1/η", "no unit, 1: undistorted, 0: flat", -1),
    "scaled_jacobian": ("scaled Jacobian", "the least at a corner of the straight cell; no unit, 1: regular", -1),
    "certified_bound": ("certified bound", "of det J in the whole element; no unit, above 0: proved valid", -1),
    "element_id": ("element id", "as in final.msh", 1),
}


class PageError(Exception):
    """There is no page of this folder; the text says why and what to do."""


# ------------------------------------------------------------------------------------------------------------ three.js

def fetch(path):
    """Has npm put three.js there. Raises PageError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        run = subprocess.run(["npm", "pack", "--silent", THREE.replace("-", "@")], cwd=path.parent, capture_output=True,
                             text=True, timeout=300)
        reason = (run.stderr.strip() or "it wrote no file").splitlines()[0]
    except FileNotFoundError:
        reason = "npm is missing"
    except subprocess.TimeoutExpired:
        reason = "no answer in five minutes"
    if not path.exists():
        raise PageError(f"npm could not fetch the viewer, {THREE} ({reason}): install npm, run `plot/page.py --fetch`"
                        f" once with a network, or put {path.name} of the npm registry into {path.parent}")


def three_files():
    """{name: text} of THREE_FILES, from the cache; npm fetches them once."""
    path = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "almesh" / f"{THREE}.tgz"
    if not path.exists():
        fetch(path)
    data = path.read_bytes()
    if base64.b64encode(hashlib.sha512(data).digest()).decode() != THREE_SHA512:
        raise PageError(f"{path} is not the file that this script knows (another SHA-512): delete it and run this anew")
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        return {name: archive.extractfile(f"package/{file}").read() for name, file in THREE_FILES.items()}


# ----------------------------------------------------------------------------------------------------------- the frames

def frame_files(folder):
    """[(label, path, time)] of the meshes to show, the kind of the series, and the number of the first one shown."""
    for name, label, first in (("frames", page_tables.TIME, 0), ("iterates", "Newton step {:g}", -1)):
        if (series := folder / f"{name}.vtk.series").exists():
            files = json.loads(series.read_text())["files"]
            if files:
                found = [(entry["time"], folder / entry["name"]) for entry in files]
                return [(label.format(time), path, time) for time, path in found], name, first
    files = [(name, path, None) for name in ("initial", "final") if (path := folder / f"{name}.vtk").exists()]
    if files:
        return files, "meshes", -1
    if not folder.is_dir():
        raise PageError(f"{folder}: there is no such folder; `./almesh DECK` writes one for each deck")
    deck = folder / "deck.txt"
    if deck.exists() and re.search(r"^vtk\s*=\s*none", deck.read_text(), re.M):
        raise PageError(f"{folder} has no VTK files, for its deck has `vtk = none`: run it again with vtk=binary")
    raise PageError(f"{folder} has no mesh to show (frames.vtk.series, iterates.vtk.series, initial.vtk or final.vtk): "
                    "name the folder that a run gives as that of its results")


def read_frames(files):
    """[(label, VtkFile)] and their times, all with the cells of the last; and what was left out."""
    last = vtk_file.read(files[-1][1])
    size = len(files) * (len(last.points) + len(last.types) * len(last.cell_data))
    stride = -(-size // MOST_NUMBERS)
    chosen = files[::-1][::stride][::-1]
    frames = [(label, vtk_file.read(path), time) for label, path, time in chosen[:-1]]
    frames.append((files[-1][0], last, files[-1][2]))
    same = [frame for frame in frames if frame[1].cells == last.cells and len(frame[1].points) == len(last.points)]
    notes = [f"one frame of every {stride}"] * (stride > 1)
    notes += [f"{len(frames) - len(same)} frames with other cells left out"] * (len(same) < len(frames))
    return [frame[:2] for frame in same], [frame[2] for frame in same], ", ".join(notes)


# ---------------------------------------------------------------------------------------------------------------- faces

def lagrange(k, p, x):
    """prod_{s < k} (p x - s)/(s + 1); the function of a node is the product of those of its barycentric indices."""
    value = 1.0
    for s in range(k):
        value *= (p * x - s) / (s + 1)
    return value


def basis(corners, p, has_centre, u, v):
    """Values of the functions of a face's nodes, in the order of vtk_file.lattice(), at the point (u, v)."""
    nodes = vtk_file.lattice(corners, p)
    if corners == 3:
        return [lagrange(a, p, u) * lagrange(b, p, v) * lagrange(p - a - b, p, 1 - u - v) for a, b in nodes]
    along, up = ([lagrange(a, p, s) * lagrange(p - a, p, 1 - s) for a in range(p + 1)] for s in (u, v))
    values = [along[a] * up[b] for a, b in nodes]
    if not has_centre:  # a serendipity face: half the sum of the edges' nodes less a quarter of the corners
        centre = values.pop(4)
        values = [value + centre * (0.5 if k in (1, 3, 4, 6) else -0.25) for k, value in enumerate(values)]
    return values


def face_kind(corners, p, count, faces):
    """How such faces are drawn: the values of their functions at points, triangles and an outline between these, the
    places of the corners, the functions in the middle. An edge has as many parts as give a million triangles in all."""
    n = 1 if p == 1 else min(max(p, int((1e6 / faces) ** 0.5)), 16)
    points = vtk_file.lattice(corners, n)
    at = {point: k for k, point in enumerate(points)}
    triangles, outline = [], []
    for u, v in points:
        for triangle in ([(u, v), (u + 1, v), (u, v + 1)], [(u + 1, v), (u + 1, v + 1), (u, v + 1)]):
            triangles += [at[corner] for corner in triangle] if all(corner in at for corner in triangle) else []
    ring = [(0, 0), (n, 0), (0, n)] if corners == 3 else [(0, 0), (n, 0), (n, n), (0, n)]
    for a, b in zip(ring, ring[1:] + ring[:1]):
        line = [at[a[0] + (b[0] - a[0]) * s // n, a[1] + (b[1] - a[1]) * s // n] for s in range(n + 1)]
        outline += [end for pair in zip(line, line[1:]) for end in pair]
    middle = (1 / 3, 1 / 3) if corners == 3 else (1 / 2, 1 / 2)
    is_full = count == len(vtk_file.lattice(corners, p))
    values = [value for u, v in points for value in basis(corners, p, is_full, u / n, v / n)]
    return {"nodes": count, "points": len(points), "basis": values, "triangles": triangles, "outline": outline,
            "corners": [0, p, count - 1, count - 1 - p][:corners], "middle": basis(corners, p, is_full, *middle)}


def all_faces(vtk):
    """[(kind of face_kind(), faces)], the faces one after the other: two elements, or one and -1, and the nodes."""
    known, kinds, first = {}, {}, {}
    at, cells = 0, vtk.cells
    for element, vtk_type in enumerate(vtk.types):
        count = cells[at]
        if vtk_type not in vtk_file.CELLS:
            raise PageError(f"cells of VTK's type {vtk_type} cannot be drawn")
        if (vtk_type, count) not in known:
            known[vtk_type, count] = vtk_file.faces_of(vtk_type, count)
        faces, p = known[vtk_type, count]
        for corners, places in faces:
            nodes = [cells[at + 1 + k] for k in places]
            vertices = tuple(sorted(nodes[k] for k in (0, p, -1, -1 - p)[:corners]))
            if other := first.pop(vertices, None):
                other[1] = element
                continue
            first[vertices] = face = [element, -1, *nodes]
            kinds.setdefault((corners, p, len(nodes)), []).append(face)
        at += count + 1
    return [(face_kind(*kind, len(faces)), faces) for kind, faces in kinds.items()]


# ------------------------------------------------------------------------------------------------------------- the data

def shortest_edge(vtk, kinds):
    """Between corners that are neighbours in the outline of a face."""
    node = list(zip(*[iter(vtk.points)] * 3))
    lengths = [dist(node[face[2 + a]], node[face[2 + b]]) for kind, faces in kinds for face in faces
               for a, b in zip(kind["corners"], kind["corners"][1:] + kind["corners"][:1])]
    return min(filter(None, lengths), default=1.0)


class Blob:
    """Numbers one after the other, four bytes each."""

    def __init__(self):
        self.parts, self.count = [], 0

    def add(self, kind, values):
        """Where the values are: the first, and how many."""
        values = array(kind, values)
        if sys.byteorder == "big":
            values.byteswap()
        self.parts.append(values.tobytes())
        self.count += len(values)
        return [self.count - len(values), len(values)]

    def add_rows(self, rows):
        """Whole numbers, each row less the one before: these compress well."""
        before, found = [0] * len(rows[0]), []
        for row in rows:
            found.extend(a - b for a, b in zip(row, before))
            before = row
        return self.add("i", found)


def field(name, frames, blob):
    """Cell data of this name in each frame, with its explanation; null in a frame that does not have it."""
    title, text, worst = FIELDS.get(name, (name.replace("_", " "), "cell data of the VTK files", 1))
    values = [vtk.cell_data.get(name) for _, vtk in frames]
    places = []
    for k, value in enumerate(values):
        same = k > 0 and value == values[k - 1]
        places.append(places[-1] if same else value and blob.add("f", value))
    return {"name": name, "title": title, "text": text, "worst": worst, "values": places}


def mesh_data(frames):
    """What the browser needs to draw, and its numbers."""
    blob, last = Blob(), frames[-1][1]
    kinds = all_faces(last)
    ends = frames[0][1], last
    low = [min(min(vtk.points[k::3]) for vtk in ends) for k in range(3)]
    high = [max(max(vtk.points[k::3]) for vtk in ends) for k in range(3)]
    size = dist(low, high) or 1.0
    step = max(min(shortest_edge(vtk, kinds) for vtk in ends) / 2000, size / 2**30)
    centre = [(a + b) / 2 for a, b in zip(low, high)]
    rows = [[round((x - centre[k % 3]) / step) for k, x in enumerate(vtk.points)] for _, vtk in frames]
    for kind, faces in kinds:
        kind["faces"] = blob.add_rows(faces)
    dim = 2 if all(len(vtk_file.CELLS[vtk_type][2]) == 1 for vtk_type in set(last.types)) else 3
    names = [name for name, value in last.cell_data.items() if len(value) == len(last.types)]
    data = {"dim": dim, "centre": centre, "step": step, "size": size, "elements": len(last.types),
            "labels": [label for label, _ in frames], "nodes": blob.add_rows(rows),
            "kinds": [kind for kind, _ in kinds], "fields": [field(name, frames, blob) for name in names]}
    return data, b"".join(blob.parts)


# ------------------------------------------------------------------------------------------------------------- the page

def with_scripts(title, data):
    """viewer/page.html with its scripts, and these two texts."""
    text, *code = ((HERE / "viewer" / name).read_text()
                   for name in ("page.html", "scene.js", "marks.js", "curves.js", "panels.js"))
    for mark, put in (("title", title), ("scripts", "\n".join(code)), ("data", data)):
        text = text.replace(f"<!-- {mark} -->", put)
    return text


def write_page(folder):
    """Writes page.html into the folder; returns a line that says what is in it."""
    files, series, first = frame_files(folder)
    frames, times, notes = read_frames(files)
    parts = three_files()
    data, parts["numbers"] = mesh_data(frames)
    title = frames[-1][1].title.rsplit(", ", 1)[0]
    state, is_good = page_tables.state(folder)
    data |= {"first": first % len(frames), "notes": notes, "state": state, "isGood": is_good,
             "tables": page_tables.tables(folder), "keys": page_tables.explanations(),
             "rows": page_tables.frame_rows(folder, data["labels"]), "frameColumns": page_tables.FRAMES,
             "curves": page_tables.curves(folder, series, times, frames)}
    parts["data"] = json.dumps(data, separators=(",", ":")).encode()
    packed = {name: base64.b64encode(gzip.compress(part, 6, mtime=0)).decode() for name, part in parts.items()}
    scripts = "\n".join(f'<script type="text/plain" id="{name}">{text}</script>' for name, text in packed.items())
    page = with_scripts(html.escape(title), scripts)
    (folder / "page.html").write_text(page)
    what = f"{len(frames)} {series}, {data['elements']} elements, {len(page) / 1e6:.1f} MB"
    return f"{folder / 'page.html'}: {what}" + (notes and f" ({notes})")


def main():
    try:
        for name in sys.argv[1:] or ["outputs/circle"]:
            print(write_page(Path(name)) if name != "--fetch" else f"{THREE}: {len(three_files())} files")
    except (PageError, ValueError, OSError) as error:
        sys.exit(f"plot/page.py: {error}")


if __name__ == "__main__":
    main()

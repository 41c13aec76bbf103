#!/usr/bin/env python3
"""The solids that OpenCASCADE and gmsh ship as examples, meshed coarsely, curved and mended, in one table.

  plot/cad_examples.py          the same as `make cad-examples`: all of them, outputs/cad-examples/table.md
  plot/cad_examples.py NAME...  those whose names contain one of the words

Needs gmsh's Python module (Debian: python3-gmsh) and the geometries (Debian: occt-misc, gmsh-doc). Edges are a twelfth
of the bounding box's diagonal, down to a quarter of that, in degree 2 and 3: too coarse for many of these shapes, on
purpose. Every mesh that gmsh makes is run as it is (`local_repair = 1`), and where that does not end certified again with
`surface = straighten`, each on one thread with LIMIT seconds. Exit code 1 where a run ended as something that the
program does not tell by its exit code.
"""
import gzip
import math
import re
import shutil
import subprocess
import sys
from pathlib import Path

import runs

ROOT = runs.OUTPUTS.parent
FOLDER = runs.OUTPUTS / "cad-examples"
OPENCASCADE = Path("/usr/share/opencascade/data")
GMSH = Path("/usr/share/doc/gmsh-doc/doc/gmsh/demos")
LIMIT = 30
MESHING = 100  # seconds
EDGES = 12     # along the diagonal of the bounding box
SETTINGS = {"local_repair = 1": ["local_repair=1"], "surface = straighten": ["surface=straighten"]}
TOLD = {0, 2, 3, 4}  # certified, refused, not converged, not certified


def geometries():
    """{name: file}."""
    files = [*OPENCASCADE.glob("occ/*.brep"), *OPENCASCADE.glob("step/*.step"), *GMSH.glob("*/*.st*p.gz")]
    return {file.name.split(".")[0]: file for file in sorted(files)}


def make(source, degree, path):
    """In a process of its own: writes the mesh. Exit code 2 where there is no solid."""
    import gmsh
    if source.endswith(".gz"):
        unpacked = Path(path).with_suffix(".step")
        unpacked.write_bytes(gzip.decompress(Path(source).read_bytes()))
        source = str(unpacked)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    if source.endswith(".brep"):
        gmsh.model.occ.importShapes(source, format="brep")
        gmsh.model.occ.synchronize()
    else:
        gmsh.open(source)
    solids = gmsh.model.getEntities(3)
    if not solids:
        sys.exit(2)
    box = gmsh.model.getBoundingBox(-1, -1)
    size = math.dist(box[:3], box[3:]) / EDGES
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size / 4)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in solids])
    gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getBoundary(solids, oriented=False)])
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(int(degree))
    gmsh.write(path)


def outcome(mesh, settings):
    """(exit code, text for the table) of one run."""
    output = mesh.with_suffix("")
    deck = mesh.with_suffix(".deck")
    deck.write_text(f"mesh = {mesh.name}\noutput = {output}\nboundary all = fixed\nthreads = 1\nvtk = none\n"
                    f"max_seconds = {LIMIT}\n")
    shutil.rmtree(output, ignore_errors=True)
    code = subprocess.run([ROOT / "almesh", deck, *settings], capture_output=True, timeout=5 * LIMIT).returncode
    summary = output / "summary.txt"
    if not summary.exists():
        return code, "refused"
    values = dict(line.split(" = ", 1) for line in summary.read_text().splitlines())
    text = f"eta {float(values['max_distortion']):.3g}; " if code == 0 else f"{values['status']}, exit code {code}; "
    if int(values["straight_faces"]):
        text += f"{values['straight_faces']} faces flat; "
    if float(values["boundary_distance"]):
        text += f"faces off by {100 * float(values['relative_boundary_distance']):.2g} % of an edge; "
    return code, text + f"{float(values['time_run']):.2g} s"


def main(words):
    chosen = {name: file for name, file in geometries().items() if not words or any(word in name for word in words)}
    FOLDER.mkdir(parents=True, exist_ok=True)
    lines = ["| solid, degree | elements | invalid | " + " | ".join(SETTINGS) + " |", "|---" * 5 + "|"]
    print("\n".join(lines))
    certified, meshes, untold = [0, 0], 0, 0
    for name, file in chosen.items():
        for degree in (2, 3):
            mesh = FOLDER / f"{name}-degree-{degree}.msh"
            command = [sys.executable, __file__, "--make", file, str(degree), mesh]
            try:
                if subprocess.run(command, capture_output=True, timeout=MESHING).returncode != 0:
                    continue
            except subprocess.TimeoutExpired:
                continue
            quality = subprocess.run([ROOT / "almesh", "quality", mesh], capture_output=True, text=True).stdout
            elements = re.search(r"(\d+) tetrahedra", quality)[1]
            invalid = re.search(r"NOT certified valid: (.*);", quality)
            count = sum(map(int, re.findall(r"\d+", invalid[1]))) if invalid else 0
            cells = ["", ""]
            meshes += 1
            for k, settings in enumerate(SETTINGS.values()):
                code, cells[k] = outcome(mesh, settings)
                untold += code not in TOLD
                if code == 0:
                    certified[k] += 1
                    break
            lines.append(f"| {name}, {degree} | {elements} | {count} | " + " | ".join(cells) + " |")
            print(lines[-1], flush=True)
    lines.append(f"\n{meshes} meshes: {certified[0]} certified by sliding, {certified[1]} more with flat faces")
    print(lines[-1])
    (FOLDER / "table.md").write_text("\n".join(lines) + "\n")
    return 1 if untold else 0


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1] == "--make":
        make(*sys.argv[2:])
    else:
        sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""CAD models meshed, curved and certified by default, beside gmsh's high-order optimisers, in one table.

  plot/cad_models.py PATH...   folders and files; the same as `make cad-models MODELS=folder`
  --only WORD          models whose names contain it (may be repeated, like the next)
  --deck 'key = value' a line for the deck
  --edges 20           edges along the diagonal of the bounding box
  --turn 8             edges along a full turn of a curved surface; 0: as many as the other gives
  --degrees 2,3        degrees of the meshes
  --limit 30           seconds for every run and every optimiser
  --largest 25000      tetrahedra of a mesh; larger ones are left out
  --no-gmsh            without gmsh's optimisers
  --keep               take the meshes that an earlier run left
  --output cad-models  folder of the results, in outputs/: table.md and table.csv

Takes STEP, BREP and gmsh's GEO files, also with .gz or .xz, from anywhere in a folder, each content once. It needs
gmsh's Python module (Debian: python3-gmsh). Sizes go down to a quarter of the largest. A model without solids, or one
that gmsh does not mesh within MESHING seconds, is left out. Everything runs on one thread. Columns:

  invalid    elements of the mesh as gmsh curves it that `almesh quality` does not certify; "overlaps" where it
             certifies them all, but not that the mesh is injective
  straight   the same of the mesh with straight sides: where it is not 0, that is why a run ends without certificate
  result     the status of the default run with the boundary fixed; bold where it is not certified
  flat, slid faces made flat, nodes that slid along the surface
  distance   the largest of the final boundary from that of the mesh as it came, and over the longest edge of the face
  gmsh N     elements left invalid by its option Mesh.HighOrderOptimize = N: 1 optimisation, 2 elastic analogy, then
             optimisation, 4 fast curving; seconds of the optimiser

Exit code 1 where a run ended as something that the program does not tell by its exit code.
"""
import argparse
import csv
import math
import re
import signal
import sys
from pathlib import Path

import cad
import runs

MESHING = 100  # seconds
KINDS = {".step", ".stp", ".brep", ".brp", ".geo"}
OPTIMISERS = (1, 2, 4)
TOLD = {0, 2, 3, 4}  # certified, refused, not converged, not certified
COLUMNS = ["model", "degree", "tetrahedra", "invalid", "straight", "code", "status", "certified", "seconds", "flat",
           "slid", "distance", "distance/edge",
           *(f"gmsh {k} {what}" for k in OPTIMISERS for what in ("invalid", "seconds"))]


def plain(file):
    return Path(file.stem) if file.suffix in cad.UNPACK else Path(file.name)


def kind(file):
    return plain(file).suffix.lower()


def models(paths):
    """{name: file}; two files of the same name have that of their folder in front."""
    found = (file for path in paths for file in (path.rglob("*") if path.is_dir() else [path]) if kind(file) in KINDS)
    files = {file.read_bytes(): file for file in sorted(found, reverse=True)}.values()
    stems = [plain(file).stem for file in files]
    names = [stem if stems.count(stem) == 1 else f"{file.parent.name}-{file.name}" for stem, file in zip(stems, files)]
    return {re.sub(r"[^\w-]", "-", name): file for name, file in sorted(zip(names, files))}


# ---------------------------------------------------------------- in a process of its own: gmsh

def groups(gmsh):
    """One of all solids and one of their boundary, but for groups of volumes that the model has itself."""
    own = gmsh.model.getPhysicalGroups()
    solids = gmsh.model.getEntities(3)
    if not any(dim == 3 for dim, _ in own):
        gmsh.model.removePhysicalGroups()
        own = []
        gmsh.model.addPhysicalGroup(3, [tag for _, tag in solids])
    if not any(dim == 2 for dim, _ in own):
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getBoundary(solids, oriented=False)])


def make(source, degree, edges, turn, largest, optimiser, limit, path):
    """Writes the mesh with straight sides and the curved one, the latter optimised unless `optimiser` is 0; prints the
    seconds of that."""
    gmsh = cad.start_gmsh()
    file, path = Path(source), Path(path)
    if kind(file) in {".brep", ".brp"}:  # named otherwise, gmsh takes it for a script
        gmsh.model.occ.importShapes(str(cad.unpacked(file, path.parent)), format="brep")
        gmsh.model.occ.synchronize()
    else:
        gmsh.open(str(cad.unpacked(file, path.parent)))
    solids = gmsh.model.getEntities(3)
    if not solids:
        sys.exit("no solid")
    box = gmsh.model.getBoundingBox(-1, -1)
    size = math.dist(box[:3], box[3:]) / float(edges)
    for option, value in (("Max", size), ("Min", size / 4), ("FromCurvature", float(turn))):
        gmsh.option.setNumber("Mesh.MeshSize" + option, value)
    groups(gmsh)
    gmsh.model.mesh.generate(3)
    of_solids = [sum(map(len, gmsh.model.mesh.getElements(3, tag)[1])) for _, tag in solids]
    if 0 in of_solids:
        sys.exit("gmsh leaves a solid without elements")
    if sum(of_solids) > int(largest):
        sys.exit(f"{sum(of_solids)} elements")
    if optimiser == "0":
        gmsh.write(str(straight(path)))
    gmsh.model.mesh.setOrder(int(degree))
    signal.alarm(int(limit))  # ends the process wherever it is
    print(cad.optimise(gmsh, int(optimiser)))
    signal.alarm(0)
    gmsh.write(str(path))


# ---------------------------------------------------------------- the table

def straight(mesh):
    return mesh.with_suffix(".straight.msh")


def row_of(name, file, degree, options, folder):
    """{column: text} of a mesh; a text where there is none."""
    def made(optimiser, mesh):
        return cad.in_process(__file__, make, file.resolve(), degree, options.edges, options.turn, options.largest,
                              optimiser, options.limit, mesh, limit=MESHING + bool(optimiser) * options.limit)

    mesh = folder / f"{name}-{degree}.msh"
    if not (options.keep and mesh.exists()):
        code, _, message = made(0, mesh)
        if code != 0:
            return message
    elements, invalid = cad.certificate(mesh)
    code, summary, _ = cad.run_almesh(mesh, mesh.with_suffix(""), [f"max_seconds={options.limit}", *options.deck],
                                      5 * options.limit)
    row = {"model": name, "degree": degree, "tetrahedra": elements, "invalid": invalid,
           "straight": cad.certificate(straight(mesh))[1], "code": code, "status": "refused" if code == 2 else "ended",
           "certified": "yes" if code == 0 else "no"}
    if summary is not None:
        row |= {"status": summary["status"], "seconds": f"{float(summary['time_run']):.2g}",
                "flat": summary["straight_faces"], "slid": summary["freed_nodes"],
                "distance": f"{float(summary['boundary_distance']):.2g}",
                "distance/edge": f"{float(summary['relative_boundary_distance']):.2g}"}
    for k in OPTIMISERS if options.gmsh else ():
        optimised = folder / f"{name}-{degree}-gmsh-{k}.msh"
        code, words, _ = made(k, optimised)
        row[f"gmsh {k} invalid"] = cad.certificate(optimised)[1] if code == 0 else "-"
        row[f"gmsh {k} seconds"] = f"{float(words[-1]):.2g}" if code == 0 else ""
    return row


def line_of(row, optimisers):
    """The row as that of a table in Markdown."""
    status = row["status"] + (f" ({row['code']})" if row["certified"] == "no" else "")
    cells = [f"{row['model']}, {row['degree']}", *(row[c] for c in ("tetrahedra", "invalid", "straight")),
             status if row["certified"] == "yes" else f"**{status}**",
             *(row.get(c, "") for c in ("seconds", "flat", "slid", "distance", "distance/edge")),
             *(f"{row[f'gmsh {k} invalid']}; {row[f'gmsh {k} seconds']} s".replace("-;  s", "-") for k in optimisers)]
    return "| " + " | ".join(map(str, cells)) + " |"


def parsed(words):
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("paths", nargs="+", type=Path)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--deck", action="append", default=[])
    parser.add_argument("--edges", type=float, default=20)
    parser.add_argument("--turn", type=float, default=8)
    parser.add_argument("--degrees", type=lambda text: [int(word) for word in text.split(",")], default=[2, 3])
    parser.add_argument("--limit", type=int, default=30)
    parser.add_argument("--largest", type=int, default=25000)
    parser.add_argument("--no-gmsh", dest="gmsh", action="store_false")
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--output", default="cad-models")
    return parser.parse_args(words)


def main(words):
    options = parsed(words)
    folder = runs.OUTPUTS / options.output
    folder.mkdir(parents=True, exist_ok=True)
    optimisers = OPTIMISERS if options.gmsh else ()
    headings = ["model, degree", "tetrahedra", "invalid", "straight", "result", "seconds", "flat", "slid", "distance",
                "distance/edge", *(f"gmsh {k}" for k in optimisers)]
    rows = []
    with (folder / "table.md").open("w") as table, (folder / "table.csv").open("w", newline="") as text:
        def tell(line):
            print(line, flush=True)
            print(line, file=table, flush=True)

        writer = csv.DictWriter(text, COLUMNS)
        writer.writeheader()
        tell("| " + " | ".join(headings) + " |\n" + "|---" * len(headings) + "|")
        for name, file in models(options.paths).items():
            if options.only and not any(word in name for word in options.only):
                continue
            for degree in options.degrees:
                row = row_of(name, file, degree, options, folder)
                if isinstance(row, str):
                    print(f"{name}, {degree}: left out, {row}", file=sys.stderr, flush=True)
                    continue
                rows.append(row)
                writer.writerow(row)
                text.flush()
                tell(line_of(row, optimisers))
        certified = sum(row["certified"] == "yes" for row in rows)
        reason = sum(row["certified"] == "no" and row["straight"] != "0" for row in rows)
        tell(f"\n{certified} certified of {len(rows)} meshes; {reason} not, and neither are they with straight sides; "
             f"{len(rows) - certified - reason} not, though they are with straight sides")
    return 0 if all(row["code"] in TOLD for row in rows) else 1


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1] == "--make":
        make(*sys.argv[2:])
    else:
        sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""Other programs read what almesh has patched: VTK's readers, gmsh and meshio, each where it is installed.

Meshes of inputs/ and of gmsh are written by gmsh, VTK and meshio in their formats, with arrays, sets and tags. almesh
moves each as a whole, so that every node has one place to go to: the final mesh is the file with other coordinates. A
program reads the file before and after: the cells, arrays, sets and entities are the same, and the nodes have moved.

  tests/judges.py [--program ./almesh] [--keep FOLDER] [WORD ...]    only files with a word in their names

Exit code 1 where one does not. Debian: python3-gmsh, python3-meshio, python3-vtk9; numpy."""
import argparse
import contextlib
import importlib.util
import io
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
SHIFT = [0.25, -0.5, 0.125]
NEAR = 2e-3  # of the largest coordinate, inside, where a minimisation takes the nodes; outside they move exactly
MODULES = {name: importlib.util.find_spec(name) is not None for name in ("gmsh", "meshio", "vtk")}
FINAL = {".vtk": "final-mesh.vtk"}               # else final with the ending of the file
SOLID = ["inputs/meshes/kinds.msh", "inputs/meshes/cube.msh"]
PLANE = ["inputs/meshes/square.msh", "inputs/meshes/airfoil-quads.msh", "inputs/meshes/bump.msh"]


# ------------------------------------------------------------------------------------------------------------ writers

def start_gmsh():
    import gmsh
    with contextlib.suppress(Exception):
        gmsh.finalize()
    gmsh.initialize(["gmsh"])
    gmsh.option.setNumber("General.Terminal", 0)
    return gmsh


def solid_of_degree(gmsh, degree):
    """A box with a cylindrical hole, with physical groups."""
    gmsh.model.occ.cut([(3, gmsh.model.occ.addBox(-1, -1, 0, 2, 2, 1))],
                       [(3, gmsh.model.occ.addCylinder(0, 0, -1, 0, 0, 3, 0.5))])
    gmsh.model.occ.synchronize()
    surfaces = [tag for _, tag in gmsh.model.getEntities(2)]
    groups = ((2, surfaces[:3], "some"), (2, surfaces[3:], "others"), (3, [1], "the solid"), (0, [1], "corner"))
    for dim, tags, name in groups:
        gmsh.model.setPhysicalName(dim, gmsh.model.addPhysicalGroup(dim, tags), name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(degree)


def by_gmsh(folder):
    for degree in (1, 2, 3):
        for name, version, binary in (("msh2", 2.2, 0), ("msh2-binary", 2.2, 1),
                                      ("msh4", 4.1, 0), ("msh4-binary", 4.1, 1)):
            gmsh = start_gmsh()
            solid_of_degree(gmsh, degree)
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            gmsh.write(str(folder / f"gmsh-{name}-{degree}.msh"))
        if degree < 3:
            gmsh.write(str(folder / f"gmsh-{degree}.inp"))
    gmsh.option.setNumber("Mesh.Binary", 0)
    for path in (ROOT / name for name in (*SOLID[:1], *PLANE[:2])):
        gmsh.clear()
        gmsh.open(str(path))
        for ending in (".su2", ".vtk"):
            gmsh.write(str(folder / f"gmsh-{path.stem}{ending}"))


def by_meshio(folder):
    import meshio
    for path in (ROOT / name for name in (*SOLID, *PLANE[:2])):
        mesh = meshio.read(path)
        top = max(block.dim for block in mesh.cells)
        cells = [block for block in mesh.cells if block.dim == top]
        rng = np.random.default_rng(1)
        arrays = {"temperature": rng.random(len(mesh.points)), "flow": rng.random((len(mesh.points), 3))}
        data = {"region": [np.arange(len(block)) % 3 for block in cells],
                "cost": [rng.random(len(block)) for block in cells]}
        written = meshio.Mesh(mesh.points, cells, arrays, data)
        for name, options in (("vtk51.vtk", {"file_format": "vtk51", "binary": False}),
                              ("vtk51-binary.vtk", {"file_format": "vtk51"}),
                              ("vtk42.vtk", {"file_format": "vtk42", "binary": False}),
                              ("vtk42-binary.vtk", {"file_format": "vtk42"}),
                              ("zlib.vtu", {}), ("plain.vtu", {"compression": None}), ("ascii.vtu", {"binary": False})):
            meshio.write(folder / f"meshio-{path.stem}-{name}", written, **options)
        meshio.write(folder / f"meshio-{path.stem}.msh", mesh, file_format="gmsh22")
        tagged = meshio.Mesh(mesh.points, mesh.cells, cell_data=mesh.cell_data)
        for ending in (".mesh", ".inp")[:1 + (path.stem in ("cube", "square"))]:  # not all cells in .inp
            meshio.write(folder / f"meshio-{path.stem}{ending}", tagged)


def by_vtk(folder):
    import vtk
    for path in sorted(folder.glob("meshio-*-vtk51-binary.vtk")):
        grid = read_grid(path)
        name = path.name.removeprefix("meshio-").removesuffix("-vtk51-binary.vtk")
        for version in (42, 51):
            for binary in (False, True):
                writer = vtk.vtkUnstructuredGridWriter()
                writer.SetFileVersion(version)
                (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
                save(writer, grid, folder / f"vtk-{name}-{version}{'-binary' * binary}.vtk")
        for mode in ("Ascii", "Binary", "Appended"):
            for packed in (False, True):
                for encoded in (False, True)[:1 + (mode == "Appended")]:
                    writer = vtk.vtkXMLUnstructuredGridWriter()
                    getattr(writer, f"SetDataModeTo{mode}")()
                    writer.SetEncodeAppendedData(encoded)
                    (writer.SetCompressorTypeToZLib if packed else writer.SetCompressorTypeToNone)()
                    kind = f"{mode.lower()}{'-encoded' * encoded}{'-zlib' * packed}"
                    save(writer, grid, folder / f"vtk-{name}-{kind}.vtu")


def save(writer, grid, path):
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.Write()


# ------------------------------------------------------------------------------------------------------------- judges
# Each gives the nodes and all else, which is to be the same.

def read_grid(path):
    import vtk
    reader = vtk.vtkXMLUnstructuredGridReader() if path.suffix == ".vtu" else vtk.vtkUnstructuredGridReader()
    if path.suffix == ".vtk":
        for what in ("Scalars", "Vectors", "Normals", "Tensors", "Fields", "ColorScalars", "TCoords"):
            getattr(reader, f"ReadAll{what}On")()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    reader.SetFileName(str(path))
    reader.Update()
    if errors:
        raise ValueError("VTK's reader reports an error")
    return reader.GetOutput()


def judge_vtk(path):
    from vtk.util.numpy_support import vtk_to_numpy
    grid = read_grid(path)
    rest = {"types": vtk_to_numpy(grid.GetCellTypesArray()),
            "cells": vtk_to_numpy(grid.GetCells().GetConnectivityArray()),
            "offsets": vtk_to_numpy(grid.GetCells().GetOffsetsArray())}
    for kind, data in (("point", grid.GetPointData()), ("cell", grid.GetCellData()), ("field", grid.GetFieldData())):
        for k in range(data.GetNumberOfArrays()):
            array = data.GetAbstractArray(k)
            rest[kind, array.GetName()] = vtk_to_numpy(array) if array.IsNumeric() else \
                [array.GetValue(i) for i in range(array.GetNumberOfValues())]
    return vtk_to_numpy(grid.GetPoints().GetData()), rest


def judge_gmsh(path):
    gmsh = start_gmsh()
    gmsh.open(str(path))
    tags, x, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    rest = {"tags": tags[order]}
    for entity in gmsh.model.getEntities():
        rest[entity, "groups"] = list(gmsh.model.getPhysicalGroupsForEntity(*entity))
        rest[entity, "nodes"] = gmsh.model.mesh.getNodes(*entity)[0]
        for kind, of, nodes in zip(*gmsh.model.mesh.getElements(*entity)):
            rest[entity, kind] = np.concatenate([of, nodes])
    for group in gmsh.model.getPhysicalGroups():
        rest[group] = [gmsh.model.getPhysicalName(*group), *gmsh.model.getEntitiesForPhysicalGroup(*group)]
    return x.reshape(-1, 3)[order], rest


def judge_meshio(path):
    import meshio
    with contextlib.redirect_stdout(io.StringIO()):
        mesh = meshio.read(path)
    rest = {("cells", k, block.type): block.data for k, block in enumerate(mesh.cells)}
    for kind in ("point_data", "cell_data", "field_data", "point_sets", "cell_sets"):
        for name, values in getattr(mesh, kind).items():
            parts = values if kind.startswith("cell") else [values]
            rest.update({(kind, name, k): part for k, part in enumerate(parts)})
    return np.pad(mesh.points, ((0, 0), (0, 3 - mesh.points.shape[1]))), rest


# What a program cannot read of files that it has not written, is said when it is asked before almesh has moved them.
JUDGES = {"vtk": (judge_vtk, {".vtk", ".vtu"}), "gmsh": (judge_gmsh, {".msh", ".mesh"}),
          "meshio": (judge_meshio, {".msh", ".su2", ".inp", ".mesh", ".vtk", ".vtu"})}


def differences(before, after):
    """Names of what is not the same."""
    (x, rest), (y, others) = before, after
    found = [str(key) for key in rest.keys() | others.keys()
             if key not in rest or key not in others or not np.array_equal(rest[key], others[key])]
    if x.shape != y.shape or x.dtype != y.dtype:
        return [*found, "nodes"]
    error = abs(y - (x + np.array(SHIFT) * [1, 1, np.ptp(x[:, 2]) > 0])).max(axis=1) / abs(x).max()
    is_outside = ((x == x.min(axis=0)) | (x == x.max(axis=0)))[:, np.ptp(x, axis=0) > 0].any(axis=1)
    precision = 1e-6 if np.array_equal(x, x.astype(np.float32)) else 1e-14
    if error.max() > NEAR or error[is_outside].max() > precision:
        found.append(f"nodes, by {error.max():.1e}, outside by {error[is_outside].max():.1e}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "almesh")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("words", nargs="*")
    options = parser.parse_args()
    missing = [name for name, found in MODULES.items() if not found]
    print("".join(f"{name} is not installed\n" for name in missing), end="")
    faults, agreed, unread = [], {}, []
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(exist_ok=True)
        for name, write in (("gmsh", by_gmsh), ("meshio", by_meshio), ("vtk", by_vtk)):
            if MODULES[name]:
                with contextlib.redirect_stdout(io.StringIO()):
                    write(folder)
        readable = endings_of(options.program.resolve(), folder)
        for path in sorted(folder.glob("*.*")):
            if path.suffix not in readable or (options.words and not any(word in path.name for word in options.words)):
                continue
            final = moved(options.program.resolve(), path, folder / "out")
            if isinstance(final, str):
                faults.append(f"{path.name}: {final}")
                continue
            for name, (judge, endings) in JUDGES.items():
                if not MODULES[name] or path.suffix not in endings:
                    continue
                try:
                    before = judge(path)
                except (Exception, SystemExit) as error:  # as its readers have them
                    unread.append(f"{name} does not read {path.name} as it came: {error!r}")
                    continue
                try:
                    found = differences(before, judge(final))
                except (Exception, SystemExit) as error:
                    found = [repr(error)]
                faults += [f"{path.name}: {name} finds other {', '.join(found)}"] if found else []
                agreed.setdefault((name, path.suffix), []).append(not found)
    print("\n".join(unread + faults))
    for (name, ending), good in sorted(agreed.items()):
        print(f"{name:6} {ending:5} {sum(good)} of {len(good)} files are the same but for the nodes")
    return 1 if faults or not agreed else 0


def endings_of(program, folder):
    """Of the formats that almesh reads, which it lists where it is given another one."""
    (folder / "none").write_text("none")
    done = subprocess.run([program, "info", folder / "none"], stderr=subprocess.PIPE, text=True)
    return re.findall(r"\(\*(\.\w+)\)", done.stderr)


def moved(program, path, output):
    """The final mesh, or what was said."""
    deck = path.with_suffix(".deck")
    info = subprocess.run([program, "info", path], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True).stdout
    dim = 3 if any(f" {cells}" in info for cells in ("tetra", "hexa", "prism", "pyramid")) else 2
    shift = " ".join(map(str, SHIFT[:dim]))
    deck.write_text(f"mesh = {path.resolve()}\nboundary all = translate {shift}\nideal = given\n"
                    f"vtk = none\noutput = {output}\n")
    for old in output.glob("final*"):
        old.unlink()
    done = subprocess.run([program, deck], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    final = output / FINAL.get(path.suffix, "final" + path.suffix)
    if done.returncode == 0 and final.exists():
        return final
    return f"almesh: {(done.stdout.strip().splitlines() or [''])[-1]}"


if __name__ == "__main__":
    sys.exit(main())

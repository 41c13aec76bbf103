#!/usr/bin/env python3
"""CAD parts that CalculiX refuses: gmsh curves coarse second-order tetrahedra until some are invalid, and ccx stops
with `nonpositive jacobian`. almesh mends the user's own file, in which nothing changes but coordinates, and ccx solves
it: `almesh improve`, which makes faces flatter where these are at fault. Beside it, the solution on elements of a third of the size. Exit code 1 where any of this does not hold.
plot/coupling/calculix_parts.py [tee ...]; `make calculix`; Debian: calculix-ccx, python3-gmsh, python3-matplotlib."""
import re
import subprocess
import sys

import clients

clients.need("calculix-ccx python3-gmsh python3-matplotlib", "ccx", "gmsh", "matplotlib")

import gmsh
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import calculix_files as ccx

MATERIAL = "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000, 0.3\n*SOLID SECTION, ELSET=part, MATERIAL=STEEL\n"
STEP = """*STEP
*STATIC
*DSLOAD
pressed, P, 1
*NODE PRINT, NSET=ALL
U
*EL PRINT, ELSET=part
S
*END STEP
"""
cylinder, box = gmsh.model.occ.addCylinder, gmsh.model.occ.addBox


def elbow():
    cut([(2, gmsh.model.occ.addDisk(0, 0, 0, 10, 10))], [(2, gmsh.model.occ.addDisk(0, 0, 0, 7, 7))])
    gmsh.model.occ.revolve(gmsh.model.occ.getEntities(2), 25, 0, 0, 0, 1, 0, -np.pi / 2)


def tee():
    cut([(3, cylinder(-30, 0, 0, 60, 0, 0, 10)), (3, cylinder(0, 0, 0, 0, 0, 25, 7))],
        [(3, cylinder(-31, 0, 0, 62, 0, 0, 8.5)), (3, cylinder(0, 0, 0, 0, 0, 26, 5.5))])


def flange():
    bolts = [(15.5 * np.cos(t), 15.5 * np.sin(t)) for t in np.arange(6) * np.pi / 3]
    cut([(3, cylinder(0, 0, 0, 0, 0, 30, 12)), (3, cylinder(0, 0, 0, 0, 0, 5, 20))],
        [(3, cylinder(0, 0, -1, 0, 0, 40, 10)), *((3, cylinder(x, y, -1, 0, 0, 8, 2.5)) for x, y in bolts)])


def cut(parts, holes):
    body = gmsh.model.occ.fuse(parts[:1], parts[1:])[0] if parts[1:] else parts
    gmsh.model.occ.cut(body, holes)


# The solid, the size of its mesh, which outer faces are clamped and which are under pressure, by their nodes.
PARTS = {"elbow": (elbow, 10, lambda x, y, z: abs(z), lambda x, y, z: np.hypot(np.hypot(x - 25, z) - 25, y) - 7),
         "tee": (tee, 5, lambda x, y, z: x + 30,
                 lambda x, y, z: np.minimum(abs(np.hypot(x, y) - 5.5), abs(np.hypot(y, z) - 8.5))),
         "flange": (flange, 10, lambda x, y, z: z, lambda x, y, z: np.hypot(x, y) - 10)}


def mesh(path, build, size, *where):
    """The .inp as gmsh writes it, with sets, surfaces, material and load."""
    gmsh.clear()
    build()
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.setPhysicalName(3, gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)]), "part")
    gmsh.model.mesh.generate(3)
    gmsh.write(str(path))
    ids, x, numbers, cells = ccx.tetrahedra(path)
    text = re.sub(r"^\*NODE$", "*NODE, NSET=ALL", path.read_text(), flags=re.M) + "** Of the part\n"
    on = [abs(function(*x.T)) < 1e-5 for function in where]
    text += "*NSET, NSET=CLAMPED\n" + ",\n".join(map(str, ids[on[0]])) + "\n"
    for name, nodes in zip(("clamped", "pressed"), on):
        text += f"*SURFACE, NAME={name}\n"
        for k, side in enumerate(ccx.SIDES, 1):
            text += "".join(f"{e}, S{k}\n" for e in numbers[nodes[cells[:, side]].all(axis=1)])
    path.write_text(text + MATERIAL + "*BOUNDARY\nCLAMPED, 1, 3\n" + STEP)


def differs(before, after):
    """Whether anything but coordinates does."""
    (a, x, b), (c, y, d) = (re.split(r"(?<=NSET=ALL\n)([^*]*)", path.read_bytes().decode(), maxsplit=1)
                            for path in (before, after))
    ids = [[line.split(",")[0] for line in part.splitlines()] for part in (x, y)]
    return (a, b, ids[0]) != (c, d, ids[1]) or x == y or re.search(r"[^\d\s.,eE+-]", y)


def mended(folder, name, *command):
    """The final mesh of almesh where it is certified, and its certified bound."""
    done = subprocess.run(["./almesh", *command, f"output={folder}/mesh"], stdout=subprocess.PIPE, text=True)
    bound = re.search(r"^certified valid and injective: certified bound (\S+);", done.stdout, re.M)
    if done.returncode not in (0, 3) or not bound:
        return None
    path = folder / f"{name}.inp"
    path.write_bytes((folder / "mesh" / "final.inp").read_bytes())
    return float(bound[1])


def solved(folder, name):
    """Largest displacement and von Mises stress, and the table of both: displacements, stress of each element."""
    taken, said = ccx.run(folder, name)
    if not taken:
        sys.exit(f"ccx refuses {folder}/{name}.inp:\n{said[-500:]}")
    (_, u), (_, s) = ccx.tables(folder / f"{name}.dat")
    stress = ccx.von_mises(s[:, 2:])
    if not (np.isfinite(u).all() and np.isfinite(s).all() and stress.max() > 0):
        sys.exit(f"{folder}/{name}.dat: no solution")
    return np.linalg.norm(u[:, 1:], axis=1).max(), stress.max(), u, stress.reshape(-1, 4).mean(axis=1)


def draw(ax, x, cells, value, limit, title):
    """The outer faces from (1, -1, 1), each in four triangles, farthest first."""
    faces = np.concatenate([cells[:, side] for side in ccx.SIDES])
    of = np.tile(value, 4)
    _, first, count = np.unique(np.sort(faces[:, :3], axis=1), axis=0, return_index=True, return_counts=True)
    faces, of = faces[first[count == 1]], of[first[count == 1]]
    right, up, to_eye = (np.array(v) / np.linalg.norm(v) for v in ((1, 1, 0), (-1, 1, 2), (1, -1, 1)))
    order = np.argsort(x[faces[:, :3]].mean(axis=1) @ to_eye)
    outline = x[faces[order][:, [0, 3, 1, 4, 2, 5]]] @ np.array([right, up]).T
    ax.add_collection(PolyCollection(outline, array=of[order], clim=(0, limit), cmap="YlOrRd", edgecolor="black",
                                     linewidth=0.2))
    ax.autoscale_view()
    ax.set(aspect="equal", xticks=[], yticks=[], title=title)


folder = clients.new_folder("calculix_parts")
gmsh.initialize(["", "-v", "0"])
for option, value in (("ElementOrder", 2), ("SecondOrderLinear", 0), ("HighOrderOptimize", 0)):
    gmsh.option.setNumber("Mesh." + option, value)
chosen = sys.argv[1:] or PARTS
_, axes = plt.subplots(2, len(chosen), figsize=(11, 7), layout="constrained", squeeze=False)
print("| part | tetrahedra | with negative det J; where ccx looks | certified bound | nodes moved, edges | "
      "displacement; stress | on a fine mesh |\n" + 7 * "|---" + "|")
for column, part in enumerate(chosen):
    build, size, *where = PARTS[part]
    mesh(folder / f"{part}.inp", build, size, *where)
    _, x, _, cells = ccx.tetrahedra(folder / f"{part}.inp")
    negative = (ccx.determinants(x, cells, ccx.LATTICE) <= 0).any(axis=1)
    seen = (ccx.determinants(x, cells, ccx.INTEGRATION) <= 0).any(axis=1).sum()
    taken, said = ccx.run(folder, part)
    if taken or "nonpositive jacobian" not in said or not seen:
        sys.exit(f"{part}: ccx does not refuse it for its Jacobians, {seen} of them not positive:\n{said[-500:]}")
    name = f"{part}-mended"
    bound = mended(folder, name, "improve", folder / f"{part}.inp")
    _, y, _, same = ccx.tetrahedra(folder / f"{name}.inp")
    left = (ccx.determinants(y, cells, ccx.LATTICE) <= 0).any(axis=1).sum()
    if not bound or left or differs(folder / f"{part}.inp", folder / f"{name}.inp") or (same != cells).any():
        sys.exit(f"{part}: not mended, {left} tetrahedra with negative Jacobians, or more than coordinates has changed")
    *most, u, stress = solved(folder, name)
    mesh(folder / f"{part}-fine.inp", build, size / 3, *where)
    *fine, _, _ = solved(folder, f"{part}-fine")
    moved = np.linalg.norm(y - x, axis=1).max() / np.linalg.norm(x[cells[:, 0]] - x[cells[:, 1]], axis=1).mean()
    print("| {} | {} | {}; {} | {:.3f} | {:.2f} | {:.3g}; {:.3g} | {:.3g}; {:.3g} |".format(
        part, len(cells), negative.sum(), seen, bound, moved, *most, *fine), flush=True)
    draw(axes[0, column], x, cells, negative, 1.2, f"{part}: {negative.sum()} negative, refused")
    y += u[:, 1:] * 0.1 * np.ptp(y) / most[0]
    draw(axes[1, column], y, cells, stress, stress.max(), "mended by improve: stress")
plt.savefig(folder / "parts.png", dpi=80)

#!/usr/bin/env python3
"""OpenFOAM on a moving mesh: a piston compresses a cylinder to a quarter, and scalarTransportFoam solves for the dust
in it, which the piston sweeps up while it diffuses. The flux of the mesh is what almesh says its faces have swept. A
step is a run on the mesh at its end; the volumes before (V0) and the flux (meshPhi) are files, which OpenFOAM reads
where a run with a moving mesh goes on. Dust is conserved, and even dust that may pass all walls stays even.
`make coupling`; Debian: openfoam."""
import clients

clients.need("openfoam python3-numpy", "gmshToFoam", "scalarTransportFoam", "numpy")

import numpy as np

import foam
from foam_faces import Faces, listed

STEPS, DT = 12, 0.125
DECK = f"""mesh = ../../../inputs/meshes/piston.msh
boundary piston = translate 0 0 "t"
boundary wall = slide
boundary head = fixed
frames = 0 : {DT} : {STEPS * DT}
velocity = faces
"""
OUTER = 'boundaryField { ".*" { type zeroGradient; } }'


def step(t, dust, before, mesh_flux, relative):
    """Dust at the end of a step that begins at t, on the mesh there; relative: its flux through the moving faces."""
    faces.write_flux(f"{t:g}/meshPhi", mesh_flux)
    faces.write_flux(f"{t:g}/phi", relative)
    case.write(f"{t:g}/V0", "volScalarField::Internal", f"dimensions [0 3 0 0 0 0 0]; value {listed(before)};")
    case.write(f"{t:g}/U", "volVectorField", f"dimensions [0 1 -1 0 0 0 0]; internalField uniform (0 0 0); {OUTER}")
    case.write(f"{t:g}/T", "volScalarField", f"dimensions [0 0 0 0 0 0 0]; internalField {listed(dust)}; {OUTER}")
    case.control(t, DT)
    case.run("scalarTransportFoam")
    text = (folder / f"{t + DT:g}" / "T").read_text().split("\n(\n")[1].split("\n)")[0]
    return np.array(text.split(), float)


folder = clients.new_folder("piston")
print("OpenFOAM: a piston sweeps dust", flush=True)
meshes = clients.run(folder, DECK)
case = foam.Case(folder, meshes[0])
case.write("constant/transportProperties", "dictionary", "DT [0 2 -1 0 0 0 0] 0.05;")
faces = Faces(case, meshes[0])
positions = [np.array(list(clients.nodes(mesh).values())) for mesh in meshes]
even, z = np.ones(faces.cells), positions[0][faces.corners, 2].mean(axis=1)
dust = np.where(np.bincount(faces.owner, z) + np.bincount(faces.neighbour, z[:faces.inner], faces.cells) < 4, 1.0, 0.0)
content = dust @ faces.volumes(positions[0])  # dust is where z < 1
print("t, volume; largest difference of a cell's growth and what its faces swept, change of the dust, of even dust")
for k, mesh in enumerate(meshes[1:]):
    before, after, swept = faces.volumes(positions[k]), faces.volumes(positions[k + 1]), faces.swept(mesh)
    case.write_points(k * DT, mesh)
    even = step(k * DT, even, before, swept / DT, -swept / DT)
    closed = np.where(np.arange(len(swept)) < faces.inner, -swept / DT, 0)
    dust = step(k * DT, dust, before, swept / DT, closed)
    if k % 4 == 3:
        growth = abs(after - before - faces.balance(swept)).max()
        print(f"{(k + 1) * DT:g}  {after.sum():.5f}  {growth:.1e}  {dust @ after / content - 1:8.1e}  "
              f"{abs(even - 1).max():.1e}")

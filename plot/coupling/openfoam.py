#!/usr/bin/env python3
"""OpenFOAM on the meshes of a motion: a body in hexahedra, prisms, pyramids and tetrahedra pitches by 60 degrees.
checkMesh judges the mesh of each time, and potentialFoam solves the flow past the body on it. `make coupling`; Debian:
openfoam."""
import re
import sys

import clients
import foam

DECK = """mesh = ../../../inputs/meshes/body.msh
boundary body = rotate "60*sin(2*pi*t)" axis 0 1 0
boundary far = fixed
frames = 0 : 0.125 : 1
vtk = none
"""
VELOCITY = """dimensions [0 1 -1 0 0 0 0]; internalField uniform (1 0 0); boundaryField {
far { type fixedValue; value uniform (1 0 0); } body { type fixedValue; value uniform (0 0 0); } }"""
PRESSURE = """dimensions [0 2 -2 0 0 0 0]; internalField uniform 0;
boundaryField { ".*" { type zeroGradient; } }"""


def number(before, text):
    return float(re.search(before + r" ([0-9.e+-]*\d)", text)[1])


clients.need("openfoam", "gmshToFoam", "checkMesh", "potentialFoam")
folder = clients.new_folder("openfoam")
print("OpenFOAM: a potential flow past a body")
meshes = clients.run(folder, DECK)
case = foam.Case(folder, meshes[0])
print("t, volume, largest non-orthogonality and skewness, checkMesh, continuity error of the potential flow")
for k, mesh in enumerate(meshes):
    t = k / 8
    case.write_points(t, mesh)
    case.write(f"{t:g}/U", "volVectorField", VELOCITY)
    case.write(f"{t:g}/p", "volScalarField", PRESSURE)
    case.control(t, 1)
    check, flow = case.run("checkMesh", "-time", f"{t:g}"), case.run("potentialFoam")
    if "Mesh OK." not in check:
        sys.exit(f"t = {t:g}: checkMesh refuses the mesh:\n{check}")
    print(f"{t:<5g}  {number('Total volume =', check):.10g}  {number('non-orthogonality Max:', check):.4g}  "
          f"{number('Max skewness =', check):.3g}  Mesh OK  {number('Continuity error =', flow):.0e}")

#!/usr/bin/env python3
"""OpenFOAM on the meshes of a motion: a body in hexahedra, prisms, pyramids and tetrahedra pitches by 60 degrees.
gmshToFoam reads the first mesh; of the others only the points are written, as TIME/polyMesh/points. checkMesh judges
the mesh of each time, and potentialFoam solves the flow past the body on it. `make coupling`; Debian: openfoam."""
import os
import re
import subprocess
import sys

import almesh

DECK = """mesh = ../../../inputs/meshes/body.msh
boundary body = rotate "60*sin(2*pi*t)" axis 0 1 0
boundary far = fixed
frames = 0 : 0.125 : 1
vtk = none
"""
CONTROL = """startFrom startTime; startTime %s; stopAt endTime; endTime 2; deltaT 1; writeControl timeStep;
writeInterval 1; writePrecision 17;"""
SCHEMES = """ddtSchemes { default steadyState; } gradSchemes { default Gauss linear; }
divSchemes { default Gauss linear; } laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; } snGradSchemes { default corrected; }"""
SOLUTION = """solvers { Phi { solver PCG; preconditioner DIC; tolerance 1e-10; relTol 0; } }
potentialFlow { nNonOrthogonalCorrectors 20; PhiRefCell 0; PhiRefValue 0; }"""
VELOCITY = """dimensions [0 1 -1 0 0 0 0]; internalField uniform (1 0 0); boundaryField {
far { type fixedValue; value uniform (1 0 0); } body { type fixedValue; value uniform (0 0 0); } }"""
PRESSURE = """dimensions [0 2 -2 0 0 0 0]; internalField uniform 0;
boundaryField { ".*" { type zeroGradient; } }"""


def foam(*command):
    environment = {**os.environ, "WM_PROJECT_DIR": "/usr/share/openfoam"}
    run = subprocess.run([*command, "-case", folder], capture_output=True, text=True, check=False, env=environment)
    if run.returncode:
        sys.exit(f"{command[0]} failed:\n{run.stdout[-2000:]}{run.stderr[-2000:]}")
    return run.stdout


def write(name, kind, text):
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"FoamFile {{ version 2.0; format ascii; class {kind}; object {path.name}; }}\n{text}\n")


def points(path):
    """The nodes of an MSH 2.2 file as OpenFOAM's list; gmshToFoam keeps their order."""
    rows = [f"({x!r} {y!r} {z!r})" for x, y, z in almesh.nodes(path).values()]
    return "\n".join([str(len(rows)), "(", *rows, ")"])


def number(before, text):
    return float(re.search(before + r" ([0-9.e+-]*\d)", text)[1])


almesh.need("openfoam", "gmshToFoam", "checkMesh", "potentialFoam")
folder = almesh.new_folder("openfoam")
print("OpenFOAM: a potential flow past a body")
meshes = almesh.run(folder, DECK)
write("system/controlDict", "dictionary", CONTROL % 0)
write("system/fvSchemes", "dictionary", SCHEMES)
write("system/fvSolution", "dictionary", SOLUTION)
foam("gmshToFoam", meshes[0].resolve())
print("t, volume, largest non-orthogonality and skewness, checkMesh, continuity error of the potential flow")
for k, mesh in enumerate(meshes):
    t = f"{k / 8:g}"
    write(f"{t}/polyMesh/points", "vectorField", points(mesh))
    write(f"{t}/U", "volVectorField", VELOCITY)
    write(f"{t}/p", "volScalarField", PRESSURE)
    write("system/controlDict", "dictionary", CONTROL % t)
    check, flow = foam("checkMesh", "-time", t), foam("potentialFoam")
    if "Mesh OK." not in check:
        sys.exit(f"t = {t}: checkMesh refuses the mesh:\n{check}")
    print(f"{t:5}  {number('Total volume =', check):.10g}  {number('non-orthogonality Max:', check):.4g}  "
          f"{number('Max skewness =', check):.3g}  Mesh OK  {number('Continuity error =', flow):.1e}")

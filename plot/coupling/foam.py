"""What the clients of OpenFOAM share: a case, whose first mesh gmshToFoam reads. It keeps the order of the nodes, so
that the points of each later mesh, TIME/polyMesh/points, are those of its file. Standard library only."""
import os
import subprocess
import sys

import clients

CONTROL = """startFrom startTime; startTime %s; stopAt endTime; endTime %s; deltaT %s; writeControl timeStep;
writeInterval 1; writePrecision 17; timePrecision 12;"""
SCHEMES = """ddtSchemes { default Euler; } gradSchemes { default Gauss linear; }
divSchemes { default Gauss linear; div(phi,T) Gauss upwind; } laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; } snGradSchemes { default corrected; }"""
SOLUTION = """solvers { Phi { solver PCG; preconditioner DIC; tolerance 1e-10; relTol 0; }
T { solver PBiCGStab; preconditioner DILU; tolerance 1e-15; relTol 0; } } SIMPLE { }
potentialFlow { nNonOrthogonalCorrectors 20; PhiRefCell 0; PhiRefValue 0; }"""


class Case:
    def __init__(self, folder, mesh):
        self.folder = folder
        self.write("system/fvSchemes", "dictionary", SCHEMES)
        self.write("system/fvSolution", "dictionary", SOLUTION)
        self.control(0, 1)
        self.run("gmshToFoam", mesh.resolve())

    def control(self, start, step):
        """Times from which and until when a solver goes, in one step."""
        self.write("system/controlDict", "dictionary", CONTROL % (start, start + step, step))

    def run(self, *command):
        environment = {**os.environ, "WM_PROJECT_DIR": "/usr/share/openfoam"}
        done = subprocess.run([*command, "-case", self.folder], capture_output=True, text=True, check=False,
                              env=environment)
        if done.returncode:
            sys.exit(f"{command[0]} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return done.stdout

    def write(self, name, kind, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"FoamFile {{ version 2.0; format ascii; class {kind}; object {path.name}; }}\n{text}\n")

    def write_points(self, time, mesh):
        rows = [f"({x!r} {y!r} {z!r})" for x, y, z in clients.nodes(mesh).values()]
        self.write(f"{time:g}/polyMesh/points", "vectorField", "\n".join([str(len(rows)), "(", *rows, ")"]))

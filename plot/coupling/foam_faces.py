"""The faces of a mesh of tetrahedra as OpenFOAM has them: fluxes through them, and what they sweep. Needs numpy."""
import csv
import re

import numpy as np

import clients


def listed(values):
    return f"nonuniform List<scalar> {len(values)}\n(\n" + "\n".join(map(repr, map(float, values))) + "\n)"


class Faces:
    def __init__(self, case, mesh):
        """mesh: the file that gmshToFoam has read."""
        def rows(name):
            text = (case.folder / "constant" / "polyMesh" / name).read_text().split("\n(\n")[1].split("\n)")[0]
            return np.array([[int(word) for word in re.findall(r"\d+", row)] for row in text.split("\n")])
        self.case, self.corners = case, rows("faces")[:, 1:]
        self.owner, self.neighbour = rows("owner")[:, 0], rows("neighbour")[:, 0]
        self.inner, self.cells = len(self.neighbour), self.owner.max() + 1
        patches = (case.folder / "constant" / "polyMesh" / "boundary").read_text()
        self.patches = re.findall(r"(\w+)\n\s*{[^}]*nFaces\s+(\d+);\s*startFace\s+(\d+);", patches)
        corners = np.array(list(clients.nodes(mesh)))[self.corners].tolist()
        self.with_nodes = {frozenset(face): (f, face) for f, face in enumerate(corners)}

    def balance(self, values):
        """What goes out of each cell."""
        return np.bincount(self.owner, values) - np.bincount(self.neighbour, values[:self.inner], self.cells)

    def volumes(self, x):
        """Of the tetrahedra, from their faces."""
        a, b, c = x[self.corners].transpose(1, 0, 2)
        return self.balance((np.cross(b - a, c - a) * a).sum(axis=1) / 6)

    def swept(self, mesh):
        """What each face has swept, from its owner to its neighbour."""
        values = np.empty(len(self.corners))
        with mesh.with_name(f"{mesh.stem}-swept.csv").open(newline="") as file:
            for row in csv.DictReader(file):
                nodes = [int(row[f"node_{k}"]) for k in (1, 2, 3)]
                f, face = self.with_nodes[frozenset(nodes)]
                same = nodes[(nodes.index(face[0]) + 1) % 3] == face[1]
                values[f] = float(row["volume"]) * (1 if same else -1)
        return values

    def write_flux(self, name, values):
        """A flux; the faces of the boundary come last, patch by patch."""
        outer = [f"{patch} {{ type calculated; value {listed(values[int(first):int(first) + int(count)])}; }}"
                 for patch, count, first in self.patches]
        self.case.write(name, "surfaceScalarField", "dimensions [0 3 -1 0 0 0 0]; oriented oriented; internalField "
                        f"{listed(values[:self.inner])}; boundaryField {{ {' '.join(outer)} }}")

"""What the clients share: the mesh of dolfinx in memory; for other programs runs of almesh, and the nodes of the meshes
that it writes. Standard library only, but for what dolfinx needs."""
import csv
import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

OUTPUTS = Path("outputs/coupling")
sys.path.append("src")  # where the module almesh is


def need(packages, *names):
    """Ends the script, with a sentence, where one of these programs or Python modules is missing."""
    missing = [name for name in names if not shutil.which(name) and not importlib.util.find_spec(name)]
    if missing:
        print(f"{', '.join(missing)} not found by {sys.executable}: apt-get install --no-install-recommends {packages}")
        sys.exit()


def new_folder(name):
    """outputs/coupling/name, empty."""
    folder = OUTPUTS / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def run(folder, deck):
    """Runs a deck in the folder, with frames. Returns the meshes."""
    path = folder / "motion.deck"
    path.write_text(deck)
    done = subprocess.run(["./almesh", path, f"output={folder}/mesh"], stdout=subprocess.PIPE, text=True, check=True)
    print("almesh:", done.stdout.splitlines()[-1])
    return sorted((folder / "mesh").glob("frame-*.msh"))


def mesh_of(domain, facets, **tags):
    """The mesh of a domain of dolfinx in memory, its nodes in dolfinx's order; its boundaries have tags of facets."""
    import numpy as np
    import almesh
    of, dim = domain.topology, domain.topology.dim
    of.create_connectivity(dim - 1, 0)
    vertices, cells = of.connectivity(dim - 1, 0), domain.geometry.dofmap.array.reshape(-1, dim + 1)
    node = np.empty(len(domain.geometry.x), int)
    node[of.connectivity(dim, 0).array] = cells.ravel()
    line, triangle = (("line", "triangle"), ("triangle", "tetrahedron"))[dim - 2]
    faces = {name: {line: node[[vertices.links(f) for f in facets.find(tag)]]} for name, tag in tags.items()}
    return almesh.from_arrays(domain.geometry.x[:, :dim], {triangle: cells}, faces)


class Coupled:
    """A run with frames = -, which makes a mesh when it is told to."""

    def __init__(self, folder, deck):
        path, self.folder = folder / "motion.deck", folder
        path.write_text(deck)
        self.run = subprocess.Popen(["./almesh", path, f"output={folder}/mesh", "frames=-"], text=True, bufsize=1,
                                    stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def mesh(self, t, *files, straight=False):
        """The mesh of time t; the files say where the boundary is. straight: its nodes have to go there straight from the
        mesh before without inverting an element, as a mesh halfway needs."""
        print(t, *files, file=self.run.stdin)
        _, status, mesh = self.run.stdout.readline().rstrip().split(" ", 2)
        is_there = status == "converged" or (status == "way_not_valid" and not straight)
        return Path(mesh) if is_there else sys.exit(f"t = {t}: {status}: {mesh}")

    def end(self):
        self.run.stdin.close()
        code = self.run.wait()
        with (self.folder / "mesh" / "frames.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        eta = max(float(row["max_distortion"]) for row in rows)
        print(f"almesh: {len(rows)} meshes, {sum(row['certified'] == 'yes' for row in rows)} of them certified, "
              f"eta up to {eta:.3f}; exit code {code}")


def nodes(path):
    """{id: (x, y, z)} of a mesh in MSH 2.2, in its order."""
    _, *rows = path.read_text().split("$Nodes\n")[1].split("\n$EndNodes")[0].split("\n")
    return {int(words[0]): tuple(map(float, words[1:])) for words in map(str.split, rows)}

"""What the clients share: a run of almesh, and the nodes of the meshes that it writes. Standard library only."""
import csv
import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

OUTPUTS = Path("outputs/coupling")


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


def move(folder, *J):
    """Runs the folder's motion.deck, or differentiates functions of its mesh. Returns what summary.txt says."""
    command = ["./almesh", *["adjoint"][:len(J)], folder / "motion.deck", *J, f"output={folder}/mesh"]
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
    return dict(line.split(" = ") for line in (folder / "mesh" / "summary.txt").read_text().splitlines())


def adjoint(folder, ids, rows):
    """{id: derivatives by the boundary's nodes} of a function with these derivatives by the nodes of the moved mesh."""
    write_nodes(folder / "J.csv", ids, rows)
    move(folder, folder / "J.csv")
    _, *rows = (folder / "mesh" / "adjoint-J.csv").read_text().splitlines()
    return {int(words[0]): tuple(map(float, words[1:])) for words in (row.split(",") for row in rows)}


def write_nodes(path, ids, rows):
    """A node file, or one of derivatives."""
    path.write_text("".join(",".join(map(str, [i, *row])) + "\n" for i, row in zip(ids, rows)))


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

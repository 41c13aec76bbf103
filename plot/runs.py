"""What a run leaves in outputs/<deck>/: summary.txt, expectations.csv, history.csv and deck.txt; what `make bench` leaves
in outputs/bench.csv; the nodes of a mesh. Standard library only."""
import csv
from pathlib import Path

OUTPUTS = Path(__file__).resolve().parent.parent / "outputs"


class MissingRun(Exception):
    """A file of a run is not there; the text says which deck to run."""


class MissingName(Exception):
    """A file of a run has no quantity or column of this name; the text says which."""


class NoBench(Exception):
    """outputs/bench.csv is not there, or has no rows of a group."""


class Named(dict):
    """{name: text} of a file of the program. A name that is not there raises MissingName."""

    def __init__(self, path, entries):
        super().__init__(entries)
        self.path = path

    def __missing__(self, name):
        raise MissingName(f"{self.path} has no `{name}`: `./almesh --keys` lists the names that the program writes; run "
                          "the deck again where the file is of another version")


def path_of(deck, file):
    """Path of a file of the run of inputs/<deck>.deck. Raises MissingRun."""
    path = OUTPUTS / deck / file
    if not path.exists():
        raise MissingRun(f"outputs/{deck}/{file} is missing: run `./almesh inputs/{deck}.deck` first")
    return path


def summary(deck):
    """{quantity: text} of summary.txt."""
    path = path_of(deck, "summary.txt")
    return Named(path, (line.split(" = ", 1) for line in path.read_text().splitlines()))


def table(deck, file):
    """The rows of a CSV file, [{column: text}]."""
    path = path_of(deck, file)
    with path.open(newline="") as lines:
        return [Named(path, row) for row in csv.DictReader(lines)]


def expectations(deck):
    """The `expect` lines of the deck, [{"quantity", "expected", "got", "holds": "yes" or "no"}]."""
    return table(deck, "expectations.csv")


def history(deck):
    """The rows of history.csv: kind `al` per subproblem, `newton` per step, `coarse` per coarser mesh, `part` per part of
    the motion."""
    return table(deck, "history.csv")


def al_rows(deck):
    """One row per augmented Lagrangian iteration, the first of them the initial mesh (iteration 0)."""
    return [row for row in history(deck) if row["kind"] == "al"]


def deck_lines(deck):
    """Lines of the resolved deck."""
    return path_of(deck, "deck.txt").read_text().splitlines()


def nodes(path):
    """{id: [x, y, z]} of a mesh in MSH 2.2, in its order."""
    _, *rows = Path(path).read_text().split("$Nodes\n")[1].split("\n$EndNodes")[0].split("\n")
    return {int(words[0]): [float(word) for word in words[1:]] for words in map(str.split, rows)}


def bench(group):
    """The rows of one group of outputs/bench.csv, [{"name": text, "threads": number, quantity: number, ...}].
    Raises NoBench."""
    path = OUTPUTS / "bench.csv"
    if not path.exists():
        raise NoBench("outputs/bench.csv is missing: `make bench` writes it")
    rows = {}
    with path.open(newline="") as file:
        for entry in csv.DictReader(file):
            if entry["group"] == group:
                row = rows.setdefault((entry["name"], entry["threads"]),
                                      {"name": entry["name"], "threads": float(entry["threads"])})
                row[entry["quantity"]] = float(entry["value"])
    if not rows:
        raise NoBench(f"outputs/bench.csv has no rows of `{group}`")
    return list(rows.values())

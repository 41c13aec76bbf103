"""What a run leaves in outputs/<deck>/: summary.txt, history.csv and deck.txt; what `make bench` leaves in
outputs/bench.csv. Standard library only."""
import csv
from pathlib import Path

OUTPUTS = Path(__file__).resolve().parent.parent / "outputs"


class MissingRun(Exception):
    """A file of a run is not there; the text says which deck to run."""


class NoBench(Exception):
    """outputs/bench.csv is not there, or not what it takes."""


def path_of(deck, file):
    """Path of a file of the run of inputs/<deck>.deck. Raises MissingRun."""
    path = OUTPUTS / deck / file
    if not path.exists():
        raise MissingRun(f"outputs/{deck}/{file} is missing: run `./almesh inputs/{deck}.deck` first")
    return path


def summary(deck):
    """{quantity: text} of summary.txt."""
    lines = path_of(deck, "summary.txt").read_text().splitlines()
    return dict(line.split(" = ", 1) for line in lines)


def history(deck):
    """The rows of history.csv, [{column: text}]: kind `al` per subproblem, `newton` per step, `coarse` per coarser mesh."""
    with path_of(deck, "history.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def al_rows(deck):
    """One row per augmented Lagrangian iteration, the first of them the initial mesh (iteration 0)."""
    return [row for row in history(deck) if row["kind"] == "al"]


def deck_lines(deck):
    """Lines of the resolved deck."""
    return path_of(deck, "deck.txt").read_text().splitlines()


def expectations(deck):
    """The `expect` lines, [(quantity, relation, value, tolerance)], the tolerance "" where there is none."""
    found = []
    for line in deck_lines(deck):
        if line.startswith("expect "):
            quantity, relation, value, *tolerance = line.split()[1:]
            found.append((quantity, relation, value, tolerance[1] if tolerance else ""))
    return found


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

"""What plot/page.py shows of a run besides its meshes: tables, their explanations, and curves over time or Newton
steps. Standard library only.
"""
import csv
import re
import shutil
import subprocess
from math import isclose, isfinite
from pathlib import Path

HERE = Path(__file__).resolve().parent
TIME = "t = {:.6g}"

# The columns of frames.csv: the name on the page (none: only in the line below the table), and what they are.
FRAMES = {
    "frame": ("#", "number of the frame, as in frame-0001.msh"),
    "t": ("t", "time of the frame"),
    "status": ("status", "converged, or why the frame has no mesh"),
    "exit_code": ("", "exit code of the frame"),
    "newton_steps": ("steps", "Newton steps of the frame"),
    "max_distortion": ("max η", "largest distortion η over all quadrature points"),
    "relative_quality": ("", "the L2 norm of 1 divided by that of η; 1: undistorted"),
    "certified_bound": ("bound", "lower bound of det J over that of the straight element, everywhere"),
    "certified": ("", "yes: proved valid and free of overlaps"),
    "started_from": ("", "the frame before, its motion prolonged beyond it, the ideal mesh, or anew"),
    "path": ("path", "whether all elements stay valid on the straight way of each node from the frame before"),
    "seconds": ("", "seconds that the frame took"),
    "note": ("", "why the frame ended as it did"),
}


def explanations():
    """{quantity or column: what it is}, as the program explains it; nothing where there is no program."""
    program = next(filter(None, map(shutil.which, (str(HERE.parent / "almesh"), "almesh"))), None)
    try:
        text = subprocess.run([program, "--keys"], capture_output=True, text=True).stdout if program else ""
    except OSError:
        return {}
    found, name = {}, ""
    for line in text[text.find("Quantities of the summary:"):].splitlines():
        words = line.split(maxsplit=1)
        if not line.startswith(" "):
            name = words[0] if len(words) == 2 else ""
        if name and words:
            found[name] = f"{found[name]} {line.strip()}" if line.startswith(" ") else words[1]
    return found


def state(folder):
    """The end of the run in a few words, and whether it is as wanted."""
    path = folder / "summary.txt"
    lines = path.read_text().splitlines() if path.exists() else []
    found = dict(line.split(" = ", 1) for line in lines if " = " in line)
    frames = [row["status"] == "converged" and row["certified"] == "yes" for row in rows_of(folder / "frames.csv")]
    if not all(frames):
        return f"{frames.count(False)} of {len(frames)} frames without a certified mesh", False
    certified = [name for name in ("valid", "injective") if found.get(f"certified_{name}") == "yes"]
    diagnosis = found.get("diagnosis", "none")
    words = [found.get("status", "").replace("_", " "), certified and "certified " + " and ".join(certified),
             diagnosis != "none" and f"diagnosis: {diagnosis.replace('_', ' ')}"]
    return ", ".join(filter(None, words)), not found or found.get("status") == "converged" and len(certified) == 2


def rows_of(path):
    """Rows of a CSV file as {column: text}; none where it is missing."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def tables(folder):
    """[{"name", "columns", "rows", "same"}] of the files of a run, without columns that are empty everywhere; "same":
    [column, value] of those with one value everywhere."""
    found = []
    for name in ("frames.csv", "summary.txt", "history.csv", "expectations.csv"):
        if not (path := folder / name).exists():
            continue
        lines = path.read_text().splitlines()
        if name == "summary.txt":
            columns = ["quantity", "value"]
            rows = [line.split(" = ", 1) for line in lines if " = " in line and not line.endswith(" = none")]
        else:
            columns, *rows = list(csv.reader(lines)) or [[]]
        rows = [row + [""] * (len(columns) - len(row)) for row in rows]  # the last may be half written
        used = [k for k in range(len(columns)) if any(row[k] for row in rows)]
        same = [k for k in used if len(rows) > 1 and all(row[k] == rows[0][k] for row in rows)]
        used = [k for k in used if k not in same]
        if rows:
            found.append({"name": path.stem, "columns": [columns[k] for k in used],
                          "rows": [[row[k] for k in used] for row in rows],
                          "same": [[columns[k], rows[0][k]] for k in same]})
    return found


def frame_rows(folder, labels):
    """Of each row of frames.csv the frame to show; -1 where there is none, as of one that failed."""
    names = [TIME.format(float(row["t"])) for row in rows_of(folder / "frames.csv")]
    return [labels.index(name) if name in labels else -1 for name in names]


# ----------------------------------------------------------------------------------------------------------- the curves

def number(text):
    """A number to draw, or None: of nothing, of an inverted element."""
    try:
        return float(text) if isfinite(float(text)) else None
    except (TypeError, ValueError):
        return None


def steps_of(history):
    """[(Newton steps until then, row)] of the rows of the whole mesh at the ends of minimisations."""
    steps, found = 0, []
    for row in history:
        if row["kind"] in ("part", "power"):
            steps += int(row["newton_iterations"] or 0)
        steps += row["kind"] == "newton"
        if row["kind"] in ("part", "power", "al"):
            found.append((steps, row))
    return found


def extremes(frames, name, best):
    """Of each mesh the extreme of these cell data; None where it has none or an element is inverted."""
    values = [vtk.cell_data.get(name) for _, vtk in frames]
    return [number(best(value)) if value and all(map(isfinite, value)) else None for value in values]


def curves(folder, series, times, frames):
    """{"x", "frames", "failed", "list"}: what x is, where the meshes are (None: nowhere; times: of the series), where
    frames failed, and [{"title", "text", "points"}]. A curve needs two values."""
    rows, history = rows_of(folder / "frames.csv"), rows_of(folder / "history.csv")
    points = {}
    if series == "frames":
        of_frame = {row["frame"]: float(row["t"]) for row in rows}
        points = {name: [(float(row["t"]), number(row[name])) for row in rows if row[name]]
                  for name in ("max_distortion", "newton_steps")}
        norms = {of_frame[row["frame"]]: number(row["constraint_norm"]) for row in history
                if row["kind"] == "al" and row.get("frame") in of_frame}
        points["constraint_norm"] = sorted(norms.items())
    else:
        ends = steps_of(history)
        last = max((step for step, _ in ends), default=0)
        times = times if series == "iterates" else ([0, last] if last else [1, 2])[-len(frames):]
        for name in ("max_distortion", "constraint_norm"):
            points[name] = [(step, number(row[name])) for step, row in ends]
        worst = extremes(frames, "distortion", max)
        if series == "iterates" or not history:
            points["max_distortion"] = list(zip(times, worst))
        elif not ends or not worst[0] or not isclose(points["max_distortion"][0][1] or 0, worst[0], rel_tol=1e-6):
            times = [None, *times[1:]]  # the initial mesh is not the one from which the steps began
    failed = [float(row["t"]) for row in rows if row["status"] != "converged"]
    points["scaled_jacobian"] = sorted(
        [(x, value) for x, value in zip(times, extremes(frames, "scaled_jacobian", min)) if x is not None] +
        [(t, None) for t in failed], key=lambda point: point[0])
    titles = {"max_distortion": ("worst distortion η", "compared with the initial mesh; 1: undistorted"),
              "scaled_jacobian": ("least scaled Jacobian", "of the meshes of this page; 1: regular, 0: flat"),
              "constraint_norm": ("|c_D|", "distance of the boundary from its target"),
              "newton_steps": ("Newton steps", "of each frame")}
    found = [{"title": title, "text": text, "points": points[name]} for name, (title, text) in titles.items()
             if sum(value is not None for _, value in points.get(name, [])) > 1]
    x = "t" if series == "frames" else "Newton step" if series == "iterates" or last else "mesh"
    return {"x": x, "frames": times, "list": found,
            "failed": failed}

#!/usr/bin/env python3
"""The derivative of the moved mesh by a constant of the deck (almesh tangent) beside central differences of whole runs,

    (x(a + h) - x(a - h)) / (2 h),

for shorter and shorter steps h: the error falls with the square of h until rounding over h takes over.

  plot/derivatives.py          the same as `make derivatives`; some minutes
  plot/derivatives.py WORD...  the cases whose names contain one of the words

Writes outputs/derivatives/table.md, and the figure derivatives.png where matplotlib is installed.
"""
import math
import subprocess
import sys

import runs

BOX = """mesh = ../../inputs/meshes/cube.msh
boundary top = expression "x + 0.1*a*z" "y" "z + a*(0.1*sin(pi*x)*sin(pi*y) - 0.1)"
boundary rest = expression "x + 0.1*a*z" "y" "z*(1 - 0.1*a)"
"""
STEPS = [10.0 ** -k for k in range(1, 7)]
CASES = [
    ("circle moved by 8", "inputs/circle", 8, ["boundary inner=translate a 0"]),
    ("the same with objective = minimax", "inputs/gauntlet/circle-moved-worst", 8, ["boundary inner=translate a 0"]),
    ("boundary layer of degree 4, turned by 30°", "inputs/gauntlet/layers-degree-4", 30,
     ["boundary wall=rotate a about 0 0"]),
    ("box in 3D, sheared and pressed", "outputs/derivatives/box", 1, []),
    ("bump sliding in a channel", "inputs/slide/bump", 0.5, ["boundary bump=translate a 0"]),
    ("piston, the wall of degree 2 slides", "inputs/slide/piston", 1, ["boundary piston=translate 0 0 a"]),
    ("CAD surface stretched, folded nodes slide", "inputs/cad/concave-edge", 1.1, ["boundary all=scale 1 a 1"]),
]
CASES = [case for case in CASES if not sys.argv[1:] or any(word in case[0] for word in sys.argv[1:])]


def run(deck, settings, a):
    """The nodes of the final mesh, one list of coordinates, and those of the tangent."""
    folder = "outputs/derivatives/run"
    command = ["./almesh", "tangent", f"{deck}.deck", *settings, f"let a={a!r}", f"output={folder}", "vtk=none",
               "final=msh"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 5):  # 5: what the deck expects is of its own motion
        sys.exit(f"{' '.join(command)} ended with exit code {done.returncode}: {done.stderr}")
    nodes = runs.nodes(f"{folder}/final.msh")
    rows = [row.split(",") for row in open(f"{folder}/tangent-a.csv", encoding="utf-8").read().split()[1:]]
    return ([v for row in rows for v in nodes[int(row[0])][:len(row) - 1]], [float(v) for row in rows for v in row[1:]])


def error(deck, settings, a, h, tangent):
    """Of the differences, relative, in the root mean square over the nodes."""
    after, before = run(deck, settings, a + h)[0], run(deck, settings, a - h)[0]
    squared = sum(((p - m) / (2 * h) - t) ** 2 for p, m, t in zip(after, before, tangent))
    return math.sqrt(squared / sum(t * t for t in tangent))


def draw(errors):
    import style
    fig, ax = style.plt.subplots(figsize=(6, 4.2), layout="constrained")
    for (title, *_), row in zip(CASES, errors):
        ax.loglog(STEPS, row, "o-", markersize=3.5, linewidth=0.9, label=title)
    ax.loglog(STEPS[:4], [1e-3 * h * h for h in STEPS[:4]], "--", color=style.PAPER, linewidth=0.8, label="slope 2")
    ax.set_xlabel("step h of the constant, relative")
    ax.set_ylabel("central differences of runs − tangent, relative")
    ax.grid(True, which="major", linewidth=0.3, alpha=0.5)
    ax.legend(fontsize=7.5)
    style.save(fig, "derivatives")


def main():
    steps = " | ".join(f"1e-{k}" for k in range(1, 7))
    lines = [f"| error with h/a = | {steps} |", "|---" * (len(STEPS) + 1) + "|"]
    errors = []
    (runs.OUTPUTS / "derivatives").mkdir(parents=True, exist_ok=True)
    (runs.OUTPUTS / "derivatives" / "box.deck").write_text(BOX)
    for title, deck, a, settings in CASES:
        tangent = run(deck, settings, a)[1]
        errors.append([error(deck, settings, a, a * h, tangent) for h in STEPS])
        lines.append(f"| {title} | " + " | ".join(f"{e:.1e}" for e in errors[-1]) + " |")
        print(lines[-1], flush=True)
    (runs.OUTPUTS / "derivatives" / "table.md").write_text("\n".join(lines) + "\n")
    try:
        draw(errors)
    except ModuleNotFoundError as missing:
        print(f"no figure: {missing}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

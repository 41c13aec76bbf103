#!/usr/bin/env python3
"""Moving pictures, outputs/animation/: newton.gif, the Newton iterates of one run (the circle of section 4.1, moved by
8), and circle.gif, the circle on a tour of its domain, every frame a run of its own from the same initial mesh; with
their frames as PNG files.

  plot/animation.py     runs ./almesh, draws; needs numpy, matplotlib and Pillow

Ends with exit code 1 where a run does not.
"""
import math
import subprocess
import sys

from PIL import Image

import runs
import style
from circle_figures import draw
from style import plt
from vtk_mesh import read_vtk

FOLDER = runs.OUTPUTS / "animation"
NORM = style.linear(1, 2.5)
FRAMES = 48  # of the tour
MILLISECONDS = {"newton": 500, "circle": 80}


DECK = """mesh = ../../inputs/meshes/circle.msh
boundary inner = {motion}
boundary outer = fixed
iterates = {iterates}
"""


def almesh(name, motion, iterates=0):
    """Runs the circle with the motion; returns the folder of the results."""
    (FOLDER / f"{name}.deck").write_text(DECK.format(motion=motion, iterates=iterates))
    subprocess.run(["./almesh", f"outputs/animation/{name}.deck", f"output=outputs/animation/{name}"],
                   cwd=runs.OUTPUTS.parent, check=True, stdout=subprocess.DEVNULL)
    return FOLDER / name


def frame(name, number, mesh, title, window):
    """Draws the mesh; returns the path of the picture."""
    fig = plt.figure(figsize=(4.2, 4.4))
    ax = fig.add_axes((0.01, 0.01, 0.98, 0.92))
    draw(ax, mesh, NORM, 0.25)
    style.picture(ax, window, title, frame=False)
    path = FOLDER / f"{name}-{number:04}.png"
    fig.savefig(path, facecolor="white", dpi=100)
    plt.close(fig)
    return path


def newton():
    """The iterates of one run; the last one is shown for longer."""
    folder = almesh("newton", "translate 8 0", iterates=1)
    meshes = [read_vtk(path) for path in sorted(folder.glob("iterate-*.vtk"))]
    frames = [frame("newton", k, mesh, f"Newton step {k}: largest η {mesh.cell_data['distortion'].max():.3g}",
                    style.window_around(3, 0, 11)) for k, mesh in enumerate(meshes)]
    return frames + 3 * frames[-1:]


def circle():
    """A rosette of four leaves through the centre, the circle turning as it goes."""
    frames = []
    for k in range(FRAMES):
        angle = 2 * math.pi * k / FRAMES
        r = 13 * abs(math.sin(2 * angle))
        x, y = r * math.cos(angle), r * math.sin(angle)
        turn = 60 * math.sin(2 * angle)
        folder = almesh("circle", f"rotate {turn:.6f} about 0 0; translate {x:.6f} {y:.6f}")
        mesh = read_vtk(folder / "final.vtk")
        title = f"moved to ({x:.1f}, {y:.1f}), turned by {turn:.0f}°: η ≤ {mesh.cell_data['distortion'].max():.2f}"
        frames.append(frame("circle", k, mesh, title, style.window_around(0, 0, 21.6)))
    return frames


def main():
    style.apply()
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, draw_frames in (("newton", newton), ("circle", circle)):
        try:
            paths = draw_frames()
        except subprocess.CalledProcessError as error:
            sys.exit(f"{' '.join(error.cmd)} ended with exit code {error.returncode}")
        images = [Image.open(path).convert("RGB").quantize(64, dither=Image.Dither.NONE) for path in paths]
        images[0].save(FOLDER / f"{name}.gif", save_all=True, append_images=images[1:], loop=0,
                       duration=MILLISECONDS[name], optimize=True)
        print(f"outputs/animation/{name}.gif: {len(images)} frames")


if __name__ == "__main__":
    main()

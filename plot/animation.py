#!/usr/bin/env python3
"""Moving pictures, outputs/animation/: newton.gif, the Newton iterates of one run (the circle of section 4.1, moved by
8), and circle.gif, the circle on a tour of its domain, every frame a run of its own from the same initial mesh; with
their frames as PNG files.

  plot/animation.py                 runs ./almesh, draws; needs numpy, matplotlib and Pillow
  plot/animation.py RESULTS ...     only draws frames.gif or iterates.gif into these folders of results, from what
                                    frames.vtk.series or iterates.vtk.series lists, else meshes.gif, of initial.vtk and
                                    final.vtk: plane meshes of any cells and degree

Ends with exit code 1 where a run does not.
"""
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
from PIL import Image

import page
import runs
import style
from circle_figures import draw
from style import plt
from vtk_mesh import read_vtk

FOLDER = runs.OUTPUTS / "animation"
NORM = style.linear(1, 2.5)
FRAMES = 48  # of the tour
MOST_FRAMES = 100  # of a folder of results; of more only every second, third, ...
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


def polygons(vtk, kinds):
    """The cells of a plane mesh with their curved edges; kinds: of page.all_faces()."""
    x, shapes = np.array(vtk.points).reshape(-1, 3)[:, :2], [None] * len(vtk.types)
    for kind, faces in kinds:
        faces = np.array(faces)
        values = np.array(kind["basis"]).reshape(kind["points"], -1)[kind["outline"][::2]]
        for element, shape in zip(faces[:, 0], np.einsum("ga,fax->fgx", values, x[faces[:, 2:]])):
            shapes[element] = shape
    return shapes


def of_results(folder):
    """Draws the frames of a folder of results with one scale of colours; returns what it wrote."""
    files, series, _ = page.frame_files(folder)
    frames, _, _ = page.read_frames(files[::-1][::-(-len(files) // MOST_FRAMES)][::-1])
    kinds, x = page.all_faces(frames[0][1]), np.concatenate([vtk.points for _, vtk in frames]).reshape(-1, 3)
    if np.ptp(x[:, 2]) > 0:
        raise page.PageError(f"{folder} has a mesh in space: `plot/page.py {folder}` makes a page that plays it")
    eta = [np.array(vtk.cell_data["distortion"]) for _, vtk in frames]
    norm = style.linear(1, max(1.01, *(values[values < 1e30].max(initial=1) for values in eta)))
    (x0, y0, _), (x1, y1, _) = x.min(axis=0), x.max(axis=0)
    images = []
    for (label, vtk), values in zip(frames, eta):
        fig = plt.figure(figsize=(6, 6 * min((y1 - y0) / (x1 - x0), 2) + 0.4))
        ax = fig.add_axes((0.01, 0.01, 0.98, 0.98 - 0.3 / fig.get_figheight()))
        style.polygons(ax, polygons(vtk, kinds), values, norm, style.DISTORTION, 0.25)
        style.picture(ax, (x0, x1, y0, y1), f"{label}: largest η {values.max():.3g}", frame=False)
        fig.canvas.draw()
        images.append(Image.fromarray(np.asarray(fig.canvas.buffer_rgba())[..., :3]))
        plt.close(fig)
    return save(images, folder / f"{series}.gif", max(80, min(500, 6000 // len(images))))


def save(images, path, milliseconds):
    images = [image.convert("RGB").quantize(64, dither=Image.Dither.NONE) for image in images]
    images[0].save(path, save_all=True, append_images=images[1:], loop=0, duration=milliseconds, optimize=True)
    return f"{os.path.relpath(path)}: {len(images)} frames"


def main():
    style.apply()
    for folder in sys.argv[1:]:
        try:
            print(of_results(Path(folder)))
        except (page.PageError, ValueError, OSError) as error:
            sys.exit(f"plot/animation.py: {error}")
    if sys.argv[1:]:
        return
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, draw_frames in (("newton", newton), ("circle", circle)):
        try:
            paths = draw_frames()
        except subprocess.CalledProcessError as error:
            sys.exit(f"{' '.join(error.cmd)} ended with exit code {error.returncode}")
        print(save([Image.open(path) for path in paths], FOLDER / f"{name}.gif", MILLISECONDS[name]))


if __name__ == "__main__":
    main()

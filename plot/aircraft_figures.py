"""Figures 7, 8 and 9: the moved aircraft, cut through its mesh and seen from outside."""
from functools import lru_cache

import numpy as np

import runs
import solid
import style
from style import plt
from vtk_mesh import inner_faces, read_vtk

CUT = 1e-3  # y of the cut, just beside the aircraft's plane of symmetry
NORM = style.logarithmic(1, 2)
TICKS = [1, 1.1, 1.2, 1.4, 1.6, 2]
MOTION = 4


@lru_cache
def cut(name):
    """Polygons of the cut through the tetrahedra and the distortion of each."""
    mesh = read_vtk(runs.path_of("aircraft", f"{name}.vtk"))
    shapes, owners = solid.cut_tetrahedra(mesh.points, mesh.cells[:, :4], CUT)
    return shapes, mesh.cell_data["distortion"][owners]


def panel(ax, name, window, title, line_width):
    shapes, distortion = cut(name)
    style.polygons(ax, shapes, distortion, NORM, style.DISTORTION, line_width)
    style.picture(ax, window, title)


def legend(fig, place):
    worst = max(cut("final")[1])
    style.colour_bar(fig, fig.add_axes(place), NORM, style.DISTORTION,
                     f"(c) distortion η of the element, logarithmic; largest on the cut {worst:.3g}", TICKS,
                     extend="max")


def fig07():
    fig = plt.figure(figsize=(10.4, 6.5))
    fig.suptitle("Fig. 7 of the paper: an aircraft moved by two of its lengths, cut, coloured by distortion", y=0.97)
    window = style.window_around(0.5 * MOTION, 0, 10)
    panels = [("initial", "(a) initial (the far field is a sphere of radius 30)"), ("final", "(b) optimised")]
    for k, (name, title) in enumerate(panels):
        ax = fig.add_axes((0.02 + 0.485 * k, 0.12, 0.475, 0.76))
        panel(ax, name, window, title, 0.25)
        style.show_detail(ax, style.window_around(MOTION * k, 0, 1.9), "Fig. 8")
    legend(fig, (0.25, 0.085, 0.5, 0.018))
    style.save(fig, "fig07")


def fig08():
    fig = plt.figure(figsize=(10.4, 6.5))
    fig.suptitle("Fig. 8 of the paper: detail of the aircraft mesh, coloured by distortion", y=0.97)
    for k, (name, title) in enumerate([("initial", "(a) initial"), ("final", "(b) optimised")]):
        ax = fig.add_axes((0.02 + 0.485 * k, 0.12, 0.475, 0.76))
        panel(ax, name, style.window_around(MOTION * k, 0, 1.9), title, 0.25)
    legend(fig, (0.25, 0.085, 0.5, 0.018))
    style.save(fig, "fig08")


def surface_panel(ax, boundary, magnitude, norm, view, title):
    faces = inner_faces(boundary)
    shapes, front, brightness = solid.seen(boundary.points, faces, **view)
    colours = style.MULTIPLIER(norm(np.exp(np.log(magnitude[faces[front]]).mean(axis=1))))
    colours[:, :3] *= brightness[:, None]
    style.polygons(ax, shapes, line_width=0.15, line=colours, face=colours)
    low, high = shapes.reshape(-1, 2).min(axis=0), shapes.reshape(-1, 2).max(axis=0)
    half = 0.52 * max(high[0] - low[0], (high[1] - low[1]) / 0.75)
    style.picture(ax, style.window_around(*(0.5 * (low + high)), half, 0.75 * half), title, frame=False)


def fig09():
    boundary = read_vtk(runs.path_of("aircraft", "boundary.vtk"))
    magnitude = boundary.point_data["multiplier_magnitude"]
    on_aircraft = magnitude[np.unique(inner_faces(boundary))]
    low, high = on_aircraft.min(), on_aircraft.max()
    magnitude = np.maximum(magnitude, 1e-12 * high)
    norm = style.logarithmic(*np.percentile(on_aircraft, [0.2, 99.8]))

    fig = plt.figure(figsize=(11.2, 5.7))
    fig.suptitle("Fig. 9 of the paper: magnitude of the Lagrange multipliers on the aircraft", y=0.97)
    views = [("(a) top view", {"towards": (0, 0, 1), "up": (0, 1, 0)}),
             ("(b) perspective view", {"towards": (-1, -0.9, 0.75), "up": (0, 0, 1), "distance": 5})]
    for k, (title, view) in enumerate(views):
        surface_panel(fig.add_axes((0.01 + 0.49 * k, 0.15, 0.48, 0.72)), boundary, magnitude, norm, view, title)
    style.colour_bar(fig, fig.add_axes((0.25, 0.115, 0.5, 0.02)), norm, style.MULTIPLIER,
                     f"(c) magnitude of λ, logarithmic; from {low:.1e} to {high:.1e} on the aircraft", extend="both")
    style.save(fig, "fig09")

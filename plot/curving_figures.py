"""Figures 4 and 5: the boundary layer before and after curving, coloured by the distance to the wall."""
import numpy as np

import runs
import style
from style import plt
from vtk_mesh import boundary_edges, curves, inner_faces, outlines, read_vtk, refined_triangles, thickness, touching

WHOLE = style.window_around(0, 0, 21.6)
LAYER = style.window_around(0, 0, 3.6)
WALL = style.window_around(0, 0, 1.35)
# Details around the middle of a wall edge, each moved outwards so that the wall is to the left.
EDGE_MIDDLE = np.array([np.cos(np.pi / 12), np.sin(np.pi / 12)])
NORM = style.logarithmic(1e-6, 20)
TICKS = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1, 10]
THINNEST = 0.006  # least thickness, in widths of the window, of a cell whose outline is drawn


def detail(half_width, outwards):
    return style.window_around(*((1 + outwards * half_width) * EDGE_MIDDLE), half_width)


def by_distance(ax, mesh, window, title, line_width=0.25, levels=0, norm=NORM):
    """The distance inside the elements, zero in the least colour, and the outlines that can be told apart."""
    points, distance, triangles = refined_triangles(mesh, "wall_distance", window, 8, levels + 1)
    ax.tripcolor(*points.T, triangles, np.maximum(distance, norm.vmin), norm=norm, cmap=style.DISTANCE,
                 shading="gouraud", rasterized=True)
    chosen = touching(mesh, window)
    chosen = chosen[thickness(mesh, chosen) > THINNEST * (window[1] - window[0])]
    style.mesh_lines(ax, outlines(mesh, chosen, 16 * 2**levels), line_width, (1, 1, 1, 0.55))
    style.picture(ax, window, title)


def fig04():
    initial = read_vtk(runs.path_of("curving", "initial.vtk"))
    fig = plt.figure(figsize=(10.4, 5.75))
    fig.suptitle("Fig. 4 of the paper: initial linear mesh with a boundary layer around the inner circle", y=0.97)
    axes = [fig.add_axes((0.015 + 0.49 * k, 0.02, 0.48, 0.48 * 10.4 / 5.75)) for k in range(2)]
    titles = ("(a) full view", "(b) detail: 42 layers, the first 1e-5 thick")
    for ax, window, title in zip(axes, (WHOLE, LAYER), titles):
        style.polygons(ax, outlines(initial, touching(initial, window), 1), line_width=0.3)
        style.picture(ax, window, title)
    style.show_detail(axes[0], LAYER, "b")
    style.save(fig, "fig04")


def multipliers(ax, final, boundary, window, length):
    """The multipliers at the wall's nodes as arrows, the longest of the given length."""
    style.mesh_lines(ax, outlines(final, touching(final, window), 8), 0.2, (0.11, 0.15, 0.20, 0.2))
    nodes = np.unique(inner_faces(boundary))
    style.polylines(ax, curves(boundary, 512), 1.1)
    style.arrows(ax, boundary.points[nodes, :2], boundary.point_data["multipliers"][nodes, :2], length, 0.005)
    style.picture(ax, window, "(c) Lagrange multipliers on the boundary nodes")


def fig05():
    initial, final, boundary = (read_vtk(runs.path_of("curving", f"{name}.vtk"))
                                for name in ("initial", "final", "boundary"))
    details = [detail(0.25, 0.45), detail(0.02, 0.5), detail(5e-4, 0.5)]
    fig = plt.figure(figsize=(12.6, 8.9))
    fig.suptitle("Fig. 5 of the paper: boundary layer curved in degree 4, coloured by wall distance", y=0.978)
    axes = [fig.add_axes((0.015 + 0.305 * (k % 3), 0.49 - 0.47 * (k // 3), 0.295, 0.4175)) for k in range(6)]
    by_distance(axes[0], initial, WALL, "(a) initial: straight")
    by_distance(axes[1], final, WALL, "(b) optimised: curved")
    multipliers(axes[2], final, boundary, WALL, 0.3)
    by_distance(axes[3], final, details[0], "(d) optimised, detail 0.5 wide; dashed: initial wall", 0.35, 2)
    style.polylines(axes[3], boundary_edges(initial), 1.0, style.ACCENT, "dashed")
    by_distance(axes[4], final, details[1], "(d) detail 0.04 wide", 0.35, 4)
    by_distance(axes[5], final, details[2], "(d) detail 0.001 wide: the thinnest layers", 0.35, 7)
    for ax, window in zip((axes[1], axes[3], axes[4]), details):
        style.show_detail(ax, window)
    style.colour_bar(fig, fig.add_axes((0.935, 0.2, 0.014, 0.55)), NORM, style.DISTANCE,
                     "(e) distance to the wall", TICKS, [f"$10^{{{round(np.log10(tick))}}}$" for tick in TICKS])
    style.save(fig, "fig05")

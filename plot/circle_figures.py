"""Figure 1: the moved circle."""
import numpy as np

import runs
import style
from style import plt
from vtk_mesh import inner_faces, outlines, read_vtk

WHOLE = style.window_around(0, 0, 21.6)
DETAIL = style.window_around(8, 0, 3.4)
MULTIPLIERS = style.window_around(8, 0, 2.1)


def draw(ax, mesh, norm, line_width):
    style.polygons(ax, outlines(mesh, slice(None), 1), mesh.cell_data["distortion"], norm, style.DISTORTION, line_width)


def multipliers(ax, mesh, boundary, length):
    """The mesh, and the multiplier at each moved boundary node as an arrow; `length` is that of the longest."""
    style.mesh_lines(ax, outlines(mesh, slice(None), 1), 0.3, (0.11, 0.15, 0.20, 0.25))
    inner = inner_faces(boundary)
    style.polylines(ax, boundary.points[inner][..., :2], 1.1)
    nodes = np.unique(inner)
    style.arrows(ax, boundary.points[nodes, :2], boundary.point_data["multipliers"][nodes, :2], length, 0.006)


def fig01():
    initial, final, boundary = (read_vtk(runs.path_of("circle", f"{name}.vtk"))
                                for name in ("initial", "final", "boundary"))
    worst = final.cell_data["distortion"].max()
    norm = style.linear(1, worst)

    fig = plt.figure(figsize=(9.2, 9.4))
    fig.suptitle("Fig. 1 of the paper: a circle moved by 8 in a mesh of non-uniform size, coloured by distortion",
                 y=0.98)
    places = [(0.03, 0.5), (0.465, 0.5), (0.03, 0.04), (0.465, 0.04)]
    a, b, c, d = (fig.add_axes((x, y, 0.42, 0.411)) for x, y in places)
    draw(a, initial, norm, 0.25)
    style.picture(a, WHOLE, "(a) initial", frame=False)
    draw(b, final, norm, 0.25)
    style.show_detail(b, DETAIL, "c")
    style.picture(b, WHOLE, "(b) optimised", frame=False)
    draw(c, final, norm, 0.4)
    style.picture(c, DETAIL, "(c) detail")
    multipliers(d, final, boundary, 0.9)
    style.picture(d, MULTIPLIERS, "(d) Lagrange multipliers on the moved boundary")
    ticks = [1, 1.5, 2, 2.5, worst] if worst > 2.6 else np.linspace(1, worst, 5)
    style.colour_bar(fig, fig.add_axes((0.91, 0.2, 0.016, 0.55)), norm, style.DISTORTION,
                     "(e) largest distortion η in the element", ticks, [f"{tick:.3g}" for tick in ticks])
    style.save(fig, "fig01")

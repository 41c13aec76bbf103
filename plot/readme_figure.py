"""readme.png: the circle before and after, and the curved boundary layer, without words."""
import circle_figures
import curving_figures
import runs
import style
from style import plt
from vtk_mesh import boundary_edges, read_vtk


def readme():
    initial, final = (read_vtk(runs.path_of("circle", f"{name}.vtk")) for name in ("initial", "final"))
    straight, curved = (read_vtk(runs.path_of("curving", f"{name}.vtk")) for name in ("initial", "final"))
    fig = plt.figure(figsize=(12, 4.35))
    axes = [fig.add_axes((k / 3 + 0.005, 0.01, 1 / 3 - 0.01, 0.91)) for k in range(3)]
    norm = style.linear(1, final.cell_data["distortion"].max())
    window = style.window_around(3.2, 0, 11.5)
    titles = ("initial mesh", f"inner circle moved by 8: η ≤ {norm.vmax:.3g}")
    for ax, mesh, title in zip(axes, (initial, final), titles):
        circle_figures.draw(ax, mesh, norm, 0.25)
        style.picture(ax, window, title)
    curving_figures.by_distance(axes[2], curved, style.window_around(0.76, 0.76, 0.56),
                                "boundary layer curved in degree 4; dashed: before", 0.35, 2,
                                style.logarithmic(1e-3, 1.5))
    style.polylines(axes[2], boundary_edges(straight), 0.9, style.ACCENT, "dashed")
    style.save(fig, "readme")

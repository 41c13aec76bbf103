"""Look of the figures: fonts, colours, mesh drawing, colour bars, saving."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize
from matplotlib.patches import Rectangle

import runs

INK = "#1d2733"
ACCENT = "#c2410c"
PAPER = "#8a94a0"
MESH_LINE = (0.11, 0.15, 0.20, 0.55)
DISTORTION = LinearSegmentedColormap.from_list(
    "distortion", ["#eef5fb", "#c3dcee", "#8fc3d9", "#f7d57e", "#f29b4b", "#d9482b", "#8c1127"])
DISTANCE = plt.get_cmap("viridis")
MULTIPLIER = plt.get_cmap("turbo")


def apply():
    plt.rcParams.update({
        "font.family": "DejaVu Sans", "font.size": 9, "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": INK,
        "xtick.color": INK, "ytick.color": INK, "axes.linewidth": 0.6, "axes.titlesize": 9.5, "figure.titlesize": 12,
        "xtick.major.width": 0.6, "ytick.major.width": 0.6, "savefig.dpi": 200, "legend.frameon": False})


def window_around(x, y, half_width, half_height=None):
    """(x0, x1, y0, y1)."""
    half_height = half_width if half_height is None else half_height
    return (x - half_width, x + half_width, y - half_height, y + half_height)


def picture(ax, window, title="", frame=True):
    """Axes for a picture: equal aspect, no ticks, the window filling them."""
    ax.set_xlim(window[:2])
    ax.set_ylim(window[2:])
    ax.set_aspect("equal")
    ax.set_xticks([])
    ax.set_yticks([])
    ax.set_title(title)
    for spine in ax.spines.values():
        spine.set_visible(frame)


def polygons(ax, shapes, values=None, norm=None, cmap=None, line_width=0.25, line=MESH_LINE, face="#eef5fb"):
    """Filled cells with thin mesh lines; coloured by values, or all of colour `face`."""
    cells = PolyCollection(shapes, linewidths=line_width, edgecolors=line, rasterized=True)
    if values is None:
        cells.set_facecolor(face)
    else:
        cells.set(array=np.asarray(values), norm=norm, cmap=cmap)
    ax.add_collection(cells, autolim=False)
    return cells


def mesh_lines(ax, shapes, line_width=0.25, colour=MESH_LINE):
    """Closed outlines of cells, nothing inside."""
    closed = [np.vstack([shape, shape[:1]]) for shape in shapes]
    ax.add_collection(LineCollection(closed, linewidths=line_width, colors=[colour]), autolim=False)


def polylines(ax, lines, line_width=1.0, colour=INK, dashes="solid"):
    ax.add_collection(LineCollection(lines, linewidths=line_width, colors=colour, linestyles=dashes), autolim=False)


def arrows(ax, x, force, length, width):
    """Forces (nodes x 2) at the nodes x; `length` is that of the longest, in units of x."""
    scale = np.linalg.norm(force, axis=1).max() / length
    ax.quiver(*x.T, *force.T, angles="xy", scale_units="xy", scale=scale, color=ACCENT, width=width, zorder=4)
    ax.plot(*x.T, "o", color=INK, markersize=2.2, zorder=5)


def show_detail(ax, window, label=""):
    """Frame of a detail that another panel shows."""
    x0, x1, y0, y1 = window
    ax.add_patch(Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, edgecolor=ACCENT, linewidth=0.9, zorder=5))
    if label:
        ax.annotate(label, (x1, y1), xytext=(3, 0), textcoords="offset points", color=ACCENT, va="top", fontsize=8.5)


def colour_bar(fig, ax, norm, cmap, label, ticks=None, tick_labels=None, extend="neither"):
    """Colour bar in the axes ax, upright or lying as ax is."""
    box = ax.get_position()
    lying = box.width * fig.get_figwidth() > box.height * fig.get_figheight()
    bar = fig.colorbar(plt.cm.ScalarMappable(norm, cmap), cax=ax, orientation="horizontal" if lying else "vertical",
                       extend=extend)
    if ticks is not None:
        bar.set_ticks(ticks, labels=tick_labels if tick_labels is not None else [f"{tick:g}" for tick in ticks])
    bar.ax.minorticks_off()
    bar.set_label(label)
    bar.outline.set_linewidth(0.5)
    return bar


def linear(low, high):
    return Normalize(low, high)


def logarithmic(low, high):
    return LogNorm(low, high, clip=True)


def save(fig, name):
    folder = runs.OUTPUTS / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    fig.savefig(folder / f"{name}.png", facecolor="white")
    plt.close(fig)

#!/usr/bin/env python3
"""Lesson 12: distortion of the elements, sorted, for several densities; the circle that became a star."""
import picture
from style import polygons, window_around

fig, (ax, right) = picture.figure(1, 2, size=(8.4, 3.7))
data = picture.table("12-project/eta.csv")
for density in dict.fromkeys(data["density"]):
    chosen = data["density"] == density
    label = f"f: {density}".replace("^2", "²").replace("^3", "³").replace("eta", "η").replace("-", "−")
    ax.loglog(data["rank"][chosen], data["eta"][chosen] - 1, label=label)
ax.axhline(1, color=picture.PAPER, linewidth=0.8, linestyle=":")
ax.set(title="η − 1 of the elements, sorted; dotted: M = 2", xlabel="rank", ylabel="η − 1", ylim=(0.02, 2.5))
ax.legend(fontsize=8)

star = picture.mesh("12-project/star/final.vtk")
corners = star.points[star.cells[:, :3]][:, :, :2]
name = next(key for key in star.cell_data if "distortion" in key)
cells = polygons(right, corners, star.cell_data[name], picture.style.Normalize(1, 1.5), picture.DISTORTION, 0.3)
picture.style.picture(right, window_around(3, 0, 2), "The star: η of the triangles")
fig.colorbar(cells, ax=right, shrink=0.8, label="η")
picture.save(fig, "12-project")

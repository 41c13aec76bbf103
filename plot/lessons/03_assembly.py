#!/usr/bin/env python3
"""Lesson 3: the triangles around a node, and its row among the blocks of the Hessian."""
import numpy as np

import picture
from style import mesh_lines, polygons

fig, (left, right) = picture.figure(1, 2, size=(9, 4.4))
mesh = picture.mesh("03-assembly/square.vtk")
x = mesh.points[:, :2]
node = np.argmin(np.linalg.norm(x - x.mean(axis=0), axis=1))
around = mesh.cells[(mesh.cells == node).any(axis=1)]
neighbours = np.unique(around)

mesh_lines(left, x[mesh.cells], line_width=0.4)
polygons(left, x[around], face="#f7d57e", line_width=0.8)
left.plot(*x.T, ".", color=picture.PAPER, markersize=2)
left.plot(*x[neighbours].T, "o", color=picture.ACCENT, markersize=4)
left.plot(*x[node], "o", color=picture.INK, markersize=4.5)
left.set(title=f"node {node} and its neighbours, deformed mesh", aspect="equal", xticks=[], yticks=[])

entries = np.loadtxt(picture.LESSONS / "03-assembly/hessian.mtx", skiprows=2)[:, :2].astype(int)
blocks = np.unique((entries - 1) // 2, axis=0)  # the lower triangle
row, column = np.vstack([blocks, blocks[:, ::-1]]).T
right.plot(column, row, "s", color=picture.INK, markersize=0.7)
of_node = row == node
right.plot(column[of_node], row[of_node], "s", color=picture.ACCENT, markersize=3.5)
right.set(title=f"blocks of the Hessian, row {node} marked", aspect="equal", xlabel="column", ylabel="row",
          ylim=(len(x), -1))
picture.save(fig, "03-assembly")

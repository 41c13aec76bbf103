#!/usr/bin/env python3
"""The body of least drag among those of one area in Stokes flow, with dolfinx and scipy: a circle is towed through a
box of fluid at speed 1. Its drag is the dissipation 2 (e(u), e(u)), e the symmetric gradient, whose minimum with
div u = 0 is the flow. So the Lagrangian L = 2 (e(u), e(u)) - 2 (p, div u) has no derivative by u and p: the drag's by
the nodes is that of L, exactly, in finite elements. Mesh.adjoint makes one by the body's nodes of it; BFGS moves
these along their rays, alike in all quarters: radius exp(sum z_k cos(2 k t) / sqrt(1 + k)), scaled to keep the area.
Each mesh starts from those before. `make coupling` or plot/coupling/shape.py [iterations]; python3-dolfinx."""
import logging
import sys

import clients

clients.need("python3-dolfinx python3-gmsh python3-matplotlib python3-scipy", "dolfinx", "gmsh", "matplotlib", "scipy")

import gmsh
import matplotlib.pyplot as plt
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.io import gmshio
from mpi4py import MPI
from scipy.optimize import minimize

logging.disable(logging.INFO)  # of the compiler of forms
folder = clients.new_folder("shape")
gmsh.initialize(["", "-v", "0"])
gmsh.open("plot/coupling/shape.geo")
gmsh.model.mesh.generate(2)
domain, _, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 0, gdim=2)
x, mesh = domain.geometry.x, clients.mesh_of(domain, facets, body=1, box=2)
mesh.boundary["box"].fix()
mesh.set("objective", "squared")  # has derivatives at a mesh without distortion, too
start, body = x[:, :2].copy(), mesh.boundary["body"].nodes
N = len(body) // 4  # edges of a quarter
place = np.rint(np.arcsin(abs(start[body, 1])) * 2 * N / np.pi).astype(int)  # of the body's nodes in a quarter
flow = fem.FunctionSpace(domain, ufl.VectorElement("P", "triangle", 2) * ufl.FiniteElement("P", "triangle", 1))
(V, _), (Q, _), P1 = flow.sub(0).collapse(), flow.sub(1).collapse(), fem.VectorFunctionSpace(domain, ("P", 1))
triangles, node = P1.dofmap.list.array.reshape(-1, 3), np.empty(len(x), int)  # of each unknown of degree 1
node[triangles] = domain.geometry.dofmap.array.reshape(-1, 3)
wall, box = (fem.locate_dofs_topological((flow.sub(0), V), 1, facets.find(tag)) for tag in (1, 2))
pin = [dofs[:1] for dofs in fem.locate_dofs_topological((flow.sub(1), Q), 1, facets.find(2)[:1])]  # pressure 0
towed, state = fem.Function(V), fem.Function(flow)
towed.interpolate(lambda at: np.eye(2)[:, :1] + 0 * at[:2])
fixed = [fem.dirichletbc(fem.Function(V), wall, flow.sub(0)), fem.dirichletbc(towed, box, flow.sub(0)),
         fem.dirichletbc(fem.Function(Q), pin, flow.sub(1))]
(u, p), zero = ufl.split(state), fem.Constant(domain, 0.0) * ufl.TestFunctions(flow)[1] * ufl.dx
L = 2 * (ufl.inner(ufl.sym(ufl.grad(u)), ufl.sym(ufl.grad(u))) - p * ufl.div(u)) * ufl.dx
stokes = fem.petsc.LinearProblem(ufl.derivative(ufl.derivative(L, state), state), zero, fixed, state,
                                 {"ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"})
drag, by_nodes = fem.form(L), fem.form(ufl.derivative(L, ufl.SpatialCoordinate(domain), ufl.TestFunction(P1)))
modes = (np.cos(np.outer(range(N + 1), range(N + 1)) * np.pi / N) / np.sqrt(1 + np.arange(N + 1)))[:, 1:] / 4
seen, rows, z, (_, axes) = {}, [], np.zeros(N), plt.subplots(1, 3, figsize=(11, 2.8), layout="constrained")


def value(z):
    """Drag and derivatives by z."""
    r = np.exp(modes @ z)
    r *= np.sqrt(N / (r[1:] @ r[:-1]))  # the body's area is 2 r[1:] @ r[:-1] sin(pi / 2 / N)
    mesh.boundary["body"].move_to(r[place, None] * start[body])
    told = mesh.frame(len(seen))
    x[:, :2] = mesh.x
    stokes.solve()
    by_x = np.empty_like(start)
    by_x[node] = fem.petsc.assemble_vector(by_nodes).array.reshape(-1, 2)
    g = np.bincount(place, (start * mesh.adjoint(by_x))[body].sum(axis=1))
    g = r * (g - (r @ g) / (2 * N) * (np.append(r[1:], 0) + np.append(0, r[:-1]))) @ modes
    a, b, edge = np.cos(np.pi / 2 / N), np.sin(np.pi / 2 / N), 2 * np.sin(np.pi / 4 / N)
    seen[z.tobytes()] = (fem.assemble_scalar(drag), abs(g).max(), 2 * np.degrees(np.arctan2(r[1] * b, r[0] - r[1] * a)),
                         abs(r - 1).max() / edge, told.max_distortion, told.certified_injective)
    return seen[z.tobytes()][0], g


def report(z):
    rows.append(seen[z.tobytes()])
    print("| {} | {:.5f} | {:.1g} | {:.1f} | {:.1f} | {:.3f} | {} |".format(len(rows) - 1, *rows[-1]), flush=True)


def draw(ax, z):
    value(z)
    at, pressure = (*x[node, :2].T, triangles), state.sub(1).collapse().x.array
    ax.tripcolor(*at, pressure - pressure.mean(), clim=(-1, 1), cmap="coolwarm")
    ax.triplot(*at, color="black", linewidth=0.3)
    ax.set(aspect="equal", xlim=(-2.2, 2.2), ylim=(-1.5, 1.5), xticks=[], yticks=[])


draw(axes[0], z)
print("| iteration | drag | largest derivative | tip, degrees | moved by edges | η | certified |\n" + 7 * "|---" + "|")
report(z)
z = minimize(value, z, jac=True, method="BFGS", callback=report,
             options={"gtol": 1e-4, "maxiter": int((sys.argv + [50])[1])}).x
draw(axes[1], z)
axes[2].semilogy([(row[0] - rows[-1][0], row[1]) for row in rows[:-1]], "o-", label=["drag - least", "derivative"])
axes[2].legend()
plt.savefig(folder / "shape.png", dpi=80)
slope, half, h = value(z / 2)[1] @ z, z / 2, 1e-5
difference = (value(half + h * z)[0] - value(half - h * z)[0]) / (2 * h)
print(f"halfway, along the way: derivative {slope:.7f}, difference of whole runs {difference:.7f}")

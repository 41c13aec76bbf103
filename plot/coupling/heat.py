#!/usr/bin/env python3
"""A flow and the heat in it on a moving mesh, with dolfinx: a plate pitches and plunges in a box full of a viscous
fluid, hot above and cold below. In each step Stokes' equations give the velocity u, and the temperature follows the
conservative ALE form d/dt (T, s) + k (grad T, grad s) - (T (u - w), grad s) = 0, w the mesh's velocity. With u and w on
the mesh halfway the heat is conserved, and T = 1 stays, to rounding. `make coupling`; Debian: python3-dolfinx."""
import logging

import clients

clients.need("python3-dolfinx python3-gmsh python3-matplotlib python3-scipy", "dolfinx", "gmsh", "matplotlib", "scipy")

import gmsh
import matplotlib.pyplot as plt
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.io import gmshio
from mpi4py import MPI
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

STEPS = 40
LU = {"ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"}
logging.disable(logging.INFO)  # of the compiler of forms
folder = clients.new_folder("heat")
print("dolfinx: heat in the flow around a moving plate")
gmsh.initialize(["", "-v", "0"])
gmsh.open("inputs/meshes/plate.msh")
domain, _, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 0, gdim=2)
x, mesh = domain.geometry.x, clients.mesh_of(domain, facets, plate=1, box=2)
mesh.boundary["plate"].motion = 'rotate "60*sin(2*pi*t)" about 0 0; translate 0 "2*(1 - cos(2*pi*t))"'
mesh.boundary["box"].fix()
P1, P2 = ufl.FiniteElement("P", "triangle", 1), ufl.VectorElement("P", "triangle", 2)
Q, flow = fem.FunctionSpace(domain, P1), fem.FunctionSpace(domain, P2 * P1)
V, _ = flow.sub(0).collapse()
w, wall, velocity = fem.Function(fem.VectorFunctionSpace(domain, ("P", 1))), fem.Function(V), fem.Function(V)
triangles = Q.dofmap.list.array.reshape(-1, 3)
node = np.empty(len(x), int)  # of each unknown of degree 1
node[triangles] = domain.geometry.dofmap.array.reshape(-1, 3)
pressure = fem.locate_dofs_topological((flow.sub(1), Q), 1, facets.indices[:1])
fixed = [fem.dirichletbc(wall, fem.locate_dofs_topological((flow.sub(0), V), 1, facets.indices), flow.sub(0)),
         fem.dirichletbc(fem.Function(Q), [dofs[:1] for dofs in pressure], flow.sub(1))]  # at one node: 0
(u, p), (v, q), T, s = ufl.TrialFunctions(flow), ufl.TestFunctions(flow), ufl.TrialFunction(Q), ufl.TestFunction(Q)
stokes = fem.petsc.LinearProblem((ufl.inner(ufl.grad(u), ufl.grad(v)) - p * ufl.div(v) - q * ufl.div(u)) * ufl.dx,
                                 ufl.inner(fem.Constant(domain, (0.0, 0.0)), v) * ufl.dx, fixed, petsc_options=LU)
mass = T * s * ufl.dx
spread = (2 * ufl.inner(ufl.grad(T), ufl.grad(s)) - T * ufl.inner(velocity - w, ufl.grad(s))) * ufl.dx  # k = 2


def matrix(form):
    assembled = fem.petsc.assemble_matrix(fem.form(form))
    assembled.assemble()
    return csr_matrix(assembled.getValuesCSR()[::-1])


_, axes = plt.subplots(1, 4, figsize=(12, 3.2), layout="constrained")
heat, one, now, eta = np.where(x[node, 1] > 0, 1.0, 0.0), np.ones(len(x)), matrix(mass), 1
print("t; relative changes of the area, 399, and of the heat, 199.5; largest change of T = 1")
for k in range(1, STEPS + 1):
    old, eta = x.copy(), max(eta, mesh.frame(k / STEPS).max_distortion)
    new = np.column_stack([mesh.x, 0 * old[:, 2]])
    x[:] = (old + new) / 2
    if not mesh.certify(x[:, :2]):
        raise SystemExit(f"t = {k / STEPS}: the mesh halfway is not valid")
    w.x.array[:] = STEPS * (new - old)[node, :2].flatten()
    wall.interpolate(w)
    velocity.x.array[:] = stokes.solve().sub(0).collapse().x.array
    change, content = matrix(spread) / STEPS, now @ np.column_stack([heat, one])
    x[:] = new
    now = matrix(mass)
    heat, one = spsolve(now + change, content).T
    if k % 10 == 0:
        print(f"{k / STEPS:.2f}  {now.sum() / 399 - 1:8.1e}  {(now @ heat).sum() / 199.5 - 1:8.1e}  "
              f"{abs(one - 1).max():.1e}")
        ax = axes[k // 10 - 1]
        ax.tripcolor(*new[node, :2].T, triangles, heat, shading="gouraud", clim=(0, 1))
        ax.triplot(*new[node, :2].T, triangles, color="white", linewidth=0.15)
        ax.set(title=f"t = {k / STEPS}", aspect="equal", xticks=[], yticks=[])
plt.savefig(folder / "heat.png", dpi=90)
print(f"almesh: {STEPS} meshes, all certified, and those halfway; eta up to {eta:.3f}")

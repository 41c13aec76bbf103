#!/usr/bin/env python3
"""A plate sinks in a viscous fluid, coupled both ways: dolfinx solves Stokes' equations around the plate, the plate
moves so fast that its drag is equal to its weight, and almesh moves the mesh. A step is that of the implicit midpoint
rule: the mesh of its middle is asked for at the same time again until the plate is where its velocity there takes it.
Then the weight acts upwards, and as Stokes' flow is reversible, plate and mesh must come back. `make coupling`."""
import logging

import clients

clients.need("python3-dolfinx python3-gmsh", "dolfinx", "gmsh")

import gmsh
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.io import gmshio
from mpi4py import MPI

STEPS, DT, WEIGHT, LEVER = 5, 0.6, 20, 0.5  # the weight acts at this distance from the middle of the plate
LU = {"ksp_type": "preonly", "pc_type": "lu", "pc_factor_mat_solver_type": "mumps"}
logging.disable(logging.INFO)  # of the compiler of forms
gmsh.initialize(["", "-v", "0"])
gmsh.open("inputs/meshes/plate.msh")
domain, _, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 0, gdim=2)
x, start = domain.geometry.x, domain.geometry.x.copy()
mesh = clients.mesh_of(domain, facets, plate=1, box=2)
mesh.boundary["box"].fix()
on_plate = mesh.boundary["plate"].nodes
flow = fem.FunctionSpace(domain, ufl.VectorElement("P", "triangle", 2) * ufl.FiniteElement("P", "triangle", 1))
(V, _), (Q, _) = flow.sub(0).collapse(), flow.sub(1).collapse()
plate, box = (fem.locate_dofs_topological((flow.sub(0), V), 1, facets.find(tag)) for tag in (1, 2))
pressure = fem.locate_dofs_topological((flow.sub(1), Q), 1, facets.find(2)[:1])
wall, flows = fem.Function(V), [fem.Function(V) for _ in range(3)]
fixed = [fem.dirichletbc(wall, plate, flow.sub(0)), fem.dirichletbc(fem.Function(V), box, flow.sub(0)),
         fem.dirichletbc(fem.Function(Q), [dofs[:1] for dofs in pressure], flow.sub(1))]  # at one node: 0
(u, p), (v, q) = ufl.TrialFunctions(flow), ufl.TestFunctions(flow)


def friction(a, b):
    return 2 * ufl.inner(ufl.sym(ufl.grad(a)), ufl.sym(ufl.grad(b))) * ufl.dx


stokes = fem.petsc.LinearProblem(friction(u, v) - (p * ufl.div(v) + q * ufl.div(u)) * ufl.dx,
                                 ufl.inner(fem.Constant(domain, (0.0, 0.0)), v) * ufl.dx, fixed, petsc_options=LU)
drag = [[fem.form(friction(a, b)) for b in flows] for a in flows]


def velocity(t, place, weight):
    """Of the plate at (x, y, angle) at time t, and its turning: those at which the drag is equal to the weight."""
    c, s = np.cos(place[2]), np.sin(place[2])
    target = start[on_plate, :2] @ [[c, s], [-s, c]] + place[:2]
    mesh.boundary["plate"].move_to(target)
    results.append(mesh.frame(t))
    x[:, :2] = mesh.x
    for motion, mode in zip(flows, np.eye(3)):
        wall.interpolate(lambda at: (mode[0] - mode[2] * (at[1] - place[1]), mode[1] + mode[2] * (at[0] - place[0])))
        motion.x.array[:] = stokes.solve().sub(0).collapse().x.array
    forces = [[fem.assemble_scalar(form) for form in row] for row in drag]
    return np.linalg.solve(forces, np.array([0, -1, -LEVER * c]) * weight)


results, place, speed = [], np.zeros(3), np.zeros(3)
print("dolfinx: a plate sinks and rises; time, place and angle of the plate, meshes asked for in the step")
for k in range(2 * STEPS):
    middle, last, count = place + DT / 2 * speed, place + 9, 0
    while abs(middle - last).max() > 1e-9:
        last, count = middle, count + 1
        speed = velocity((k + 0.5) * DT, middle, WEIGHT if k < STEPS else -WEIGHT)
        middle = place + DT / 2 * speed
    place = 2 * middle - place
    print(f"{(k + 1) * DT:.2f}  {place[0]:7.4f}  {place[1]:7.4f}  {np.degrees(place[2]):7.2f}  {count}")
velocity(2 * STEPS * DT, place, 0)
print(f"at the end the plate is {abs(place).max():.0e} from its start, the nodes at most {abs(x - start).max():.0e}")
print(f"almesh: {len(results)} meshes, all certified, eta up to {max(r.max_distortion for r in results):.3f}")

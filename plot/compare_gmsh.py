#!/usr/bin/env python3
"""Curved CAD meshes mended by almesh and by gmsh's high-order optimisers, in one table.

  plot/compare_gmsh.py          the same as `make compare-gmsh`: all cases, outputs/compare-gmsh/table.md
  plot/compare_gmsh.py NAME...  those whose names contain one of the words

Needs gmsh's Python module and numpy (Debian: python3-gmsh, python3-numpy). Every mesh is made anew from its geometry in
inputs/cad/, and component8.step of gmsh's demos (Debian: gmsh-doc) where it is installed. gmsh's optimisers are those of
its option Mesh.HighOrderOptimize: 1 optimisation, 2 elastic analogy, then optimisation, 3 elastic analogy, 4 fast
curving. Per mesh and method:

  invalid    elements that `almesh quality` does not certify; "overlaps" where it certifies all, but not that the mesh is
             injective
  eta        largest distortion of an element with respect to the straight one of gmsh's linear mesh, at a grid of points
  distance   largest distance of a grid of points of the boundary faces from their CAD surfaces, over the mesh size h
  seconds    of the optimiser alone; of almesh its iterations, and in brackets the whole run: reading, checking the
             target, iterations, certificates, writing

almesh moves the whole mesh, or with `local_repair = 1` what is inverted and about a layer around it. Where gmsh's own mesh
has invalid elements, the fastest method that leaves none is marked. Every run has a process of its own, one thread, and
ends after LIMIT seconds.
"""
import itertools
import sys
from pathlib import Path

import cad
import runs

FOLDER = runs.OUTPUTS / "compare-gmsh"
STEP = Path("/usr/share/doc/gmsh-doc/doc/gmsh/demos/boolean/component8.step.gz")
LIMIT = 60
ALMESH = {"almesh": 0, "almesh, inverted only": 1}  # its key `local_repair`
GRID = 8  # points along the edge of an element

# geometry: sizes h
GEOMETRIES = {"cylinder-box": [0.5], "layers": [0.5, 0.3], "torus": [0.35, 0.21],
              "torus-in-sphere": [0.5, 0.3], "ellipsoid": [0.4, 0.3], "component8": [10, 5]}


def cases():
    """[(name, geometry, h, degree)]."""
    return [(f"{geometry} h={h} degree={degree}", geometry, h, degree)
            for geometry, sizes in GEOMETRIES.items() for h in sizes for degree in (2, 3)
            if geometry != "component8" or STEP.exists()]


def folder_of(name):
    return FOLDER / name.replace(" ", "-").replace("=", "")


# ---------------------------------------------------------------- in a process of its own: gmsh

def open_geometry(geometry, h):
    gmsh = cad.start_gmsh(h=h)
    if geometry == "component8":
        gmsh.open(str(cad.unpacked(STEP, FOLDER)))
        gmsh.option.setNumber("Mesh.MeshSizeMin", h)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 2 * h)
        gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)])
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getEntities(2)])
    else:
        gmsh.open(str(cad.ROOT / "inputs" / "cad" / f"{geometry}.geo"))
    return gmsh


def make(geometry, h, degree, optimiser, path):
    """Writes the mesh of the degree, optimised or not, and that before it was; prints the optimiser's seconds."""
    gmsh = open_geometry(geometry, float(h))
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(int(degree))
    gmsh.write(path + ".before.msh")  # of this process: gmsh may number the next one's otherwise
    print(cad.optimise(gmsh, int(optimiser)))
    gmsh.write(path)


class Basis:
    """Lagrange polynomials of a gmsh element type, at a grid of barycentric points."""

    def __init__(self, gmsh, element_type):
        import numpy as np
        _, self.dim, degree, self.count, nodes, _ = gmsh.model.mesh.getElementProperties(element_type)
        nodes = np.array(nodes).reshape(self.count, -1)[:, :self.dim]
        powers = [p for p in itertools.product(range(degree + 1), repeat=self.dim) if sum(p) <= degree]
        points = np.array([p for p in itertools.product(range(GRID + 1), repeat=self.dim) if sum(p) <= GRID]) / GRID

        def monomials(at, lowered=None):
            columns = []
            for power in powers:
                column, power = np.ones(len(at)), list(power)
                if lowered is not None:
                    column *= power[lowered]
                    power[lowered] = max(0, power[lowered] - 1)
                for k, exponent in enumerate(power):
                    column = column * at[:, k] ** exponent
                columns.append(column)
            return np.array(columns).T

        inverse = np.linalg.inv(monomials(nodes))
        self.values = monomials(points) @ inverse
        self.gradients = [monomials(points, k) @ inverse for k in range(self.dim)]


def measure(geometry, h, mesh, reference):
    """Prints eta and distance over h of the mesh; reference: the same nodes before they were optimised."""
    import numpy as np
    gmsh = open_geometry(geometry, float(h))

    def read(path):
        """{element type: (entity, nodes)}, {node: position}."""
        lines = Path(path).read_text().split("\n")
        at = lines.index("$Nodes")
        position = {int(line.split()[0]): [float(v) for v in line.split()[1:4]]
                    for line in lines[at + 2:at + 2 + int(lines[at + 1])]}
        at = lines.index("$Elements")
        of_type = {}
        for line in lines[at + 2:at + 2 + int(lines[at + 1])]:
            words = [int(word) for word in line.split()]
            of_type.setdefault(words[1], []).append((words[4], words[3 + words[2]:]))
        return of_type, position

    of_type, position = read(mesh)
    _, before = read(reference)
    eta = distance = 0
    for element_type, elements in of_type.items():
        basis = Basis(gmsh, element_type)
        x = np.array([[position[i] for i in nodes] for _, nodes in elements])
        if basis.dim == 3:
            y = np.array([[before[i] for i in nodes[:4]] for _, nodes in elements])
            ideal = np.stack([y[:, k + 1] - y[:, 0] for k in range(3)], axis=2)
            J = np.stack([np.einsum("qi,eia->eqa", g, x) for g in basis.gradients], axis=3)
            F = np.einsum("eqab,ebc->eqac", J, np.linalg.inv(ideal))
            det = np.linalg.det(F)
            squared = np.einsum("eqab,eqab->eq", F, F)
            with np.errstate(divide="ignore", invalid="ignore"):
                values = np.where(det > 0, squared / (3 * np.abs(det) ** (2 / 3)), np.inf)
            eta = max(eta, values.max())
        if basis.dim == 2:
            points = np.einsum("qi,eia->eqa", basis.values, x)
            for (entity, _), of_face in zip(elements, points):
                closest, _ = gmsh.model.getClosestPoint(2, entity, of_face.ravel().tolist())
                apart = np.linalg.norm(np.array(closest).reshape(-1, 3) - of_face, axis=1)
                distance = max(distance, apart.max())
    print(eta, distance / float(h))


# ---------------------------------------------------------------- the table

def printed(function, *arguments):
    """Words that it prints in a process of its own, or None where it fails or takes too long."""
    code, words, _ = cad.in_process(__file__, function, *arguments, limit=LIMIT)
    return words if code == 0 else None


def run_almesh(mesh, folder, local_repair):
    """(final mesh, seconds of the iterations, of the whole run), or None."""
    output = folder / f"almesh-{local_repair}"
    code, summary, seconds = cad.run_almesh(mesh, output, [f"local_repair={local_repair}"], LIMIT)
    final = output / "final.msh"
    return (final, float(summary["time_total"]), seconds) if code is not None and final.exists() else None


def compare(name, geometry, h, degree):
    """[(method, seconds, invalid, eta, distance, seconds of the run)]; seconds None: it failed or took too long."""
    folder = folder_of(name)
    folder.mkdir(parents=True, exist_ok=True)
    raw = folder / "gmsh-0.msh"
    if printed(make, geometry, h, degree, 0, raw) is None:
        raise SystemExit(f"compare_gmsh.py: gmsh could not make {name}")
    results = []

    def add(method, mesh, seconds, of_run=None):
        before = raw if mesh.parent != folder else Path(f"{mesh}.before.msh")
        found = printed(measure, geometry, h, mesh, before) or ["nan", "nan"]
        results.append((method, seconds, cad.certificate(mesh)[1], float(found[0]), float(found[1]), of_run))

    add("none", raw, 0.0)
    for optimiser in cad.OPTIMISERS:
        mesh = folder / f"gmsh-{optimiser}.msh"
        seconds = printed(make, geometry, h, degree, optimiser, mesh)
        if seconds is None:
            results.append((f"gmsh {optimiser}", *[None] * 5))
        else:
            add(f"gmsh {optimiser}", mesh, float(seconds[0]))
    for method, local_repair in ALMESH.items():
        final = run_almesh(raw, folder, local_repair)
        if final is None:
            results.append((method, *[None] * 5))
        else:
            add(method, *final)
    return results


def cell(result, fastest):
    method, seconds, invalid, eta, distance, of_run = result
    if seconds is None:
        return f"- (over {LIMIT} s, or failed)"
    text = f"{invalid}; {eta:.3g}; {distance:.2g}; {seconds:.2g} s" + (f" ({of_run:.2g} s)" if of_run else "")
    return f"**{text}**" if method == fastest else text


def main(words):
    chosen = [case for case in cases() if not words or any(word in case[0] for word in words)]
    methods = ["none", *(f"gmsh {k}" for k in cad.OPTIMISERS), *ALMESH]
    lines = ["invalid elements; largest eta; distance from the CAD over h; seconds", "",
             "| mesh | " + " | ".join(methods) + " |", "|---" * (len(methods) + 1) + "|"]
    print("\n".join(lines))
    for case in chosen:
        results = compare(*case)
        valid = [r for r in results if r[1] is not None and r[2] == "0" and r[0] != "none"]
        fastest = min(valid, key=lambda r: r[1])[0] if valid and results[0][2] != "0" else None
        lines.append(f"| {case[0]} | " + " | ".join(cell(r, fastest) for r in results) + " |")
        print(lines[-1], flush=True)
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / "table.md").write_text("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    PARTS = {"--make": make, "--measure": measure}
    if len(sys.argv) > 1 and sys.argv[1] in PARTS:
        PARTS[sys.argv[1]](*sys.argv[2:])
    else:
        sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""A baseline for `almesh improve` that knows nothing of it: corners of straight cells, and nodes moved for the least.

  plot/corners.py FILE ...            number of cells; least, first per cent and mean of their least corners
  plot/corners.py improve FILE [TO]   before and after, with the seconds, and the least corner with all nodes fixed,
                                      which no such method exceeds; the mesh is written to TO, in MSH 2.2

The scaled Jacobian s of a corner is Verdict's: the determinant of the edges there over the product of their lengths,
divided by that of the regular cell (cell_mesh.py). The nodes inside move and the boundary stays: L-BFGS (scipy)
minimises

    sum exp(-k s) / k over all corners,   k = 10, 20, 40, 80, 120,

with up to 150 iterations each. It goes to the least s as k grows, and is finite where cells are inverted. The result is
the best of these meshes and of that of the file, by its least corner that can move. Files are those of cell_mesh.py.
numpy, scipy (Debian: python3-numpy python3-scipy).
"""
import sys
import time

import numpy as np

import cell_mesh

POWERS, ITERATIONS = (10, 20, 40, 80, 120), 150
TINY = 1e-12  # of a typical edge: no edge is taken for shorter


def on_boundary(mesh):
    """The nodes of faces of one cell alone, and of those that the file has as boundary."""
    on = mesh.boundary()
    for nodes in mesh.outer_faces().values():
        on[nodes] = True
    return on


def corners_of(mesh):
    """(nodes, corners x (1 + dim): a vertex and the ends of its edges; determinant over lengths of the regular cell).
    Raises ValueError of curved cells."""
    if any(cell.degree > 1 for cell, _ in mesh.cells()):
        raise ValueError("its cells are curved: the corners are those of straight cells")
    rows = [(nodes[:, corner], cell.regular) for cell, nodes in mesh.cells() for corner in cell.corners]
    return (np.concatenate([nodes for nodes, _ in rows]),
            np.concatenate([np.full(len(nodes), regular) for nodes, regular in rows]))


class Corners:
    """Of a mesh whose nodes are at x. nodes, regular: of these corners, as corners_of() has them."""

    def __init__(self, nodes, regular, x):
        from scipy import sparse
        self.regular = regular
        count, ones = len(nodes), np.ones(len(nodes))
        ends = lambda k: sparse.csr_matrix((ones, (np.arange(count), nodes[:, k])), (count, len(x)))
        self.edges = [ends(k) - ends(0) for k in range(1, nodes.shape[1])]  # edge k = edges[k] x
        self.h = np.median(np.linalg.norm(self.edges[0] @ x, axis=1)) if count else 1.0

    def scaled(self, x):
        """(s, function that takes dE/ds to dE/dx)"""
        edges = [edge @ x for edge in self.edges]
        lengths = [np.maximum(np.linalg.norm(e, axis=1), TINY * self.h) for e in edges]
        third = edges[2] if len(edges) == 3 else np.broadcast_to((0.0, 0.0, 1.0), edges[0].shape)
        normals = np.cross(edges[1], third), np.cross(third, edges[0]), np.cross(edges[0], edges[1])
        scale = np.prod(lengths, axis=0) * self.regular
        s = np.einsum("ij,ij->i", edges[0], normals[0]) / scale

        def gradient(by_s):
            return sum(matrix.T @ (by_s[:, None] * (normal / scale[:, None] - (s / length ** 2)[:, None] * edge))
                       for matrix, edge, length, normal in zip(self.edges, edges, lengths, normals))
        return s, gradient

    def least(self, x):
        return self.scaled(x)[0].min(initial=np.inf)


def improve(mesh, seconds=np.inf):
    """Moves the nodes inside; after these seconds of the processor for no further k. Returns the least s of a corner
    whose nodes are all fixed. Raises ValueError of curved cells."""
    end = time.process_time() + seconds
    fixed = on_boundary(mesh)
    nodes, regular = corners_of(mesh)
    moves = ~fixed[nodes].all(axis=1)
    corners = Corners(nodes[moves], regular[moves], mesh.x)
    best, x = mesh.x, mesh.x
    for k in POWERS if moves.any() else []:
        if time.process_time() > end:
            break
        x = minimised(corners, ~fixed, mesh.dim, x, k)
        if corners.least(x) >= corners.least(best):
            best = x
    mesh.x = best
    return Corners(nodes[~moves], regular[~moves], mesh.x).least(mesh.x)


def minimised(corners, free, dim, start, k):
    """Positions with a lower sum of exp(-k s) / k."""
    from scipy.optimize import minimize
    shift = corners.least(start)  # keeps the largest term at 1

    def moved(d):
        x = start.copy()
        x[free, :dim] += corners.h * d.reshape(-1, dim)
        return x

    def energy(d):
        s, gradient = corners.scaled(moved(d))
        terms = np.exp(-k * (s - shift))
        return terms.sum() / k, corners.h * gradient(-terms)[free, :dim].ravel()

    return moved(minimize(energy, np.zeros(free.sum() * dim), jac=True, method="L-BFGS-B",
                          options={"maxiter": ITERATIONS}).x)


def text(mesh):
    s = mesh.scaled_jacobians()
    return (f"{len(s)} cells: least {s.min():.4f}, first per cent {np.quantile(s, 0.01):.4f}, mean {s.mean():.4f}, "
            f"not positive {(s <= 0).sum()}")


def main(words):
    if not words or words in (["improve"], ["--help"]) or (words[0] == "improve" and len(words) > 3):
        raise SystemExit(__doc__)
    is_improve = words[0] == "improve"
    for path in words[1:2] if is_improve else words:
        try:
            mesh = cell_mesh.read(path)
            print(f"{path}: {text(mesh)}", flush=True)
            if is_improve:
                start = time.process_time()
                least_fixed = improve(mesh)
                print(f"after {time.process_time() - start:.1f} s: {text(mesh)}; corners with all nodes fixed: "
                      + (f"least {least_fixed:.4f}" if np.isfinite(least_fixed) else "none"))
        except (OSError, ValueError) as error:
            raise SystemExit(f"{path}: {error}")
        if is_improve and len(words) == 3:
            cell_mesh.write(mesh, words[2])


if __name__ == "__main__":
    main(sys.argv[1:])

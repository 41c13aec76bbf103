"""Two published methods that move the inner nodes of a mesh, written after the papers in numpy and scipy: their quality
can be compared with, their times are those of this script.

foldover: V. Garanzha, I. Kaporin, L. Kudryavtseva, F. Protais, N. Ray, D. Sokolov, "Foldover-free maps in 50 lines of
code", ACM TOG 40 (2021). With J the Jacobian matrix of the map from the ideal simplex and D its determinant,

    E = sum |T| ((1 - theta) |J|^2 / chi^(2/d) + theta (D^2 + 1) / chi),   chi = (D + sqrt(eps^2 + D^2)) / 2,

is minimised by L-BFGS for smaller and smaller eps: with the least D, the fall s >= 1/10 of E and mu = (1 - s) chi(D),
eps = 2 sqrt(mu (mu - D)). theta = 1/2, and the tolerances are those of the authors' program.

slim: M. Rabinovich, R. Poranne, D. Panozzo, O. Sorkine-Hornung, "Scalable locally injective mappings", ACM TOG 36
(2017). The symmetric Dirichlet energy sum |T| (|J|^2 + |J^-1|^2) is minimised by steps of weighted least squares: with
J = U S V' the proxy is |W (J - R)|^2, R = U V', W = U sqrt((S - S^-3) / (S - 1)) U'. Each step is as long as the mesh
stays valid.

Ideal simplices are regular; of quadrilaterals, hexahedra and prisms those at the corners, with the edges of the regular
cell. Their volume is the mean of the cells' around.
"""
import time

import numpy as np
import scipy.optimize
import scipy.sparse as sparse
import scipy.sparse.linalg

SECONDS = 40  # of the processor; then the mesh is as it was at the end of the last step


class Simplices:
    """Of the corners of cells: nodes, and G with J = G' x for the positions x of a simplex; volume: |T|."""

    def __init__(self, mesh):
        dim = self.dim = mesh.dim
        corners, edges = [], []
        sizes = np.zeros(len(mesh.x))
        count = np.zeros(len(mesh.x))
        for cell, nodes in mesh.cells():
            for corner in cell.corners[:1] if cell.vertices == dim + 1 else cell.corners:
                corners.append(nodes[:, corner])
                edges.append(np.broadcast_to(regular_edges(cell), (len(nodes), dim, dim)))
        self.nodes = np.concatenate(corners)
        ideal = np.concatenate(edges)
        x = mesh.x[:, :dim]
        size = np.abs(np.linalg.det(x[self.nodes[:, 1:]] - x[self.nodes[:, :1]]))
        for k in range(dim + 1):
            np.add.at(sizes, self.nodes[:, k], size)
            np.add.at(count, self.nodes[:, k], 1)
        sizes = (sizes / np.maximum(count, 1))[self.nodes].mean(axis=1)
        ideal = ideal * ((sizes / np.linalg.det(ideal)) ** (1 / dim))[:, None, None]
        self.volume = sizes / sizes.mean()
        inverse = np.linalg.inv(ideal)  # rows of ideal: edges
        self.G = np.concatenate([-inverse.sum(axis=2)[:, :, None], inverse], axis=2)  # dim x dim+1
        self.free = ~mesh.boundary()
        self.all = np.zeros(x.shape) + x

    def jacobians(self, x):
        return np.einsum("tak,tki->tai", self.G, x[self.nodes])  # J transposed

    def gather(self, per_simplex):
        """Of the free nodes: the sum of what each simplex has at its nodes."""
        flat = self.nodes.ravel()
        return np.stack([np.bincount(flat, per_simplex[:, :, i].ravel(), len(self.all)) for i in range(self.dim)],
                        axis=1)[self.free]

    def filled(self, y):
        x = self.all.copy()
        x[self.free] = y.reshape(-1, self.dim)
        return x


def regular_edges(cell):
    if cell.dim == 2:
        return np.array([(1, 0), (0, 1)] if cell.vertices == 4 else [(1, 0), (0.5, 0.75 ** 0.5)])
    if cell.vertices == 8:
        return np.eye(3)
    third = (0, 0, 1) if cell.vertices == 6 else (0.5, 0.75 ** 0.5 / 3, (2 / 3) ** 0.5)
    return np.array([(1, 0, 0), (0.5, 0.75 ** 0.5, 0), third])


def cofactors(J):
    if J.shape[1] == 2:
        return np.stack([np.stack([J[:, 1, 1], -J[:, 1, 0]], 1), np.stack([-J[:, 0, 1], J[:, 0, 0]], 1)], 1)
    return np.stack([np.cross(J[:, 1], J[:, 2]), np.cross(J[:, 2], J[:, 0]), np.cross(J[:, 0], J[:, 1])], 1)


def foldover(mesh):
    """Moves the nodes of the mesh."""
    s = Simplices(mesh)
    d, theta, deadline = s.dim, 0.5, time.process_time() + SECONDS
    y = s.all[s.free].ravel()

    def determinants(y):
        return np.linalg.det(s.jacobians(s.filled(y)))

    def energy(y, eps):
        J = s.jacobians(s.filled(y))
        K = cofactors(J)
        D = np.einsum("tai,tai->t", J, K) / d
        root = np.sqrt(eps ** 2 + D ** 2)
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            chi = np.where(D > 0, (D + root) / 2, eps ** 2 / (2 * (root - D)))
            slope = 0.5 + D / (2 * root)
            f, g = np.einsum("tai,tai->t", J, J) / chi ** (2 / d), (1 + D ** 2) / chi
            of_J = (1 - theta) * 2 / chi ** (2 / d)
            of_D = (1 - theta) * -2 / d * f * slope / chi + theta * (2 * D - g * slope) / chi
            E = np.sum(s.volume * ((1 - theta) * f + theta * g))
            dJ = s.volume[:, None, None] * (of_J[:, None, None] * J + of_D[:, None, None] * K)
        if not np.isfinite(E):
            return 1e300, np.zeros(len(y))
        return E, s.gather(np.einsum("tak,tai->tki", s.G, dJ)).ravel()

    class OutOfTime(Exception):
        pass

    def watch(at):
        nonlocal y
        y = at.copy()
        if time.process_time() > deadline:
            raise OutOfTime

    eps = 1.0
    try:
        for _ in range(1000):
            before = energy(y, eps)[0]
            found = scipy.optimize.minimize(energy, y, (eps,), "L-BFGS-B", True, callback=watch,
                                            options={"maxiter": 3000, "maxfun": 10 ** 6, "gtol": 1e-4, "ftol": 1e-10})
            y, after, least = found.x, found.fun, determinants(found.x).min()
            if least > 0 and abs(before - after) / after < 1e-5:
                break
            chi = (least + np.sqrt(eps ** 2 + least ** 2)) / 2
            mu = (1 - max(1 - after / before, 0.1)) * chi
            eps = 2 * np.sqrt(mu * (mu - least)) if least < mu else 1e-10
    except OutOfTime:
        pass
    mesh.x[s.free, :d] = y.reshape(-1, d)


def slim(mesh, most=50):
    """Moves the nodes of a valid mesh."""
    s = Simplices(mesh)
    d, deadline = s.dim, time.process_time() + SECONDS
    x = s.all.copy()
    rows = np.repeat(np.arange(len(s.nodes) * d), d + 1)
    columns = np.repeat(s.nodes, d, axis=0).ravel()
    gradient = sparse.csr_matrix((s.G.ravel(), (rows, columns)), (len(s.nodes) * d, len(x)))
    place = np.flatnonzero(s.free)

    def energy(x):
        S = np.linalg.svd(s.jacobians(x), compute_uv=False)
        return np.sum(s.volume * (S ** 2 + S ** -2.0).sum(axis=1)) if S.min() > 0 else np.inf

    now = energy(x)
    for _ in range(most):
        U, S, V = np.linalg.svd(np.swapaxes(s.jacobians(x), 1, 2))
        R = U @ V
        weight = np.sqrt(np.where(np.abs(S - 1) > 1e-6, (S - S ** -3.0) / np.where(S == 1, 2, S - 1), 4))
        W2 = np.einsum("tia,ta,tja,t->tij", U, weight ** 2, U, s.volume)
        blocks, right = [], []
        R = np.swapaxes(R, 1, 2)  # as the transposed Jacobians
        for i in range(d):
            of_row = []
            for j in range(d):
                scaled = sparse.diags(np.repeat(W2[:, i, j], d)) @ gradient
                of_row.append((gradient.T @ scaled)[place][:, place])
            blocks.append(of_row)
            defect = np.einsum("tij,taj->tai", W2, R - s.jacobians(x))[:, :, i].ravel()
            right.append((gradient.T @ defect)[place])
        step = scipy.sparse.linalg.spsolve(sparse.bmat(blocks, "csc"), np.concatenate(right)).reshape(d, -1).T
        t, moved = 1.0, x.copy()
        while t > 1e-8:
            moved[place] = x[place] + t * step
            if np.linalg.det(s.jacobians(moved)).min() > 0 and energy(moved) < now:
                break
            t /= 2
        else:
            break
        x, fall, now = moved.copy(), now - energy(moved), energy(moved)
        if fall < 1e-6 * now or time.process_time() > deadline:
            break
    mesh.x[:, :d] = x

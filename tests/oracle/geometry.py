"""What can be told of a mesh from its nodes alone: signs of det J, overlaps, distortion, volumes, surfaces."""
import numpy as np

from cells import LINE, PYRAMID, TRIANGLE, det, face_nodes, gauss, jacobians, lattice, values

CHUNK = 2_000_000  # numbers of a temporary array
PAIRS = {2: 8_000_000, 3: 2_000_000}  # of points and pieces of the boundary around which overlaps are looked for


def is_straight(block):
    return block.degree == 1 and len(block.cell.vertices) == block.cell.dim + 1


def parts(count, size):
    step = max(1, CHUNK // max(1, size))
    return [slice(k, min(k + step, count)) for k in range(0, count, step)]


def determinants(block, x, points):
    """Element x point."""
    dim = block.cell.dim
    found = np.empty((len(block.nodes), len(points)))
    for part in parts(len(block.nodes), len(points) * dim * dim):
        found[part] = det(jacobians(block.cell, block.degree, x[block.nodes[part]][:, :, :dim], points))
    return found


def volumes(block, x):
    points, weights = gauss(block.cell, (block.cell.dim * block.degree + 4) // 2)
    return determinants(block, x, points) @ weights


def straight_means(block, x):
    """The mean of det J of the elements with straight sides on the same vertices."""
    points, weights = gauss(block.cell, 3)
    dim = block.cell.dim
    J = jacobians(block.cell, 1, x[block.nodes[:, :len(block.cell.vertices)]][:, :, :dim], points)
    return det(J) @ weights / weights.sum()


def least_scaled(block, x, sign):
    """Per element: the least of det J on a lattice over the mean of the straight-sided element's, both as signed."""
    points = lattice(block.cell, 2 * block.degree + 1)
    points = points[:1] if is_straight(block) else points
    mean = np.maximum(np.abs(straight_means(block, x)), 1e-300)
    return (sign[:, None] * determinants(block, x, points)).min(axis=1) / mean


def distortion(block, ideal, x):
    """integral of 1, of eta^2, and eta at the points: F = D phi, eta = |F|^2 / (n det(F)^(2/n))."""
    n = block.cell.dim
    points, weights = gauss(block.cell, 1 if is_straight(block) else block.degree + 3)
    one = of_eta = 0.0
    eta = np.empty((len(block.nodes), len(points)))
    for part in parts(len(block.nodes), len(points) * n * n):
        A, J = (jacobians(block.cell, block.degree, y[block.nodes[part]][:, :, :n], points) for y in (ideal, x))
        F = np.linalg.inv(A) @ J  # transposed, as A and J are
        with np.errstate(all="ignore"):
            eta[part] = np.sum(F * F, axis=(2, 3)) / (n * det(F) ** (2 / n))
        dV = np.abs(det(A)) * weights
        one, of_eta = one + dV.sum(), of_eta + (dV * eta[part] ** 2).sum()
    return one, of_eta, eta


REGULAR = {"triangle": [[0, 0], [1, 0], [0.5, 0.75 ** 0.5]],
           "tetrahedron": [[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]],
           "prism": [[0, 0, 0], [1, 0, 0], [0.5, 0.75 ** 0.5, 0], [0, 0, 1], [1, 0, 1], [0.5, 0.75 ** 0.5, 1]],
           "pyramid": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0.5 ** 0.5]]}


def corner_jacobians(block, x, signs):
    """Per element: the least, over the corners, of the determinant of unit vectors along the edges there, over that of
    the regular cell (Knupp 2000), times its sign."""
    cell, found = block.cell, []
    regular = np.array([REGULAR.get(cell.name, cell.vertices)], float)
    for v in range(len(cell.vertices)):
        ends = [b if a == v else a for a, b in cell.edges if v in (a, b)]
        for k in range(len(ends) if len(ends) > cell.dim else 1):  # the apex of a pyramid has four edges
            of = np.array(ends[:k] + ends[k + 1:] if len(ends) > cell.dim else ends)

            def at(y):
                ways = y[:, of] - y[:, [v]]
                with np.errstate(all="ignore"):
                    return np.nan_to_num(det(ways / np.linalg.norm(ways, axis=2)[:, :, None]))
            found.append(at(x[block.nodes[:, :len(cell.vertices)]][:, :, :cell.dim]) / at(regular))
    return np.min(found * signs, axis=0)


def to_reference(cell, at):
    """From coordinates in the cell with its vertices."""
    at = np.array(at, float)
    if cell is PYRAMID:
        at[:, :2] /= np.maximum(1 - at[:, 2:], 1e-12)
    return at


def pieces_of_boundary(mesh, x, signs, per_edge):
    """Straight pieces of the outer faces, piece x vertex x dim, outward where det J > 0: segments or triangles."""
    found = []
    for block, k, rows in mesh.outer_faces():
        face = block.cell.on_face(k)
        of = x[block.nodes[rows][:, face_nodes(block.cell, k, block.degree)]]
        n = 1 if is_straight(block) or (face is LINE and block.degree == 1) else per_edge
        if face is LINE:
            uv = [[(i,), (i + 1,)] for i in range(n)]
        else:
            squares = [(i, j) for i in range(n) for j in range(n)]
            uv = [[(i, j), (i + 1, j), (i, j + 1)] for i, j in squares if face is not TRIANGLE or i + j < n]
            uv += [[(i + 1, j), (i + 1, j + 1), (i, j + 1)] for i, j in squares
                   if face is not TRIANGLE or i + j < n - 1]
        uv = np.array(uv, float)
        N = values(face, block.degree, uv.reshape(-1, face.dim) / n).reshape(*uv.shape[:2], -1)
        pieces = np.einsum("tvn,ena->etva", N, of)
        turned = np.asarray(signs[id(block)])[rows] < 0
        pieces[turned] = pieces[turned][:, :, ::-1]
        found.append(pieces.reshape(-1, *pieces.shape[2:]))
    return np.concatenate(found)[:, :, :mesh.dim]


def winding(points, pieces):
    """How often the pieces go around each point."""
    total = np.zeros(len(points))
    for part in parts(len(points), 9 * len(pieces)):
        v = pieces[None] - points[part, None, None]
        if points.shape[1] == 2:
            a, b = v[:, :, 0], v[:, :, 1]
            angle = np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], np.sum(a * b, axis=2)) / (2 * np.pi)
        else:  # Van Oosterom, Strackee 1983
            a, b, c = v[:, :, 0], v[:, :, 1], v[:, :, 2]
            ab, bc, ca, aa, bb, cc = (np.einsum("ptk,ptk->pt", p, q)
                                      for p, q in ((a, b), (b, c), (c, a), (a, a), (b, b), (c, c)))
            la, lb, lc = np.sqrt(aa), np.sqrt(bb), np.sqrt(cc)
            angle = np.arctan2(det(v), la * lb * lc + ab * lc + bc * la + ca * lb) / (2 * np.pi)
        total[part] = angle.sum(axis=1)
    return total


def inside_faces(mesh, x, most, depths):
    """Points of cells just behind outer faces, each by how far it is on the way to the cell's centre, and at several
    places of each face where there are few."""
    faces = mesh.outer_faces()
    count = sum(len(rows) for _, _, rows in faces) * len(depths)
    random, found = np.random.default_rng(1), []
    places = int(np.clip(most // max(count, 1), 1, 7))
    for block, k, rows in faces:
        corner = np.array(block.cell.vertices, float)
        face, centre = corner[list(block.cell.faces[k])], corner.mean(axis=0)
        if count > most:
            rows = random.choice(rows, max(1, len(rows) * most // count), replace=False)
        for place in range(places):
            weight = np.full(len(face), 1 / len(face)) if place == 0 else random.dirichlet(np.ones(len(face)))
            for depth in depths:
                at = (1 - depth) * (weight @ face) + depth * centre
                N = values(block.cell, block.degree, to_reference(block.cell, [at]))[0]
                found.append(np.einsum("n,ena->ea", N, x[block.nodes[rows]]))
    return np.concatenate(found)[:, :mesh.dim]


def has_flat_faces(mesh, x):
    """Whether straight edges and plane faces bound the mesh."""
    def is_plane(v):
        a, b, c = (v[:, k] - v[:, 0] for k in (1, 2, 3))
        return np.all(np.abs(np.sum(np.cross(a, c) * b, axis=1)) < 1e-12 * np.ptp(v, axis=1).max(axis=1) ** 3)
    return mesh.degree == 1 and (mesh.dim == 2 or all(
        len(block.cell.faces[k]) == 3 or is_plane(x[block.nodes[rows][:, list(block.cell.faces[k])]])
        for block, k, rows in mesh.outer_faces()))


def overlaps(mesh, x, signs):
    """Points of the mesh that it covers more than once, of those that were looked at, and the number of these. Where
    det J > 0 in all cells, the winding number of the outer faces about a point is the number of cells over it."""
    curved = not has_flat_faces(mesh, x)
    pieces = pieces_of_boundary(mesh, x, signs, 6 if mesh.dim == 3 else 16)
    most = max(60, PAIRS[mesh.dim] // len(pieces))
    points = inside_faces(mesh, x, most, [0.02, 0.4] if curved else [1e-5, 0.4])
    wrong = np.abs(winding(points, pieces) - 1) > 0.01
    if wrong.any() and curved:  # is that the curve, or the pieces that stand for it?
        some = np.flatnonzero(wrong)[:20]
        again = np.abs(winding(points[some], pieces_of_boundary(mesh, x, signs, 40 if mesh.dim == 3 else 400)) - 1)
        wrong[:] = False
        wrong[some[again > 0.01]] = True
    return points[wrong], len(points)


def smooth_parts(faces, x, angle):
    """Of straight-sided faces (rows of vertices): a number for each, the same where they meet below this angle."""
    dim = x.shape[1]
    v = x[faces]
    way = [v[:, k] - v[:, 0] for k in range(1, faces.shape[1])]
    normal = np.stack([way[0][:, 1], -way[0][:, 0]], axis=1) if dim == 2 else np.cross(way[0], way[-1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    number, at = np.arange(len(faces)), {}
    for f, corners in enumerate(faces.tolist()):
        for k, i in enumerate(corners):
            at.setdefault((i,) if dim == 2 else tuple(sorted((i, corners[k - 1]))), []).append(f)

    def root(f):
        while number[f] != f:
            f = number[f] = number[number[f]]
        return f
    for pair in at.values():
        if len(pair) == 2 and abs(normal[pair[0]] @ normal[pair[1]]) > np.cos(np.radians(angle)):
            number[root(pair[0])] = root(pair[1])
    return np.array([root(f) for f in range(len(faces))])


def off_surface(points, moved):
    """Distances of moved points from the plane, line, sphere or circle on which the first points are; none: None."""
    centre, size = points.mean(axis=0), np.ptp(points, axis=0).max()
    p, q = (points - centre) / size, (moved - centre) / size
    _, s, axes = np.linalg.svd(p, full_matrices=len(p) < p.shape[1])
    if len(p) > p.shape[1] - 1 and s[-1] < 1e-10 * s[0]:
        return np.abs(q @ axes[-1]) * size
    of = lambda r: np.column_stack([r, np.ones(len(r))])
    fit, _, rank, _ = np.linalg.lstsq(of(p), np.sum(p * p, axis=1), rcond=1e-10)
    if rank < p.shape[1] + 1 or len(p) < p.shape[1] + 3 or np.abs(of(p) @ fit - np.sum(p * p, axis=1)).max() > 1e-9:
        return None
    middle = fit[:-1] / 2
    radius = np.sqrt(fit[-1] + middle @ middle)
    return np.abs(np.linalg.norm(q - middle, axis=1) - radius) * size

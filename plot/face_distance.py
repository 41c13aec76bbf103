"""The distance of points from faces: straight edges, triangles and bilinear quadrilaterals. numpy, scipy.

The closest point of a face is on one of its edges or where the residual is normal to it: of a triangle that is a linear
equation, of a quadrilateral Gauss-Newton goes there from four starts. Faces that can be closer than the closest vertex
are all tried.
"""
import numpy as np

STEPS = 10  # of Gauss-Newton
CHUNK = 1000  # points at a time


def distances(points, faces):
    """Of each point from the closest of the faces; points: n x 3; faces: arrays of faces x vertices x 3."""
    from scipy.spatial import cKDTree
    nearest = cKDTree(np.concatenate([face.reshape(-1, 3) for face in faces])).query(points)[0]
    for face in faces:
        centre = face.mean(axis=1)
        radius = np.linalg.norm(face - centre[:, None], axis=2).max(axis=1)
        tree = cKDTree(centre)
        for first in range(0, len(points), CHUNK):
            part = slice(first, first + CHUNK)
            found = tree.query_ball_point(points[part], nearest[part] + radius.max())
            at = first + np.repeat(np.arange(len(found)), [len(row) for row in found])
            of = np.concatenate([np.array(row, int) for row in found])
            close = np.linalg.norm(points[at] - centre[of], axis=1) <= nearest[at] + radius[of]
            np.minimum.at(nearest, at[close], to_faces(points[at[close]], face[of[close]]))
    return nearest


def to_faces(p, v):
    """Of point i from face i; p: n x 3, v: n x vertices x 3."""
    count = v.shape[1]
    least = np.min([to_segment(p, v[:, k], v[:, (k + 1) % count]) for k in range(count)], axis=0)
    if count == 2:
        return least
    for start in [(1 / 3, 1 / 3)] if count == 3 else [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]:
        q = np.tile(start, (len(p), 1))
        for _ in range(STEPS if count == 4 else 1):
            q = q + step(p, v, q)
            q = np.clip(q, 0, 1) if count == 4 else q
        is_inside = (q >= 0).all(axis=1) & ((q.sum(axis=1) <= 1) if count == 3 else True)
        least = np.where(is_inside, np.minimum(least, np.linalg.norm(p - surface(v, q)[0], axis=1)), least)
    return least


def to_segment(p, a, b):
    along = b - a
    t = np.einsum("ij,ij->i", p - a, along) / np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    return np.linalg.norm(a + np.clip(t, 0, 1)[:, None] * along - p, axis=1)


def surface(v, q):
    """Points of the faces at the parameters q, and their derivatives by both."""
    a, b = v[:, 1] - v[:, 0], v[:, -1] - v[:, 0]
    twist = v[:, 2] - v[:, 1] - b if v.shape[1] == 4 else 0 * a
    s, t = q[:, :1], q[:, 1:]
    return v[:, 0] + s * a + t * b + s * t * twist, a + t * twist, b + s * twist


def step(p, v, q):
    """Of Gauss-Newton; 0 where the face has no area."""
    x, a, b = surface(v, q)
    aa, ab, bb = (np.einsum("ij,ij->i", *pair) for pair in ((a, a), (a, b), (b, b)))
    ra, rb = (np.einsum("ij,ij->i", p - x, d) for d in (a, b))
    det = aa * bb - ab * ab
    inverse = np.where(det > 0, 1 / np.where(det > 0, det, 1), 0)
    return np.stack([bb * ra - ab * rb, aa * rb - ab * ra], axis=1) * inverse[:, None]

"""Three-dimensional meshes drawn with 2D tools: cuts of tetrahedra by a plane, and surfaces seen from a camera."""
import numpy as np


def cut_tetrahedra(points, tetrahedra, y):
    """Polygons (x, z) in which the plane y = const meets the tetrahedra, and the tetrahedron of each.

    One or three vertices beyond the plane give a triangle, two a quadrilateral. Cost: linear, over all cells at once.
    """
    height = points[:, 1] - y
    beyond = height[tetrahedra] > 0
    count = beyond.sum(axis=1)
    polygons, owners = [], []
    for k in (1, 2, 3):
        chosen = np.flatnonzero(count == k)
        # Vertices beyond the plane first; the k of them joined to the others in turn around the polygon.
        order = np.argsort(~beyond[chosen], axis=1, kind="stable")
        corner = np.take_along_axis(tetrahedra[chosen], order, axis=1)
        joined = {1: [(0, 1), (0, 2), (0, 3)], 2: [(0, 2), (0, 3), (1, 3), (1, 2)], 3: [(0, 3), (1, 3), (2, 3)]}[k]
        sides = []
        for a, b in joined:
            start, end = corner[:, a], corner[:, b]
            t = (height[start] / (height[start] - height[end]))[:, None]
            sides.append(((1 - t) * points[start] + t * points[end])[:, [0, 2]])
        polygons.extend(np.stack(sides, axis=1))
        owners.extend(chosen)
    return polygons, np.array(owners)


def outward(points, triangles):
    """Unit normals of a closed surface, all of them outward (by the sign of the enclosed volume): triangles x 3."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    if np.einsum("ij,ij->", normal, a - points.mean(axis=0)) < 0:
        normal = -normal
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def seen(points, triangles, towards, up, distance=None):
    """A surface as a camera sees it: polygons (triangles x 3 x 2) of the visible faces from far to near, which faces
    these are, and their brightness in 0..1 under a light at the camera's shoulder.

    towards: direction from the surface to the camera. distance: of the camera from the centre; None: parallel rays.
    """
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    towards = np.array(towards, float) / np.linalg.norm(towards)
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    frame = np.column_stack([right, np.cross(towards, right), towards])
    local = (points - centre) @ frame
    scale = np.ones(len(points)) if distance is None else distance / (distance - local[:, 2])
    flat = local[:, :2] * scale[:, None]

    corners = flat[triangles]
    edge1, edge2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = edge1[:, 0] * edge2[:, 1] - edge1[:, 1] * edge2[:, 0]
    normal = outward(points, triangles)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    turned = np.einsum("ij,ij->i", np.cross(b - a, c - a), normal) < 0
    front = np.flatnonzero((area > 0) != turned)
    front = front[np.argsort(local[triangles[front], 2].mean(axis=1))]

    light = towards + 0.5 * frame[:, 1] - 0.3 * right
    brightness = 0.55 + 0.45 * np.clip(normal[front] @ (light / np.linalg.norm(light)), 0, 1)
    return corners[front], front, brightness

"""The box of least volume around a cluster, however it is turned in space.

O'Rourke (Finding minimal enclosing boxes, Int. J. of Computer and Information Sciences 14, 1985):
two adjacent faces of the least box each hold an edge of the hull. His search of all such pairs is
cubic. Here one axis of the box is the normal of a face of the hull, or square to two edges that
parallel planes touch from both sides; across it lies the rectangle of least area around the
projection (Freeman and Shapira 1975). So the box is the least of those with a face flush with the
hull, or with edges on two opposite faces; of the boxes that touch edges on adjacent faces only,
none is tried.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from datmo.arrays import F64, I32, I64
from datmo.boxes.hull import least_area_angles

FLAT = 1e-9
"""What is thinner than this share of the largest coordinate has no thickness."""
PARALLEL = 1e-9
"""Sine of the angle under which two faces are one, or two edges one direction."""
BLOCK = 64
"""Edges compared with all the others at once."""
RIGHT = np.pi / 2


def least_volume_boxes(points: F64, starts: I64) -> tuple[F64, F64, F64]:
    """Box of (nearly) least volume around each cluster; the order of its points does not matter.

    One place, points on a line and points in a plane have boxes too, with sizes of exactly zero.

    Args:
        points: (n, 3) [m], finite, cluster by cluster. starts: (k + 1,).

    Returns:
        rotation (k, 3, 3), right-handed, whose columns are the axes of the box; centre (k, 3) [m];
        size (k, 3) along these axes [m], the longest first. A cluster without points has zeros.
    """
    count = len(starts) - 1
    rotation, center, size = np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3)), np.zeros((count, 3))
    for k in range(count):
        part = points[starts[k] : starts[k + 1]]
        if len(part):
            rotation[k], center[k], size[k] = _box(part[np.lexsort(part.T)])
    return rotation, center, size


def heading_of(rotation: F64, size: F64) -> F64:
    """Yaw (k,) of boxes seen from above [rad, 0 <= yaw < pi/2].

    The steepest of the three axes is left out; the other two lie within 45 degrees of the
    horizontal, and the yaw is that of the one which is longer from above.

    Args:
        rotation: (k, 3, 3), columns are the axes. size: (k, 3) along them [m].
    """
    x, y, z = np.moveaxis(rotation, 1, 0)  # each (k, 3): one entry an axis
    seen = size * np.hypot(x, y)
    np.put_along_axis(seen, np.abs(z).argmax(1)[:, None], 0.0, 1)
    row = np.arange(len(size)), seen.argmax(1)
    yaw = np.arctan2(y[row], x[row]) % RIGHT
    return np.where(yaw < RIGHT, yaw, 0.0)  # the remainder of -1e-17 is the divisor itself


def _box(points: F64) -> tuple[F64, F64, F64]:
    """Rotation, centre and size of the box around sorted points."""
    thin = FLAT * float(np.abs(points).max())
    origin = points[0].copy()
    corners = points - origin
    rank, normal = _flatness(corners, thin)
    normals, bounds = normal[None], np.zeros(1)
    if rank == 3:
        try:
            corners, normals, bounds = _candidates(corners)
        except QhullError:  # all but flat
            normals, bounds = np.concatenate([normals, np.eye(3)]), np.zeros(4)
    axes = _least(corners, normals, bounds)
    along = corners @ axes.T
    low, high = along.min(0), along.max(0)
    size = np.where(high - low <= 2 * thin, 0.0, high - low)
    order = np.argsort(-size, kind="stable")
    center = origin + ((low + high) / 2) @ axes
    return _right_handed(axes[order]).T, center, size[order]


def _right_handed(axes: F64) -> F64:
    """The rows, two of them pointed so that their largest component is positive."""
    largest = axes[np.arange(3), np.abs(axes).argmax(1)]
    axes = axes * np.sign(largest)[:, None]
    axes[2] = np.cross(axes[0], axes[1])
    return axes


def _candidates(points: F64) -> tuple[F64, F64, F64]:
    """Corners (h, 3) of the hull, normals (m, 3) to try, and the least volume (m,) each can give.

    No box across a normal holds less than its extent along it times the area of the hull's shadow;
    the one of the least bound comes first.

    Raises:
        QhullError: the points are too near to a plane.
    """
    hull = ConvexHull(points)
    corners, faces = points[hull.vertices], np.ascontiguousarray(hull.equations[:, :3])
    normals = np.concatenate([faces, _edge_normals(faces, hull.neighbors)])
    a, b, c = np.moveaxis(points[hull.simplices], 1, 0)
    shadow = np.abs(normals @ np.cross(b - a, c - a).T).sum(1) / 4  # front and back, half a product each
    bounds = np.ptp(normals @ corners.T, axis=1) * shadow
    order = np.argsort(bounds, kind="stable")
    return corners, normals[order], bounds[order]


def _flatness(points: F64, thin: float) -> tuple[int, F64]:
    """Rank of points that begin with the origin, and a unit normal of the line or plane they lie in."""
    along, length = _farthest(points)
    if length <= thin:
        return 0, np.array([0.0, 0.0, 1.0])
    rest = points - np.outer(points @ along, along)
    across, length = _farthest(rest)
    if length <= thin:
        return 1, _bases(along[None])[0, 0]
    normal = np.cross(along, across)
    return 3 if np.abs(points @ normal).max() > thin else 2, normal


def _farthest(points: F64) -> tuple[F64, float]:
    """Direction and distance of the point farthest from the origin."""
    square = np.einsum("ij,ij->i", points, points)
    i = int(square.argmax())
    length = float(np.sqrt(square[i]))
    return points[i] / max(length, 1e-300), length


def _edge_normals(faces: F64, neighbors: I32) -> F64:
    """Unit normals (m, 3) of parallel planes that touch an edge each, from both sides of a hull.

    On the sphere of normals an edge is the arc from one of its faces (f, 3) to the other; such planes
    touch two edges where the arc of one crosses the mirror image of the other's.
    """
    f, g = np.repeat(np.arange(len(faces)), 3), neighbors.ravel()
    start, end = faces[f[f < g]], faces[g[f < g]]
    edge = np.cross(start, end)
    sine = np.linalg.norm(edge, axis=1)
    bent = sine > PARALLEL
    start, end, edge = start[bent], end[bent], edge[bent] / sine[bent, None]
    found = [np.empty((0, 3))]
    for first in range(0, len(edge), BLOCK):
        rows = slice(first, first + BLOCK)
        a, b = start[rows] @ edge.T, end[rows] @ edge.T  # on which side of the other's circle
        c, d = edge[rows] @ start.T, edge[rows] @ end.T
        i, j = np.nonzero((a * b < 0) & (c * d < 0) & (b * c < 0))
        half = first + i < j  # each pair is found twice
        found.append(np.cross(edge[rows][i[half]], edge[j[half]]))
    normals = np.concatenate(found)
    length = np.linalg.norm(normals, axis=1)
    askew = length > PARALLEL
    return np.asarray(normals[askew] / length[askew, None])


def _bases(normals: F64) -> F64:
    """Two unit vectors (m, 2, 3) square to each normal (m, 3) and to each other."""
    u = np.zeros_like(normals)
    u[np.arange(len(u)), np.abs(normals).argmin(1)] = 1
    u -= np.einsum("ij,ij->i", u, normals)[:, None] * normals
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    return np.stack([u, np.cross(normals, u)], 1)


def _least(corners: F64, normals: F64, bounds: F64) -> F64:
    """Axes (3, 3), one a row, of the least box that is square to one of the normals (m, 3)."""
    best, least = np.eye(3), np.inf
    starts = np.array([0, len(corners)])
    for normal, basis, bound in zip(normals, _bases(normals), bounds, strict=True):
        if bound >= least:
            break
        angle = least_area_angles(corners @ basis.T, starts)[0]
        c, s = np.cos(angle), np.sin(angle)
        axes = np.stack([*(np.array([[c, s], [-s, c]]) @ basis), normal])
        volume = float(np.prod(np.ptp(corners @ axes.T, axis=0)))
        if volume < least:
            best, least = axes, volume
    return best

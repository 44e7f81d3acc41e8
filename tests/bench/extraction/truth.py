# SPDX-License-Identifier: Apache-2.0
"""The true surface of a generated scene, and how much of it some points recover."""
import numpy
from scipy.spatial import cKDTree

INLIER_M = 0.10  # Points farther from the surface are wrong matches, which an attacker's mesh would leave out, too.
NEAR_M = 0.05  # A place of the surface is recovered if a point is so near.
CELL_M = 0.03  # Places of the surface, in a grid of this size.


def read_ply(path):
    """Returns vertices and triangles of a binary PLY as cyclorama-grotto writes it."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    sizes = {"float": "<f4", "uchar": "u1", "int": "<i4"}
    elements = []
    for line in data[:end].decode().splitlines():
        word = line.split()
        if word[0] == "element":
            elements.append((word[1], int(word[2]), []))
        elif word[0] == "property":
            elements[-1][2].append(word[1:])
    arrays = {}
    for name, count, properties in elements:
        fields = []
        for each in properties:
            fields += [("n", "u1"), ("i", "<i4", 3)] if each[0] == "list" else [(each[1], sizes[each[0]])]
        arrays[name] = numpy.frombuffer(data, numpy.dtype(fields), count, end)
        end += arrays[name].nbytes
    vertex = arrays["vertex"]
    return numpy.stack([vertex["x"], vertex["y"], vertex["z"]], 1).astype(float), arrays["face"]["i"]


class Surface:
    """All triangles of a scene package, with many points on them."""

    def __init__(self, folder, samples=1500000):
        corners = []
        for path in sorted(folder.rglob("*.ply")):
            vertices, triangles = read_ply(path)
            corners.append(vertices[triangles])
        self.corners = numpy.concatenate(corners)
        a, b, c = self.corners[:, 0], self.corners[:, 1], self.corners[:, 2]
        area = 0.5 * numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1)
        random = numpy.random.default_rng(1)
        self.triangle = random.choice(len(area), samples, p=area / area.sum())
        u, v = numpy.sqrt(random.random(samples)), random.random(samples)
        t = self.triangle
        self.samples = a[t] * (1 - u)[:, None] + b[t] * (u * (1 - v))[:, None] + c[t] * (u * v)[:, None]
        self.tree = cKDTree(self.samples)

    def distances(self, points):
        """Returns each point's distance to the surface, exactly for those that are near."""
        _, nearest = self.tree.query(points, k=8)
        best = numpy.full(len(points), numpy.inf)
        for k in range(nearest.shape[1]):
            best = numpy.minimum(best, to_triangles(points, self.corners[self.triangle[nearest[:, k]]]))
        return best


def to_triangles(points, corners):
    """Returns the distance of each point to its triangle."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = numpy.cross(b - a, c - a)
    length = numpy.linalg.norm(normal, axis=1)
    unit = normal / numpy.maximum(length, 1e-30)[:, None]
    height = numpy.einsum("ij,ij->i", points - a, unit)
    foot = points - height[:, None] * unit
    inside = length > 1e-20
    distance = numpy.full(len(points), numpy.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        edge = q - p
        inside &= numpy.einsum("ij,ij->i", numpy.cross(edge, foot - p), unit) >= 0
        share = numpy.einsum("ij,ij->i", points - p, edge) / numpy.maximum(numpy.einsum("ij,ij->i", edge, edge), 1e-30)
        nearest = p + numpy.clip(share, 0, 1)[:, None] * edge
        distance = numpy.minimum(distance, numpy.linalg.norm(points - nearest, axis=1))
    return numpy.where(inside, numpy.abs(height), distance)


def places(points):
    """Returns one of the points for each occupied cell of the grid."""
    _, first = numpy.unique(numpy.floor(points / CELL_M).astype(int), axis=0, return_index=True)
    return points[first]


def recovered(surface, seen, points):
    """Returns what points recover of the places `seen`: millimetres RMS of those near the surface, share of wrong ones,
    coverage."""
    if len(points) == 0:
        return {"points": 0, "mm_rms": None, "mm_median": None, "wrong": None, "coverage": 0.0}
    distance = surface.distances(points)
    right = distance < INLIER_M
    near, _ = cKDTree(points[right]).query(seen) if right.any() else (numpy.full(len(seen), numpy.inf), None)
    return {"points": int(len(points)),
            "mm_rms": round(1e3 * float(numpy.sqrt(numpy.mean(distance[right] ** 2))), 2) if right.any() else None,
            "mm_median": round(1e3 * float(numpy.median(distance[right])), 2) if right.any() else None,
            "wrong": round(float(1 - numpy.mean(right)), 4),
            "coverage": round(float(numpy.mean(near < NEAR_M)), 4)}

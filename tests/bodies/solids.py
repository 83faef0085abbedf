"""What the tests of bodies in space share: the program that computes (tests/bodies/solids3.c), and truth in double by brute force.

The truth of a distance shares nothing with sw/bodies/: it is the largest separation along any of the directions between the features of
two hulls, where each pair of corners counts as an edge and each three corners as a face. Overlap is a negative distance.
"""

import itertools
import struct
import subprocess

import numpy as np

MAKE, COLLIDE, SHAPE, BOUNDS, MASS, PLANE, MATCH, DISTANCE, MEASURE, RAY, IMPACT, CAST, MESH, HEIGHTS, GROUND = range(15)
BALL, CAPSULE, BOX, TRIANGLE, HULL = range(5)
SHAPE_OF = np.dtype([("count", "u4"), ("faces", "u4"), ("halves", "u4"), ("radius", "f4"), ("extent", "f4"), ("inner", "f4"), ("box", "u4"),
                     ("middle", "3f4"), ("half", "3f4"), ("corner", "(32,3)f4"), ("normal", "(60,3)f4"), ("offset", "60f4"), ("first", "60u1"),
                     ("from", "180u1"), ("next", "180u1"), ("face", "180u1")])
MANIFOLD = np.dtype([("normal", "3f4"), ("count", "u4"), ("point", [("arm", "3f4"), ("gap", "f4")], 4)])
CLOSEST = np.dtype([("a", "3f4"), ("b", "3f4"), ("normal", "3f4"), ("distance", "f4"), ("least", "f4"), ("rounds", "u4")])
STRAIGHT = (0, 0, 0, 2, 0, 0, 0)


class Solids:
    """Commands are collected, and answered all at once."""

    def __init__(self, program):
        self.program, self.sent, self.sizes, self.shapes = program, [], [], 0

    def ask(self, size, command, *parts):
        self.sent.append(struct.pack("<I", command) + b"".join(
            struct.pack("<I", part) if isinstance(part, int) else np.asarray(part, "<f4").tobytes() for part in parts))
        self.sizes.append(size)

    def make(self, kind, points, radius=0.0, pose=STRAIGHT):
        """The shape's number."""
        points = np.atleast_2d(np.asarray(points, "f4"))
        self.ask(132, MAKE, kind, len(points), radius, points, pose)
        self.shapes += 1
        return self.shapes - 1

    def collide(self, a, pose_a, b, pose_b, reach):
        self.ask(80, COLLIDE, a, b, pose_a, pose_b, reach)

    def plane(self, normal, offset, pose_a, b, pose_b, reach):
        self.ask(80, PLANE, normal, offset, b, pose_a, pose_b, reach)

    def shape(self, a):
        self.ask(SHAPE_OF.itemsize, SHAPE, a)

    def distance(self, a, pose_a, b, pose_b):
        self.ask(48, DISTANCE, a, b, pose_a, pose_b)

    def mass(self, *parts):
        """Each part: a shape and its density."""
        self.ask(136, MASS, len(parts), *itertools.chain(*parts))

    def answers(self):
        """Bytes of each command; the next commands go to a new process."""
        out = subprocess.run([self.program], input=b"".join(self.sent), capture_output=True, check=True, timeout=100).stdout
        ends = np.cumsum(self.sizes)
        assert len(out) == ends[-1]
        answers = [out[end - size:end] for size, end in zip(self.sizes, ends)]
        self.sent, self.sizes, self.shapes = [], [], 0
        return answers


def turn(q):
    """The matrix of a quaternion."""
    w, x, y, z = np.asarray(q, float) / np.linalg.norm(np.asarray(q, float))
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def placed(points, pose, origin=(0, 0, 0)):
    """Points of a shape in the world, less an origin, in double."""
    return np.asarray(points, float) @ turn(pose[3:]).T + (np.asarray(pose[:3], float) - np.asarray(origin, float))


def units(vectors):
    size = np.linalg.norm(vectors, axis=1)
    keep = size > 1e-7 * (size.max() if len(size) else 1)
    return vectors[keep] / size[keep, None]


def directions(a, b):
    """Every direction along which two hulls may be farthest apart."""
    found = []
    edges = []
    for points in (a, b):
        pairs = np.array(list(itertools.combinations(range(len(points)), 2)), int).reshape(-1, 2)
        edges.append(points[pairs[:, 1]] - points[pairs[:, 0]])
        threes = np.array(list(itertools.combinations(range(len(points)), 3)), int).reshape(-1, 3)
        p, q, r = (points[threes[:, k]] for k in range(3))
        found.append(np.cross(q - p, r - p))
    between = (b[None] - a[:, None]).reshape(-1, 3)
    found.append(between)
    found.append(np.cross(edges[0][:, None], edges[1][None]).reshape(-1, 3))
    for edge in edges:
        if len(edge):
            along = edge / np.linalg.norm(edge, axis=1)[:, None]
            found.append((between[:, None] - (between @ along.T)[:, :, None] * along[None]).reshape(-1, 3))
    n = np.concatenate([units(vectors) for vectors in found if len(vectors)])
    return np.concatenate([n, -n])


def along(a, b, n):
    """How far two sets of points are apart along directions from a to b."""
    return (b @ n.T).min(0) - (a @ n.T).max(0)


def signed_distance(a, b):
    """Of two hulls, and its direction; (0, None): nothing tells a direction."""
    n = directions(a, b)
    if not len(n):
        return 0.0, None
    gaps = along(a, b, n)
    best = gaps.argmax()
    return gaps[best], n[best]


def random_pose(rng, size=1.0):
    q = rng.normal(size=4)
    return np.concatenate([rng.normal(size=3) * size, q / np.linalg.norm(q)]).astype("f4")


def read_shape(answer):
    return np.frombuffer(answer, SHAPE_OF)[0]


MASS_OF = np.dtype([("mass", "f8"), ("centre", "3f8"), ("inertia", "6f8"), ("moment", "3f8"), ("q", "4f8")])


def core(shape):
    return shape["corner"][:shape["count"]].astype(float)

"""A recording of rigid bodies: where they are; in a plane their shapes as polygons, and the gaps in their joints."""

import h5py
import numpy as np
from fp3world import scene as ws

HINGE = 1           # fp3_joint_type
DYNAMIC = 0         # fp3_body_type
AROUND = 90         # points of a circle


class Recording:
    """Of a scene that is run once: arrays begin with the snapshot."""

    def __init__(self, fp3, folder, scene, *options):
        path = folder / f"{scene.name}.h5"
        ws.call(fp3, ws.put(folder, scene.text(folder), scene.name), "--output", path, *options)
        with h5py.File(path) as file:
            self.times, self.rest = file["time"][:], file["at_rest"][:]
            self.x, self.angle = np.stack([file["x_x"][:], file["x_y"][:]], 2), file["angle"][:]
            of, self.corners, self.radius = file["shapes:of"][:].astype(int), file["shapes:corners"][:, :2], file["shapes:radius"][:, 0]
            self.joints = file["joints:of"][:, :3].astype(int) if "joints:of" in file else np.zeros((0, 3), int)
            self.anchors = file["joints:anchors"][:] if "joints:anchors" in file else np.zeros((0, 6))
        path.unlink()
        self.of, self.moves = of[:, :2], np.ones(self.x.shape[1], bool)
        self.moves[of[of[:, 3] != DYNAMIC, 0]] = False
        self.first = np.cumsum(self.of[:, 1]) - self.of[:, 1]

    def world(self, snapshot, body, points):
        """Points in a body's axes, or one for each body."""
        c, s = np.cos(self.angle[snapshot, body]), np.sin(self.angle[snapshot, body])
        x, y = points[..., 0], points[..., 1]
        return self.x[snapshot, body] + np.stack([c * x - s * y, s * x + c * y], -1)

    def shapes(self, snapshot):
        """The body of each shape, and its outline in the world."""
        way = 2 * np.pi * np.arange(AROUND) / AROUND
        way = np.stack([np.cos(way), np.sin(way)], 1)
        for (body, count), first, radius in zip(self.of, self.first, self.radius):
            corners = self.world(snapshot, body, self.corners[first:first + count])
            yield body, corners[np.argmax(corners @ way.T, 0)] + radius * way if radius else corners

    def gap(self):
        """The largest distance between both points of a hinge, ever."""
        a, b, _ = self.joints[self.joints[:, 2] == HINGE].T
        at = self.anchors[self.joints[:, 2] == HINGE]
        apart = (self.world(n, a, at[:, :2]) - self.world(n, b, at[:, 3:5]) for n in range(len(self.times)))
        return max(np.linalg.norm(one, axis=1).max() for one in apart)


class Space:
    """Of a scene in space, likewise: places, spins, and the axes of each body as columns."""

    def __init__(self, fp3, folder, scene, *options):
        path = folder / f"{scene.name}.h5"
        ws.call(fp3, ws.put(folder, scene.text(folder), scene.name), "--output", path, *options)
        with h5py.File(path) as file:
            self.times = file["time"][:]
            self.x, self.spin = (np.stack([file[f"{name}_{k}"][:] for k in "xyz"], 2) for name in ("x", "spin"))
            w, x, y, z = (file[f"q_{k}"][:] for k in "wxyz")
        path.unlink()
        self.axes = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                              [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]).transpose(2, 3, 0, 1)


def recording_of(fp3, folder, scene, *options):
    is_space = "dimensions = 3;" in scene.text(folder)
    return (Space if is_space else Recording)(fp3, folder, scene, *options)

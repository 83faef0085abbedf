"""A Box3D that the user has built: make bodies BOX3D=DIR makes the library that this calls of bench/bodies/box3d.c."""

import ctypes

import numpy as np
from fp3bodies.by_own_box2d import FOLDER, Version, numbers
from fp3bodies.engines import InSpace
from fp3bodies.scene import mass

LIBRARY = FOLDER / "bodies_box3d.so"
SHAPES = ("disc", "box", "capsule", "polygon")


def is_there():
    return LIBRARY.exists()


class Made(InSpace):
    ARITHMETIC = "float32"
    SUBSTEPS = True

    def build(self, scene):
        self.lib = ctypes.CDLL(str(LIBRARY))
        self.lib.b3GetVersion.restype = Version
        version = self.lib.b3GetVersion()
        self.NOTE = f"Box3D {version.major}.{version.minor}.{version.revision}, as its user built it"
        self.lib.fp3_box3d_open.restype = ctypes.c_void_p
        self.lab = ctypes.c_void_p(self.lib.fp3_box3d_open(numbers(scene.gravity), len(scene.bodies), len(scene.pins)))
        self.count = len(scene.bodies)
        for k, body in enumerate(scene.bodies):
            kind = 0 if body.fixed else 1 if body.moving else 2
            w = body.w if isinstance(body.w, tuple) else (0.0, 0.0, 0.0)
            self.lib.fp3_box3d_body(self.lab, kind, numbers((*body.at, *body.q, *(body.v or (0.0, 0.0, 0.0)), *w)), int(body.fast))
            size = [one for x, y in body.size for z in (-0.5, 0.5) for one in (x, y, z)] if body.shape == "polygon" else body.size
            self.lib.fp3_box3d_shape(self.lab, k, SHAPES.index(body.shape), numbers(size), len(size), numbers((body.density, body.friction, body.restitution)))
            if kind == 2 and (body.mass or body.inertia):
                m, about = mass(body, 3) if not body.inertia else (body.mass, body.inertia)
                self.lib.fp3_box3d_mass(self.lab, k, ctypes.c_double(m), numbers(about))
        for pin in scene.pins:
            self.lib.fp3_box3d_pin(self.lab, pin.a, pin.b, numbers((*pin.at, 0.0)[:3]), int(scene.planar))

    def __del__(self):
        if hasattr(self, "lab"):
            self.lib.fp3_box3d_close(self.lab)

    def step(self, count=1):
        self.lib.fp3_box3d_step(self.lab, ctypes.c_double(self.scene.step), self.scene.substeps, count)

    def state(self):
        found = np.zeros((self.count, 13))
        self.lib.fp3_box3d_read(self.lab, found.ctypes.data_as(ctypes.c_void_p))
        return found[:, :3], found[:, 3:7], found[:, 7:10], found[:, 10:]

    def push(self, body, force):
        self.lib.fp3_box3d_push(self.lab, body, numbers((*force, 0.0)[:3]))

    def pulls(self):
        found = np.zeros(len(self.scene.pins))
        self.lib.fp3_box3d_pulls(self.lab, found.ctypes.data_as(ctypes.c_void_p))
        return found

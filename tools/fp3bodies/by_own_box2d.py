"""A Box2D that the user has built: make bodies BOX2D=DIR makes the library that this calls of bench/bodies/box2d.c."""

import ctypes
import os
import pathlib

import numpy as np
from fp3bodies.engines import Engine
from fp3bodies.scene import Refused, mass

FOLDER = pathlib.Path(os.environ.get("FP3_BUILD", pathlib.Path(__file__).resolve().parents[2] / "build")) / "bench"
LIBRARY = FOLDER / "bodies_box2d.so"
SHAPES = ("disc", "box", "capsule", "polygon")


class Version(ctypes.Structure):
    _fields_ = [(name, ctypes.c_int) for name in ("major", "minor", "revision")]


def is_there():
    return LIBRARY.exists()


def numbers(values):
    return (ctypes.c_double * len(values))(*values)


class Made(Engine):
    ARITHMETIC = "float32"
    SUBSTEPS = True

    def build(self, scene):
        if scene.dimensions != 2:
            raise Refused("it has no space")
        self.lib, real = ctypes.CDLL(str(LIBRARY)), ctypes.c_double
        self.lib.b2GetVersion.restype = Version
        version = self.lib.b2GetVersion()
        self.NOTE = f"Box2D {version.major}.{version.minor}.{version.revision}, as its user built it"
        self.lib.fp3_box2d_open.restype = ctypes.c_void_p
        self.lab = ctypes.c_void_p(self.lib.fp3_box2d_open(*map(real, scene.gravity), len(scene.bodies), len(scene.pins)))
        for k, body in enumerate(scene.bodies):
            kind = 0 if body.fixed else 1 if body.moving else 2
            self.lib.fp3_box2d_body(self.lab, kind, numbers((*body.at, body.angle, *(body.v or (0.0, 0.0)), float(body.w))), int(body.fast))
            size = [one for corner in body.size for one in corner] if body.shape == "polygon" else body.size
            self.lib.fp3_box2d_shape(self.lab, k, SHAPES.index(body.shape), numbers(size), len(size), numbers((body.density, body.friction, body.restitution)))
            if kind == 2 and (body.mass or body.inertia):
                m, (about,) = mass(body, 2)
                self.lib.fp3_box2d_mass(self.lab, k, real(m), real(about))
        for pin in scene.pins:
            self.lib.fp3_box2d_pin(self.lab, pin.a, pin.b, *map(real, pin.at))

    def __del__(self):
        if hasattr(self, "lab"):
            self.lib.fp3_box2d_close(self.lab)

    def step(self, count=1):
        self.lib.fp3_box2d_step(self.lab, ctypes.c_double(self.scene.step), self.scene.substeps, count)

    def state(self):
        found = np.zeros((len(self.scene.bodies), 6))
        self.lib.fp3_box2d_read(self.lab, found.ctypes.data_as(ctypes.c_void_p))
        return found

    def places(self):
        return self.state()[:, :2]

    def turns(self):
        return self.state()[:, 2]

    def speeds(self):
        return self.state()[:, 3:5]

    def spins(self):
        return self.state()[:, 5]

    def push(self, body, force):
        self.lib.fp3_box2d_push(self.lab, body, *map(ctypes.c_double, force))

    def pulls(self):
        found = np.zeros(len(self.scene.pins))
        self.lib.fp3_box2d_pulls(self.lab, found.ctypes.data_as(ctypes.c_void_p))
        return found

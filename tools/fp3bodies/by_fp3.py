"""FP3's own bodies, by the C library of the build beside this folder (or of FP3_HOME)."""

import ctypes
import math
import pathlib
import sys

import numpy as np
from fp3bodies.engines import Engine
from fp3bodies.scene import Refused, mass

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))

from fp3 import _declarations as d  # noqa: E402
from fp3 import _library  # noqa: E402

ZERO = {"bounce": 0.0, "rest_speed": 0.0}  # every contact bounces, nobody sleeps


class Made(Engine):
    ARITHMETIC = "float32"
    SUBSTEPS = True

    def build(self, scene):
        if scene.dimensions != 2:
            raise Refused("it has no space")
        self.lib, self.error = _library.library(), d.fp3_error()
        definition = self.lib.default(d.fp3_bodies_def)
        definition.error = ctypes.pointer(self.error)
        definition.gravity[:] = scene.gravity
        definition.h, definition.substeps = scene.step, scene.substeps
        for name, value in ZERO.items():
            setattr(definition, name, value)
        self.world = ctypes.c_void_p()
        self.call("open", ctypes.byref(definition), ctypes.byref(self.world))
        handles = np.zeros(len(scene.bodies) + 1, dtype=np.uint64)  # the last one is the world, to which pins can hold
        origin = self.lib.default(d.fp3_body_def)
        origin.type = d.FP3_STATIC
        bodies = (d.fp3_body_def * len(handles))(*map(self.body, scene.bodies), origin)
        self.call("add", self.world, bodies, len(bodies), handles.ctypes.data)
        self.handles = handles[:-1]
        for k, body in enumerate(scene.bodies):
            self.attach(body, self.handles[k:k + 1])
        self.pins = np.zeros(len(scene.pins), dtype=np.uint64)
        pins = (d.fp3_joint_def * len(self.pins))(*(self.pin(pin, handles) for pin in scene.pins))
        self.call("join", self.world, pins, len(self.pins), self.pins.ctypes.data)

    def __del__(self):
        if getattr(self, "world", None):
            self.lib.fp3_bodies_close(ctypes.byref(self.world))

    def call(self, name, *args):
        _library.check(getattr(self.lib, f"fp3_bodies_{name}")(*args), self.error)

    def body(self, body):
        made = self.lib.default(d.fp3_body_def)
        made.type = d.FP3_STATIC if body.fixed else d.FP3_KINEMATIC if body.moving else d.FP3_DYNAMIC
        made.is_fast = int(body.fast)
        made.x[:], made.angle, made.v[:], made.w = body.at, body.angle, body.v or (0.0, 0.0), float(body.w)
        made.is_fast = body.fast
        return made

    def attach(self, body, handle):
        shape = self.lib.default(d.fp3_shape_def)
        shape.type = {"disc": d.FP3_CIRCLE, "box": d.FP3_BOX, "capsule": d.FP3_CAPSULE, "polygon": d.FP3_POLYGON}[body.shape]
        shape.radius = body.size[-1] if body.shape in ("disc", "capsule") else 0.0
        shape.density, shape.friction, shape.restitution = body.density, body.friction, body.restitution
        if body.shape == "box":
            shape.half[:] = body.size
        corners = body.size if body.shape == "polygon" else ((-body.size[0], 0.0), (body.size[0], 0.0)) if body.shape == "capsule" else ()
        shape.corners = len(corners)
        for k, corner in enumerate(corners):
            shape.corner[k][:] = corner
        self.call("attach", self.world, handle.ctypes.data, 1, ctypes.byref(shape), None)
        if (body.mass or body.inertia) and not (body.fixed or body.moving):
            m, about = mass(body, 2)
            self.write("mass", handle, m)
            self.write("inertia", handle, about[0])

    def pin(self, pin, handles):
        made = self.lib.default(d.fp3_joint_def)
        made.type, made.a, made.b = d.FP3_HINGE, int(handles[pin.a]), int(handles[pin.b])
        for anchor, k in ((made.anchor_a, pin.a), (made.anchor_b, pin.b)):
            anchor[:] = inside(self.scene.bodies[k], pin.at) if k >= 0 else pin.at
        return made

    def write(self, name, handle, value):
        self.call("write", self.world, name.encode(), handle.ctypes.data, 1, np.array([value]).ctypes.data)

    def read(self, *names):
        found = np.zeros((len(names), len(self.handles)))
        for row, name in zip(found, names):
            self.call("read", self.world, name.encode(), self.handles.ctypes.data, len(self.handles), row.ctypes.data)
        return found.T if len(names) > 1 else found[0]

    def pulls(self):
        found = np.zeros((2, len(self.pins)))
        for row, name in zip(found, (b"force_x", b"force_y")):
            self.call("joint_read", self.world, name, self.pins.ctypes.data, len(self.pins), row.ctypes.data)
        return np.hypot(*found)

    def step(self, count=1):
        self.call("step", self.world, count)

    def places(self):
        return self.read("x_x", "x_y")

    def turns(self):
        return self.read("angle")

    def speeds(self):
        return self.read("v_x", "v_y")

    def spins(self):
        return self.read("w")

    def push(self, body, force):
        for name, value in zip(("force_x", "force_y"), force):
            self.write(name, self.handles[body:body + 1], value)


def inside(body, at):
    """A point in a body's axes."""
    x, y = at[0] - body.at[0], at[1] - body.at[1]
    c, s = math.cos(body.angle), math.sin(body.angle)
    return c * x + s * y, c * y - s * x

"""FP3's own bodies, by the C library of the build beside this folder (or of FP3_HOME)."""

import ctypes
import math
import pathlib
import sys

import numpy as np
from fp3bodies.engines import Engine
from fp3bodies.scene import mass

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))

from fp3 import _declarations as d  # noqa: E402
from fp3 import _library  # noqa: E402

ZERO = {"bounce": 0.0, "rest_speed": 0.0}  # every contact bounces, nobody sleeps


class Made(Engine):
    ARITHMETIC = "float32"
    SUBSTEPS = True
    LAWS = {}  # words of fp3_bodies_def that say who executes the laws

    def build(self, scene):
        self.lib, self.error = _library.library(), d.fp3_error()
        definition = self.lib.default(d.fp3_bodies_def)
        definition.error = ctypes.pointer(self.error)
        definition.dimensions, definition.gravity[:] = scene.dimensions, in_space(scene.gravity)
        definition.h, definition.substeps, definition.threads = scene.step, scene.substeps, self.THREADS
        for name, value in (ZERO | self.LAWS).items():
            setattr(definition, name, value)
        self.world = ctypes.c_void_p()
        self.call("open", ctypes.byref(definition), ctypes.byref(self.world))
        made = Definitions(self.lib, scene)
        handles = np.zeros(len(made.bodies), dtype=np.uint64)
        self.call("add", self.world, made.bodies, len(handles), handles.ctypes.data)
        self.handles = handles[:-1]
        for (k, shape), body in zip(made.shapes, scene.bodies):
            handle = handles[k:k + 1]
            self.call("attach", self.world, handle.ctypes.data, 1, ctypes.byref(shape), None)
            if (body.mass or body.inertia) and not (body.fixed or body.moving):
                m, about = mass(body, scene.dimensions)
                self.write("mass", handle, m)
                self.write("inertia", handle, *about)
        for corners, surface in made.chains:
            self.call("attach_chain", self.world, int(handles[-1]), corners.ctypes.data, len(corners), 0, ctypes.byref(surface))
        self.pins = np.zeros(len(made.joints), dtype=np.uint64)
        for joint in made.joints:
            joint.a, joint.b = int(handles[joint.a]), int(handles[joint.b])
        self.call("join", self.world, made.joints, len(self.pins), self.pins.ctypes.data)

    def __del__(self):
        if getattr(self, "world", None):
            self.lib.fp3_bodies_close(ctypes.byref(self.world))

    def call(self, name, *args):
        _library.check(getattr(self.lib, f"fp3_bodies_{name}")(*args), self.error)

    def write(self, name, handle, *values):
        self.call("write", self.world, name.encode(), handle.ctypes.data, 1, np.array(values).ctypes.data)

    def read(self, *names):
        found = np.zeros((len(names), len(self.handles)))
        for row, name in zip(found, names):
            self.call("read", self.world, name.encode(), self.handles.ctypes.data, len(self.handles), row.ctypes.data)
        return found.T if len(names) > 1 else found[0]

    def pulls(self):
        found = np.zeros((self.scene.dimensions, len(self.pins)))
        for row, name in zip(found, (b"force_x", b"force_y", b"force_z")):
            self.call("joint_read", self.world, name, self.pins.ctypes.data, len(self.pins), row.ctypes.data)
        return np.linalg.norm(found, axis=0)

    def step(self, count=1):
        self.call("step", self.world, count)

    def places(self):
        return self.vectors("x")

    def vectors(self, name):
        return self.read(*(f"{name}_{axis}" for axis in "xyz"[:self.scene.dimensions]))

    def turns(self):
        return self.read("angle") if self.scene.dimensions == 2 else self.read("q_w", "q_x", "q_y", "q_z")

    def speeds(self):
        return self.vectors("v")

    def spins(self):
        return self.read("w") if self.scene.dimensions == 2 else self.vectors("spin")

    def push(self, body, force):
        self.write("force", self.handles[body:body + 1], *map(float, force))


class ByEngine(Made):
    """Laws as programs, which anybody may change, compiled to native code."""
    NOTE = "contacts and joints by their texts, as native code of the engine `fast`"
    LAWS = {"engine": b"fast", "may_compile": 1}


class ByTwo(Made):
    """What two processors do together: its time is that of a clock on the wall."""
    NOTE = "two threads, by a clock on the wall; the others by the time of their processor"
    THREADS = 2


class Definitions:
    """What fp3/bodies.h takes of a scene. The last body is the world, to which pins and chains hold; joints have numbers of bodies in place of handles."""

    def __init__(self, lib, scene):
        self.lib, self.scene = lib, scene
        origin = lib.default(d.fp3_body_def)
        origin.type = d.FP3_STATIC
        self.bodies = (d.fp3_body_def * (len(scene.bodies) + 1))(*map(self.body, scene.bodies), origin)
        self.shapes = [(k, self.shape(body)) for k, body in enumerate(scene.bodies)]
        self.chains = [(np.array(corners, dtype=float), lib.default(d.fp3_shape_def)) for corners in scene.chains]
        for _, surface in self.chains:
            surface.radius = 0.0
        joints = [self.pin(pin) for pin in scene.pins] + [self.joint(joint) for joint in scene.joints]
        self.joints = (d.fp3_joint_def * len(joints))(*joints)

    def body(self, body):
        made = self.lib.default(d.fp3_body_def)
        made.type = d.FP3_STATIC if body.fixed else d.FP3_KINEMATIC if body.moving else d.FP3_DYNAMIC
        made.x[:], made.v[:] = in_space(body.at), in_space(body.v or (0.0, 0.0))
        if self.scene.dimensions == 2:
            made.angle, made.w = body.angle, float(body.w)
        else:
            made.q[:], made.spin[:] = body.q, body.w if isinstance(body.w, tuple) else (0.0, 0.0, 0.0)
        made.is_fast = int(body.fast)
        return made

    def shape(self, body):
        shape = self.lib.default(d.fp3_shape_def)
        is_flat = self.scene.dimensions == 2
        shape.type = {"disc": d.FP3_CIRCLE if is_flat else d.FP3_SPHERE, "box": d.FP3_BOX, "capsule": d.FP3_CAPSULE, "polygon": d.FP3_POLYGON}[body.shape]
        shape.radius = body.size[-1] if body.shape in ("disc", "capsule") else 0.0
        shape.density, shape.friction, shape.restitution = body.density, body.friction, body.restitution
        if body.shape == "box":
            shape.half[:] = in_space(body.size)
        corners = body.size if body.shape == "polygon" else ((-body.size[0], 0.0), (body.size[0], 0.0)) if body.shape == "capsule" else ()
        shape.corners = len(corners)
        for k, corner in enumerate(corners):
            shape.corner[k][:] = in_space(corner)
        return shape

    def joined(self, type, a, b):
        made = self.lib.default(d.fp3_joint_def)
        made.type, made.a, made.b = type, a % len(self.bodies), b % len(self.bodies)
        return made

    def pin(self, pin):
        made = self.joined(d.FP3_HINGE if self.scene.dimensions == 2 else d.FP3_BALL, pin.a, pin.b)
        for anchor, k in ((made.anchor_a, pin.a), (made.anchor_b, pin.b)):
            anchor[:] = in_space(inside(self.scene.bodies[k], pin.at) if k >= 0 else pin.at)
        return made

    def joint(self, joint):
        made = self.joined(getattr(d, f"FP3_{joint.type.upper()}"), joint.a, joint.b)
        for word, value in joint.more.items():
            if isinstance(value, tuple):
                getattr(made, word)[:] = in_space(value) if word in ("anchor_a", "anchor_b", "axis") else value
            else:
                setattr(made, word, value)
        return made

    def bytes(self):
        """For tests/bodies/stepped.c."""
        def words(*numbers):
            return np.array(numbers, np.uint64).tobytes()
        scene = self.scene
        assert not any(body.mass or body.inertia for body in scene.bodies)
        parts = [np.array([*in_space(scene.gravity), scene.step]).tobytes(), words(scene.dimensions, scene.substeps, len(self.bodies), len(self.shapes), len(self.joints), len(self.chains)),
                 bytes(self.bodies), *(words(k) + bytes(shape) for k, shape in self.shapes),
                 *(words(len(self.bodies) - 1, len(corners), 0) + bytes(surface) + corners.tobytes() for corners, surface in self.chains), bytes(self.joints)]
        return b"".join(parts)


def in_space(x):
    """Three numbers of two or three."""
    return (*x, 0.0)[:3]


def inside(body, at):
    """A point in a body's axes."""
    if len(at) == 3:
        x, (w, *p) = np.subtract(at, body.at), body.q
        twice = 2 * np.cross(np.negative(p), x)
        return tuple(x + w * twice + np.cross(np.negative(p), twice))
    x, y = at[0] - body.at[0], at[1] - body.at[1]
    c, s = math.cos(body.angle), math.sin(body.angle)
    return c * x + s * y, c * y - s * x

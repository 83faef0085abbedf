"""Box2D 3, by pyb2d3."""

import math

import numpy as np
import pyb2d3 as b2
from fp3bodies.engines import Engine
from fp3bodies.scene import Refused, mass


class Made(Engine):
    ARITHMETIC = "float32"
    SUBSTEPS = True
    NOTE = "the wheel has vectors of 4 (SSE2), not of 8"

    def build(self, scene):
        if scene.dimensions != 2:
            raise Refused("it has no space")
        self.world = b2.World(gravity=scene.gravity, restitution_threshold=0.0, maximum_linear_speed=4000.0)
        self.world.sleeping_enabled = False
        self.all = b2.Bodies()
        self.made = [self.body(body) for body in scene.bodies]
        for one in self.made:
            self.all.append(one.id)
        origin = self.world.create_static_body()
        self.pins = []
        for pin in scene.pins:
            a, b = (origin if k < 0 else self.made[k] for k in (pin.a, pin.b))
            self.pins.append(self.world.create_revolute_joint(b2.revolute_joint_def(
                body_a=a, body_b=b, local_anchor_a=a.local_point(pin.at), local_anchor_b=b.local_point(pin.at))))

    def body(self, body):
        kind = b2.BodyType.STATIC if body.fixed else b2.BodyType.KINEMATIC if body.moving else b2.BodyType.DYNAMIC
        made = self.world.create_body_from_def(b2.body_def(
            type=kind, position=body.at, rotation=b2.make_rot(body.angle), linear_velocity=body.v or (0.0, 0.0),
            angular_velocity=float(body.w), is_bullet=body.fast, enable_sleep=False))
        m, (about,) = mass(body, 2)
        surface = b2.surface_material(friction=body.friction, restitution=body.restitution)
        if body.shape == "disc":
            shape = b2.circle((0.0, 0.0), body.size[0])
        elif body.shape == "box":
            shape = b2.box(*body.size)
        elif body.shape == "capsule":
            shape = b2.capsule((-body.size[0], 0.0), (body.size[0], 0.0), body.size[1])
        else:
            shape = b2.polygon(points=np.array(body.size, dtype=np.float32))
        made.create_shape(b2.shape_def(density=body.density, material=surface), shape)
        if kind == b2.BodyType.DYNAMIC and (body.mass or body.inertia):
            data = b2.MassData()
            data.mass, data.center, data.rotational_inertia = m, (0.0, 0.0), about
            made.mass_data = data
        return made

    def step(self, count=1):
        for _ in range(count):
            self.world.step(self.scene.step, self.scene.substeps)

    def places(self):
        return np.array(self.all.get_positions(), dtype=float)

    def turns(self):
        return np.array([made.angle for made in self.made])

    def speeds(self):
        return np.array(self.all.get_linear_velocities(), dtype=float)

    def spins(self):
        return np.array(self.all.get_angular_velocities(), dtype=float)

    def push(self, body, force):
        self.made[body].apply_force_to_center(force, True)

    def pulls(self):
        return np.array([math.hypot(*pin.get_constraint_force()) for pin in self.pins])

"""Chipmunk 7, by pymunk."""

import math

import numpy as np
import pymunk
from fp3bodies.engines import Engine
from fp3bodies.scene import Refused, mass


class Made(Engine):
    ARITHMETIC = "double"
    NOTE = "10 iterations in each step"

    def build(self, scene):
        if scene.dimensions != 2:
            raise Refused("it has no space")
        self.world = pymunk.Space()
        self.world.gravity = scene.gravity
        self.world.iterations = 10
        self.made = [self.body(body) for body in scene.bodies]
        self.pins = []
        for pin in scene.pins:
            a, b = (self.world.static_body if k < 0 else self.made[k] for k in (pin.a, pin.b))
            joint = pymunk.PivotJoint(a, b, tuple(pin.at))
            joint.collide_bodies = False
            self.pins.append(joint)
            self.world.add(joint)

    def body(self, body):
        m, (about,) = mass(body, 2)
        kind = pymunk.Body.STATIC if body.fixed else pymunk.Body.KINEMATIC if body.moving else pymunk.Body.DYNAMIC
        made = pymunk.Body(m, about, kind) if kind == pymunk.Body.DYNAMIC else pymunk.Body(body_type=kind)
        made.position, made.angle, made.velocity, made.angular_velocity = tuple(body.at), body.angle, tuple(body.v or (0.0, 0.0)), float(body.w)
        if body.shape == "disc":
            shape = pymunk.Circle(made, body.size[0])
        elif body.shape == "box":
            shape = pymunk.Poly.create_box(made, (2 * body.size[0], 2 * body.size[1]))
        elif body.shape == "capsule":
            shape = pymunk.Segment(made, (-body.size[0], 0.0), (body.size[0], 0.0), body.size[1])
        else:
            shape = pymunk.Poly(made, [tuple(corner) for corner in body.size])
        shape.friction, shape.elasticity = math.sqrt(body.friction), math.sqrt(body.restitution)  # it multiplies both
        self.world.add(made, shape)
        return made

    def step(self, count=1):
        for _ in range(count * self.scene.substeps):
            self.world.step(self.scene.step / self.scene.substeps)

    def places(self):
        return np.array([tuple(made.position) for made in self.made])

    def turns(self):
        return np.array([made.angle for made in self.made])

    def speeds(self):
        return np.array([tuple(made.velocity) for made in self.made])

    def spins(self):
        return np.array([made.angular_velocity for made in self.made])

    def push(self, body, force):
        self.made[body].apply_impulse_at_world_point(tuple(f * self.scene.step for f in force), self.made[body].position)

    def pulls(self):
        return np.array([pin.impulse for pin in self.pins]) / (self.scene.step / self.scene.substeps)

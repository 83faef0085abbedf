"""Rapier in space, by rapier3d."""

import math

import numpy as np
import rapier3d as rapier
from fp3bodies.engines import InSpace
from fp3bodies.scene import mass



class Made(InSpace):
    ARITHMETIC = "float32"
    SUBSTEPS = True
    NOTE = "in space, nothing locked: its friction and joints fail beside locked axes"

    def build(self, scene):
        self.world = rapier.PhysicsWorld(gravity=scene.gravity)
        self.world.set_num_threads(1)
        parameters = self.world.integration_parameters
        parameters.dt, parameters.num_solver_iterations = scene.step, scene.substeps
        self.made = [self.body(body) for body in scene.bodies]
        origin = self.world.add_body(rapier.RigidBody.fixed().build())
        self.pins = []
        for pin in scene.pins:
            ends = [origin if k < 0 else self.made[k] for k in (pin.a, pin.b)]
            joint = rapier.RevoluteJointBuilder((0.0, 0.0, 1.0)) if scene.planar else rapier.SphericalJointBuilder()
            local = [self.local(end, pin.at) for end in ends]
            joint = joint.local_anchor1(local[0]).local_anchor2(local[1]).contacts_enabled(False)
            self.pins.append(self.world.impulse_joints.insert(*ends, joint.build()))

    def local(self, handle, at):
        body = self.world.rigid_bodies[handle]
        q, x = body.rotation, body.translation
        return turned((q.w, -q.i, -q.j, -q.k), [p - o for p, o in zip(at, (x.x, x.y, x.z))])

    def body(self, body):
        kind = rapier.RigidBody.fixed() if body.fixed else rapier.RigidBody.kinematic_velocity_based() if body.moving else rapier.RigidBody.dynamic()
        w = body.w if isinstance(body.w, tuple) else (0.0, 0.0, 0.0)
        kind = kind.translation(body.at).rotation(scaled_axis(body.q)).linvel(body.v or (0.0, 0.0, 0.0)).angvel(w).can_sleep(False).ccd_enabled(body.fast)
        m, about = mass(body, 3) if not body.inertia else (body.mass, body.inertia)
        handle = self.world.add_body(kind.additional_mass_properties(rapier.MassProperties((0.0, 0.0, 0.0), m, about)).gyroscopic_forces(True).build())
        if body.shape == "disc":
            shape = rapier.Collider.ball(body.size[0])
        elif body.shape == "box":
            shape = rapier.Collider.cuboid(*body.size)
        elif body.shape == "capsule":
            shape = rapier.Collider.capsule_x(*body.size)
        else:
            shape = rapier.Collider.convex_hull([(x, y, z) for x, y in body.size for z in (-0.5, 0.5)])
        rule = rapier.CoefficientCombineRule
        shape = shape.density(0.0).friction(math.sqrt(body.friction)).friction_combine_rule(rule.MULTIPLY)
        shape = shape.restitution(body.restitution).restitution_combine_rule(rule.MAX)
        self.world.add_collider(shape.build(), handle)
        return handle

    def step(self, count=1):
        for _ in range(count):
            self.world.step()

    def state(self):
        bodies = [self.world.rigid_bodies[handle] for handle in self.made]
        return (np.array([(b.translation.x, b.translation.y, b.translation.z) for b in bodies]),
                np.array([(b.rotation.w, b.rotation.i, b.rotation.j, b.rotation.k) for b in bodies]),
                np.array([(b.linvel.x, b.linvel.y, b.linvel.z) for b in bodies]), np.array([(b.angvel.x, b.angvel.y, b.angvel.z) for b in bodies]))

    def push(self, body, force):
        made = self.world.rigid_bodies[self.made[body]]
        made.apply_impulse(tuple(f * self.scene.step for f in (*force, 0.0)[:3]))


def turned(q, x):
    """A vector by a quaternion."""
    w, v, x = q[0], np.array(q[1:]), np.array(x, dtype=float)
    return tuple(float(one) for one in x + 2 * np.cross(v, np.cross(v, x) + w * x))


def scaled_axis(q):
    length = math.sqrt(sum(one * one for one in q[1:]))
    turn = 2 * math.atan2(length, q[0])
    return tuple(one * turn / length for one in q[1:]) if length else (0.0, 0.0, 0.0)

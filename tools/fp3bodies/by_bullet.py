"""Bullet 3, by pybullet. Its Python has no locked axes, so scenes in the plane stay there only as long as nothing pushes them out."""

import numpy as np
import pybullet
from fp3bodies.engines import InSpace
from fp3bodies.scene import Refused, mass


class Made(InSpace):
    ARITHMETIC = "double"
    NOTE = "in space, nothing locked; bodies are its multibodies"

    def __del__(self):
        if hasattr(self, "client"):
            pybullet.disconnect(self.client)

    def build(self, scene):
        if any(body.moving for body in scene.bodies):
            raise Refused("what it is told to move has no speed in contacts")
        self.client, self.pushes = pybullet.connect(pybullet.DIRECT), {}
        self.call("resetSimulation")
        self.call("setGravity", *scene.gravity)
        self.call("setPhysicsEngineParameter", fixedTimeStep=scene.step / scene.substeps, numSubSteps=0, restitutionVelocityThreshold=0.0)
        self.made = [self.body(body) for body in scene.bodies]
        self.pins = []
        for pin in scene.pins:
            a, b = pin.a, pin.b
            if a < 0:
                args = (self.made[b], -1, -1, -1, pybullet.JOINT_POINT2POINT, (0, 0, 0), inside(scene.bodies[b], pin.at), pin.at)
            else:
                args = (self.made[a], -1, self.made[b], -1, pybullet.JOINT_POINT2POINT, (0, 0, 0), inside(scene.bodies[a], pin.at),
                        inside(scene.bodies[b], pin.at))
                self.call("setCollisionFilterPair", self.made[a], self.made[b], -1, -1, 0)
            self.pins.append(self.call("createConstraint", *args))

    def call(self, name, *args, **more):
        return getattr(pybullet, name)(*args, physicsClientId=self.client, **more)

    def body(self, body):
        held = body.fixed or body.moving
        m, about = (0.0, (0.0, 0.0, 0.0)) if held else (body.mass, body.inertia) if body.inertia else mass(body, 3)
        if body.shape == "disc":
            shape = self.call("createCollisionShape", pybullet.GEOM_SPHERE, radius=body.size[0])
        elif body.shape == "box":
            shape = self.call("createCollisionShape", pybullet.GEOM_BOX, halfExtents=body.size)
        elif body.shape == "capsule":
            shape = self.call("createCollisionShape", pybullet.GEOM_CAPSULE, height=2 * body.size[0], radius=body.size[1],
                              collisionFrameOrientation=(0.0, 0.5 ** 0.5, 0.0, 0.5 ** 0.5))
        else:
            shape = self.call("createCollisionShape", pybullet.GEOM_MESH, vertices=[(x, y, z) for x, y in body.size for z in (-0.5, 0.5)])
        w, x, y, z = body.q
        made = self.call("createMultiBody", m, shape, -1, body.at, (x, y, z, w))
        more = {} if held else {"localInertiaDiagonal": about}
        if body.fast:
            more["ccdSweptSphereRadius"] = body.size[0] / 2
        self.call("changeDynamics", made, -1, lateralFriction=body.friction ** 0.5, restitution=body.restitution ** 0.5, rollingFriction=0,
                  spinningFriction=0, linearDamping=0, angularDamping=0, **more)
        self.call("resetBaseVelocity", made, body.v or (0, 0, 0), body.w if isinstance(body.w, tuple) else (0, 0, 0))
        return made

    def step(self, count=1):
        for _ in range(count * self.scene.substeps):
            for body, force in self.pushes.items():
                at, _ = self.call("getBasePositionAndOrientation", self.made[body])
                self.call("applyExternalForce", self.made[body], -1, force, at, pybullet.WORLD_FRAME)
            self.call("stepSimulation")
        self.pushes.clear()

    def push(self, body, force):
        self.pushes[body] = (*force, 0.0)[:3]

    def state(self):
        poses = [self.call("getBasePositionAndOrientation", made) for made in self.made]
        moving = [self.call("getBaseVelocity", made) for made in self.made]
        q = np.array([pose[1] for pose in poses])
        return np.array([pose[0] for pose in poses]), q[:, [3, 0, 1, 2]], np.array([one[0] for one in moving]), np.array([one[1] for one in moving])

    def pulls(self):
        return np.array([np.linalg.norm(self.call("getConstraintState", pin)) for pin in self.pins])


def inside(body, at):
    w, v, way = body.q[0], -np.array(body.q[1:]), np.array(at) - body.at
    return tuple(way + 2 * np.cross(v, np.cross(v, way) + w * way))

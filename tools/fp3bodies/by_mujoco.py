"""MuJoCo in space; scenes in the plane have two slides and a hinge for each body. Pins make trees, and equalities where they close loops."""

import math

import mujoco
import numpy as np
from fp3bodies.engines import InSpace
from fp3bodies.scene import Refused, mass


def words(values):
    return " ".join(f"{one:.17g}" for one in values)


class Made(InSpace):
    ARITHMETIC = "double"
    NOTE = "elliptic cones, the integrator implicitfast; pins are the joints of a tree"
    INTEGRATOR = "implicitfast"

    def build(self, scene):
        if any(body.restitution for body in scene.bodies):
            raise Refused("it has no restitution")
        if any(body.fast for body in scene.bodies):
            raise Refused("it has no continuous collision")
        if any(body.moving for body in scene.bodies):
            raise Refused("what it is told to move has no speed in contacts")
        count = len(scene.bodies)
        above, closing = {}, []  # the pin by which a body hangs on another
        loose = scene.loose()
        for pin in scene.pins:
            if pin.b not in above and loose[pin.b]:
                above[pin.b] = pin
            else:
                closing.append(pin)
        below = {k: [] for k in range(-1, count)}
        for k in range(count):
            below[above[k].a if k in above and above[k].a >= 0 and loose[above[k].a] else -1].append(k)
        xml = [f'<mujoco><compiler angle="radian" autolimits="true"/><option gravity="{words(scene.gravity)}" '
               f'timestep="{scene.step / scene.substeps:.17g}" cone="elliptic" '
               f'integrator="{self.INTEGRATOR}"/><size memory="2G"/><asset>{self.meshes(scene)}</asset><worldbody>']
        for k in below[-1]:
            self.write(xml, scene, k, below, above, (0.0, 0.0, 0.0))
        ends = [f'<connect body1="b{pin.b}" {f"""body2="b{pin.a}" """ if pin.a >= 0 else ""}'
                f'anchor="{words(self.inside(scene.bodies[pin.b], pin.at))}"/>' for pin in closing]
        apart = [f'<exclude body1="b{pin.a}" body2="b{pin.b}"/>' for pin in scene.pins if pin.a >= 0]
        xml.append(f'</worldbody><equality>{"".join(ends)}</equality><contact>{"".join(apart)}</contact></mujoco>')
        self.model = mujoco.MjModel.from_xml_string("".join(xml))
        self.data = mujoco.MjData(self.model)
        self.ids = [mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, f"b{k}") for k in range(count)]
        self.hung = [self.ids[pin.b] if above.get(pin.b) is pin else -1 for pin in scene.pins]
        self.start(scene, above)
        mujoco.mj_forward(self.model, self.data)

    @staticmethod
    def inside(body, at):
        w, x, y, z = body.q
        way = np.array(at) - body.at
        v = -np.array((x, y, z))
        return way + 2 * np.cross(v, np.cross(v, way) + w * way)

    @staticmethod
    def meshes(scene):
        return "".join(f'<mesh name="m{k}" vertex="{words([one for x, y in body.size for z in (-0.5, 0.5) for one in (x, y, z)])}"/>'
                       for k, body in enumerate(scene.bodies) if body.shape == "polygon")

    def write(self, xml, scene, k, below, above, origin):
        """A body and what hangs on it. What hangs must not be turned against what it hangs on at first, or is written in its axes."""
        body = scene.bodies[k]
        parent = scene.bodies[above[k].a] if k in above and above[k].a >= 0 and origin is not None else None
        at, q = np.array(body.at), body.q
        if parent is not None and scene.loose()[above[k].a]:
            at = self.inside(parent, body.at)
            q = times((parent.q[0], *(-one for one in parent.q[1:])), body.q)
        xml.append(f'<body name="b{k}" pos="{words(at)}" quat="{words(q)}">')
        if scene.loose()[k]:
            if k in above:
                point = words(self.inside(body, above[k].at))
                xml.append(f'<joint type="hinge" axis="0 0 1" pos="{point}"/>' if scene.planar else f'<joint type="ball" pos="{point}"/>')
            elif scene.planar:
                c, s = math.cos(2 * math.atan2(body.q[3], body.q[0])), math.sin(2 * math.atan2(body.q[3], body.q[0]))
                xml.append(f'<joint type="slide" axis="{c:.17g} {-s:.17g} 0"/>'
                           f'<joint type="slide" axis="{s:.17g} {c:.17g} 0"/><joint type="hinge" axis="0 0 1"/>')
            else:
                xml.append("<freejoint/>")
            m, about = mass(body, 3) if not body.inertia else (body.mass, body.inertia)
            xml.append(f'<inertial pos="0 0 0" mass="{m:.17g}" diaginertia="{words(about)}"/>')
        if body.shape == "disc":
            shape = f'type="sphere" size="{words(body.size)}"'
        elif body.shape == "box":
            shape = f'type="box" size="{words(body.size)}"'
        elif body.shape == "capsule":
            shape = f'type="capsule" size="{body.size[1]:.17g}" fromto="{-body.size[0]:.17g} 0 0 {body.size[0]:.17g} 0 0"'
        else:
            shape = f'type="mesh" mesh="m{k}"'
        xml.append(f'<geom {shape} friction="{body.friction:.17g} 0 0" condim="3"/>')
        for other in below[k]:
            self.write(xml, scene, other, below, above, body.at)
        xml.append("</body>")

    def start(self, scene, above):
        """Speeds at first."""
        for k, body in enumerate(scene.bodies):
            first, many = self.model.body_dofadr[self.ids[k]], self.model.body_dofnum[self.ids[k]]
            spin = np.array(body.w if isinstance(body.w, tuple) else (0.0, 0.0, 0.0))
            if many and (any(body.v) or spin.any()):
                own = self.inside(body, spin + body.at)
                if k in above:
                    self.data.qvel[first:first + many] = spin[2] if scene.planar else own
                else:
                    self.data.qvel[first:first + many] = (*body.v[:2], spin[2]) if scene.planar else (*(body.v or (0, 0, 0)), *own)

    def step(self, count=1):
        mujoco.mj_step(self.model, self.data, nstep=count * self.scene.substeps)
        self.data.xfrc_applied[:] = 0

    def state(self):
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_comVel(self.model, self.data)
        found = np.zeros((len(self.ids), 6))
        for k, own in enumerate(self.ids):
            mujoco.mj_objectVelocity(self.model, self.data, mujoco.mjtObj.mjOBJ_XBODY, own, found[k], 0)
        return self.data.xpos[self.ids].copy(), self.data.xquat[self.ids].copy(), found[:, 3:], found[:, :3]

    def push(self, body, force):
        self.data.xfrc_applied[self.ids[body], :3] = (*force, 0.0)[:3]

    def pulls(self):
        if min(self.hung) < 0:
            raise Refused("pins that close loops tell no force here")
        mujoco.mj_rnePostConstraint(self.model, self.data)
        return np.linalg.norm(self.data.cfrc_int[self.hung, 3:], axis=1)


class RungeKutta(Made):
    NOTE = "elliptic cones, the integrator RK4; pins are the joints of a tree"
    INTEGRATOR = "RK4"


class Euler(Made):
    INTEGRATOR = "Euler"


class Implicit(Made):
    INTEGRATOR = "implicit"


def times(p, q):
    a, b = np.array(p[1:]), np.array(q[1:])
    return (p[0] * q[0] - a @ b, *(p[0] * b + q[0] * a + np.cross(a, b)))

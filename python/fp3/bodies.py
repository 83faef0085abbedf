"""Rigid bodies with shapes: they collide, rub, stack, and sleep. Experimental, as fp3/bodies.h is."""

from __future__ import annotations

import ctypes
import os
import time
from typing import Any, Dict, Optional, Sequence, Tuple, Union

import numpy as np

from . import _declarations as d
from . import _library
from ._library import Handle, Owner, check, name_bytes
from .batch import STEPS_MOST, next_part, part_of
from .errors import ArgumentError, FailedError
from .given import as_count, as_flag, as_number, as_values, handles_of, shown

Array = "np.ndarray[Any, Any]"
Values = Union[float, "np.ndarray[Any, Any]", Sequence[Any]]
_TYPES = {"dynamic": d.FP3_DYNAMIC, "kinematic": d.FP3_KINEMATIC, "static": d.FP3_STATIC}
# How many numbers a value of a body has, in a plane and in space; any other has one.
_WIDTHS = {2: {"x": 2, "v": 2, "force": 2}, 3: {"x": 3, "v": 3, "force": 3, "q": 4, "spin": 3, "torque": 3, "inertia": 3}}
_JOINTS = {"rod": d.FP3_ROD, "hinge": d.FP3_HINGE, "slider": d.FP3_SLIDER, "wheel": d.FP3_WHEEL, "weld": d.FP3_WELD, "gear": d.FP3_GEAR,
           "ball": d.FP3_BALL}
_CHANGES = {"began": d.FP3_CONTACT_BEGAN, "ended": d.FP3_CONTACT_ENDED, "hit": d.FP3_CONTACT_HIT}


def _mask(value: Any) -> int:
    return as_count("mask", value, 0, 2**32 - 1)


class BodiesState(Owner):
    """What Bodies.save copied, for Bodies.restore."""

    _what = "saved world of bodies"

    def __init__(self, pointer: Any, world: "Bodies") -> None:
        self._own()
        self._handle = Handle(pointer, "fp3_bodies_state_free", world._handle)  # which stays: no other world may get its place in memory
        self._world = world._handle


def _vector(what: str, value: Any, size: int) -> Tuple[float, ...]:
    array = as_values(what, value, f"{size} numbers")
    if array.shape != (size,):
        raise ArgumentError(f"{what}: found shape {array.shape}, expected {size} numbers")
    return tuple(float(x) for x in array)


def _place(what: str, value: Any) -> Tuple[float, ...]:
    """Of a shape, in a plane or in space: three numbers."""
    array = as_values(what, value, "two numbers, or three in space")
    if array.shape not in ((2,), (3,)):
        raise ArgumentError(f"{what}: found shape {array.shape}, expected two numbers, or three in space")
    return (*map(float, array), *([0.0] if array.size == 2 else []))


def _pair(what: str, value: Any) -> Tuple[float, float]:
    array = as_values(what, value, "two numbers")
    if array.shape != (2,):
        raise ArgumentError(f"{what}: found shape {array.shape}, expected two numbers")
    return float(array[0]), float(array[1])


def _points(what: str, value: Any, size: int = 2) -> "np.ndarray[Any, Any]":
    array = as_values(what, value, f"{size} numbers for each point")
    if array.ndim != 2 or array.shape[1] != size:
        raise ArgumentError(f"{what}: found shape {array.shape}, expected {size} numbers for each point")
    return np.require(array, np.float64, ["C", "A"])


class Shape:
    """What circle, box, capsule or polygon made, for Bodies.attach. It does not change."""

    __slots__ = ("_definition", "_text")

    def __init__(self, text: str, kind: int, radius: float, density: float = 1.0, friction: float = 0.6, restitution: float = 0.0, rolling: float = 0.0,
                 belt: float = 0.0, surface: Values = (0.0, 0.0, 0.0), category: int = 1, mask: int = 2**32 - 1, is_sensor: bool = False) -> None:
        made = _library.library().default(d.fp3_shape_def)
        made.type, made.radius = kind, as_number("radius", radius)
        made.density, made.friction = as_number("density", density), as_number("friction", friction)
        made.restitution, made.rolling, made.belt = as_number("restitution", restitution), as_number("rolling", rolling), as_number("belt", belt)
        made.surface[:] = _vector("surface", surface, 3)
        made.category, made.mask = as_count("category", category, 0, 2**32 - 1), as_count("mask", mask, 0, 2**32 - 1)
        made.is_sensor = as_flag("is_sensor", is_sensor)
        self._definition, self._text = made, text

    def __repr__(self) -> str:
        return f"fp3.{self._text}"


def _shape(shape: Any) -> Any:
    if not isinstance(shape, Shape):
        raise ArgumentError(f"shape: found {shown(shape)}, expected what fp3.circle, box, capsule, polygon, sphere, hull or plane made")
    return ctypes.pointer(shape._definition)


def circle(radius: float, *, centre: Values = (0.0, 0.0), **material: Any) -> Shape:
    """A circle. centre: from the body's origin. material: density, friction, restitution, rolling, category, mask, is_sensor, in a plane belt, in space surface
    (fp3_shape_def)."""
    middle = (*_pair("centre", centre), 0.0)
    made = Shape(f"circle({shown(radius)})", d.FP3_CIRCLE, radius, **material)
    made._definition.centre[:] = middle
    return made


def sphere(radius: float, *, centre: Values = (0.0, 0.0, 0.0), **material: Any) -> Shape:
    """A sphere, in space. material: as of circle."""
    middle = _vector("centre", centre, 3)
    made = Shape(f"sphere({shown(radius)})", d.FP3_SPHERE, radius, **material)
    made._definition.centre[:] = middle
    return made


def plane(normal: Values = (0.0, 1.0, 0.0), *, centre: Values = (0.0, 0.0, 0.0), **material: Any) -> Shape:
    """All points below a plane through a point, as ground in space. material: as of circle."""
    up, middle = _vector("normal", normal, 3), _vector("centre", centre, 3)
    made = Shape(f"plane({up})", d.FP3_PLANE, 0.0, **material)
    made._definition.normal[:], made._definition.centre[:] = up, middle
    return made


def box(half_x: float, half_y: float, half_z: Optional[float] = None, *, radius: float = 0.0, centre: Values = (0.0, 0.0), angle: float = 0.0,
        q: Values = (1.0, 0.0, 0.0, 0.0), **material: Any) -> Shape:
    """A box by half its sides, three in space, its corners rounded by a radius that comes on top. centre, angle or q: as the body has it. material: as of circle."""
    half = (as_number("half_x", half_x), as_number("half_y", half_y), 0.0 if half_z is None else as_number("half_z", half_z))
    middle, turn, quaternion = _place("centre", centre), as_number("angle", angle), _vector("q", q, 4)
    made = Shape(f"box({', '.join(f'{side:g}' for side in half[:2 if half_z is None else 3])})", d.FP3_BOX, radius, **material)
    made._definition.half[:], made._definition.centre[:], made._definition.angle, made._definition.q[:] = half, middle, turn, quaternion
    return made


def capsule(a: Values, b: Values, radius: float, **material: Any) -> Shape:
    """From one end to the other, rounded by a radius; a segment if that is 0. material: as of circle."""
    ends = _place("a", a), _place("b", b)
    made = Shape(f"capsule({ends[0]}, {ends[1]}, {shown(radius)})", d.FP3_CAPSULE, radius, **material)
    made._definition.corners = 2
    made._definition.corner[0][:], made._definition.corner[1][:] = ends
    return made


def polygon(points: Values, *, radius: float = 0.0, **material: Any) -> Shape:
    """The hull of 3 to 8 points in any order, rounded by a radius that comes on top. material: as of circle."""
    corners = _points("points", points)
    if len(corners) > d.FP3_CORNERS:
        raise ArgumentError(f"points: found {len(corners)}, expected at most {d.FP3_CORNERS}")
    made = Shape(f"polygon({len(corners)} points)", d.FP3_POLYGON, radius, **material)
    made._definition.corners = len(corners)
    for to, corner in zip(made._definition.corner, corners):
        to[:] = (*corner, 0.0)
    return made


def hull(points: Values, *, radius: float = 0.0, **material: Any) -> Shape:
    """The hull of 4 to 32 points in space in any order, rounded by a radius that comes on top. material: as of circle."""
    corners = _points("points", points, 3)
    if len(corners) > d.FP3_HULL_CORNERS:
        raise ArgumentError(f"points: found {len(corners)}, expected at most {d.FP3_HULL_CORNERS}")
    made = Shape(f"hull({len(corners)} points)", d.FP3_HULL, radius, **material)
    made._definition.corners = len(corners)
    for to, corner in zip(made._definition.corner, corners):
        to[:] = tuple(corner)
    return made


class Bodies(Owner):
    """Rigid bodies in a plane, or in space with dimensions=3.

        world = fp3.Bodies(gravity=(0, -10))
        ground = world.add(type="static", x=(0, -1))
        world.attach(ground, fp3.box(50, 1))
        boxes = world.add(x=np.column_stack([np.zeros(10), 0.5 + np.arange(10)]))
        world.attach(boxes, fp3.box(0.5, 0.5))
        world.step(60)
        world.read("x", boxes)          # of shape (10, 2)

    The words are those of fp3/bodies.h, where each is explained; so are the defaults, but for None, which is the default there. engine: laws of contacts are
    programs, which "isa", "fast" or "rtl" executes contact by contact, with the same bits; config: of hardware, "world" if it is None; may_compile: native
    code on "fast". threads: 0 is one for each processor; the number changes no bit. laws: a folder of texts that replace those of programs/bodies/.

    Bodies may be used by several threads; their calls follow each other. After a fork a child opens its own.
    """

    _what = "world of bodies"
    __iter__ = None  # len() counts bodies, and values have names: there is no order to go through

    def __init__(self, *, dimensions: int = 2, gravity: Optional[Values] = None, h: Optional[float] = None, substeps: int = 4, threads: int = 1, size: float = 1.0,
                 engine: Optional[str] = None, config: Optional[str] = None, may_compile: bool = False, laws: Optional[str] = None, push: Optional[float] = None,
                 bounce: Optional[float] = None, rest_speed: Optional[float] = None,
                 rest_time: Optional[float] = None) -> None:
        self._own()
        definition = self._lib.default(d.fp3_bodies_def)
        definition.dimensions = self._width = as_count("dimensions", dimensions, 0, 2**32 - 1)
        if gravity is not None:
            definition.gravity[:] = _place("gravity", gravity)
        definition.substeps, definition.size = as_count("substeps", substeps, 0, 2**32 - 1), as_number("size", size)
        for name, value in {"h": h, "push": push, "bounce": bounce, "rest_speed": rest_speed, "rest_time": rest_time}.items():
            if value is not None:
                setattr(definition, name, as_number(name, value))
        self._open(definition, threads, engine, config, may_compile, laws, self._lib.fp3_bodies_open)

    def _open(self, definition: Any, threads: int, engine: Optional[str], config: Optional[str], may_compile: bool, laws: Optional[str], call: Any) -> None:
        definition.threads = as_count("threads", threads, 0, 1024)
        definition.engine = None if engine is None else name_bytes("engine", engine)
        definition.config = None if config is None else name_bytes("config", config)
        definition.may_compile = as_flag("may_compile", may_compile)
        definition.laws = None if laws is None else name_bytes("laws", laws)
        definition.error = ctypes.pointer(self._error)
        pointer = ctypes.c_void_p()
        with _library.loading:
            check(call(definition, pointer), self._error)
        self._handle = Handle(pointer, "fp3_bodies_close", definition, self._error)
        self._part = 1
        self._told: Optional[Dict[str, Any]] = None  # changes of a step call that was made in parts
        self._ended = 0  # contacts that had ended when the last part was made

    @classmethod
    def restart(cls, path: Union[str, "os.PathLike[str]"], *, threads: int = 1, engine: Optional[str] = None, config: Optional[str] = None, may_compile: bool = False,
                laws: Optional[str] = None) -> "Bodies":
        """Opens the world of a checkpoint, which goes on with the same bits; handles stay. Gravity and the like are those of the file."""
        made, where = cls.__new__(cls), name_bytes("path", path)
        made._own()
        made._open(made._lib.default(d.fp3_bodies_def), threads, engine, config, may_compile, laws,
                   lambda definition, pointer: made._lib.fp3_bodies_restart(definition, where, pointer))
        with made._c() as c:
            made._width = int(made._lib.fp3_bodies_dimensions(c))
        return made

    def __enter__(self) -> "Bodies":
        return self

    def __len__(self) -> int:
        with self._c() as c:
            return int(self._lib.fp3_bodies_count(c))

    def __bool__(self) -> bool:
        return True  # also without a body

    def __repr__(self) -> str:
        return "fp3.Bodies(closed)" if self._handle is None else f"fp3.Bodies({len(self)} bodies)"

    # ---- who is there ----

    def add(self, *, type: str = "dynamic", x: Optional[Values] = None, v: Optional[Values] = None, angle: Values = 0.0, w: Values = 0.0,
            q: Values = (1.0, 0.0, 0.0, 0.0), spin: Values = (0.0, 0.0, 0.0), damping: Values = 0.0, spin_damping: Values = 0.0, gravity: Values = 1.0,
            may_not_turn: bool = False, may_not_sleep: bool = False, is_fast: bool = False) -> "np.ndarray[Any, Any]":
        """Adds a body, or as many as a column has rows: x and v are two numbers, or two for each body (three in space, where there are q and spin instead of
        angle and w); the others are a number, or one for each.

        Their handles, always as an array. They get the lowest numbers that are free. type: "dynamic", "kinematic" or "static". After an error none was added.
        """
        if not isinstance(type, str) or type not in _TYPES:
            raise ArgumentError(f"type: found {shown(type)}, expected 'dynamic', 'kinematic' or 'static'")
        given = {"x": x, "v": v, "angle": angle, "w": w, "q": q, "spin": spin, "damping": damping, "spin_damping": spin_damping, "gravity": gravity}
        columns, count = self._columns({name: value for name, value in given.items() if value is not None})
        flags = {"may_not_turn": may_not_turn, "may_not_sleep": may_not_sleep, "is_fast": is_fast}
        flags = {name: as_flag(name, value) for name, value in flags.items()}
        default = self._lib.default(d.fp3_body_def)
        default.type = _TYPES[type]
        for name, value in flags.items():
            setattr(default, name, value)
        made = np.repeat(np.frombuffer(default, np.dtype(d.fp3_body_def)), count)
        for name, column in columns.items():
            part = made[name] if made[name].ndim == 1 else made[name][:, :column.shape[-1]]
            part[...] = column
        handles = np.zeros(count, np.uint64)
        with self._c() as c:
            check(self._lib.fp3_bodies_add(c, made.ctypes.data_as(ctypes.POINTER(d.fp3_body_def)), count, handles.ctypes.data), self._error)
        return handles

    def _columns(self, given: Dict[str, Any]) -> Tuple[Dict[str, "np.ndarray[Any, Any]"], int]:
        """As arrays, and how many bodies they are for: 1, if all are the same for all."""
        columns, rows = {}, {}
        for name, value in given.items():
            width = {"q": 4, "spin": 3}.get(name) or _WIDTHS[self._width].get(name)
            column, own = as_values(name, value), (width,) if width else ()
            if column.ndim == len(own) + 1 and column.shape[1:] == own:
                rows[name] = len(column)
            elif column.shape != own:
                raise ArgumentError(f"{name}: found shape {column.shape}, expected " + (f"{own} or (bodies, {width})" if own else "a number or one for each body"))
            columns[name] = column
        if len(set(rows.values())) > 1:
            raise ArgumentError("columns for different numbers of bodies: " + ", ".join(f"{name} {count}" for name, count in rows.items()))
        return columns, next(iter(rows.values()), 1)

    def remove(self, handles: Any) -> None:
        """Removes bodies with their shapes. What they touched wakes. After an error all are there."""
        column = handles_of(handles)
        with self._c() as c:
            check(self._lib.fp3_bodies_remove(c, column.ctypes.data, column.size), self._error)

    @property
    def handles(self) -> "np.ndarray[Any, Any]":
        """Of all bodies, in the order of their numbers."""
        with self._c() as c:
            found = np.zeros(self._lib.fp3_bodies_count(c), np.uint64)
            self._lib.fp3_bodies_handles(c, found.ctypes.data)
        return found

    # ---- shapes ----

    def attach(self, handles: Any, shape: Shape) -> None:
        """Gives each of these bodies this shape. A body may have several: its mass, centre and inertia are those of all."""
        column, definition = handles_of(handles), _shape(shape)
        with self._c() as c:
            check(self._lib.fp3_bodies_attach(c, column.ctypes.data, column.size, definition, None), self._error)

    def chain(self, handle: Any, corners: Values, loop: bool = False, *, radius: float = 0.0, **material: Any) -> None:
        """Gives a body that is not dynamic a chain of edges as ground, to the left of the way along its corners: a floor runs from right to left.

        What slides over its inner corners does not catch there. loop: from the last corner back to the first. radius: rounds the edges. material: as of circle.
        """
        column, points, is_loop = handles_of(handle), _points("corners", corners), as_flag("loop", loop)
        surface = Shape("", d.FP3_CAPSULE, radius, **material)._definition
        with self._c() as c:
            check(self._lib.fp3_bodies_attach_chain(c, self._one(column), points.ctypes.data, len(points), is_loop, ctypes.pointer(surface)), self._error)

    def mesh(self, handle: Any, points: Values, triangles: Values, **material: Any) -> None:
        """Gives a body in space that is not dynamic a mesh of triangles as ground: three numbers for each point, three points for each triangle, anticlockwise
        as seen from outside. material: as of circle."""
        column, corners = handles_of(handle), _points("points", points, 3)
        given = np.asarray(triangles)
        if given.ndim != 2 or given.shape[1] != 3 or given.dtype.kind not in "iu" or (given.size and (given.min() < 0 or given.max() > 2**32 - 1)):
            raise ArgumentError(f"triangles: found shape {given.shape} of {given.dtype}, expected three numbers of points for each triangle")
        of = np.require(given, np.uint32, ["C", "A"])
        with self._c() as c:
            check(self._lib.fp3_bodies_attach_mesh(c, self._one(column), corners.ctypes.data, len(corners), of.ctypes.data, len(of), self._surface(material)), self._error)

    def heights(self, handle: Any, dx: float, dy: float, heights: Values, **material: Any) -> None:
        """The same of heights[j, i] above the points (i dx, j dy) of the body's axes; up is z. material: as of circle."""
        column, grid = handles_of(handle), as_values("heights", heights, "a table")
        if grid.ndim != 2:
            raise ArgumentError(f"heights: found shape {grid.shape}, expected rows and columns")
        table = np.require(grid, np.float64, ["C", "A"])
        with self._c() as c:
            check(self._lib.fp3_bodies_attach_heights(c, self._one(column), table.shape[1], table.shape[0], as_number("dx", dx), as_number("dy", dy),
                                                      table.ctypes.data, self._surface(material)), self._error)

    @staticmethod
    def _one(column: "np.ndarray[Any, Any]") -> int:
        if column.size != 1:
            raise ArgumentError(f"handle: found {column.size}, expected one")
        return int(column[0])

    @staticmethod
    def _surface(material: Dict[str, Any]) -> Any:
        return ctypes.pointer(Shape("", d.FP3_SPHERE, 0.0, **material)._definition)

    # ---- joints ----

    def join(self, type: str, a: Any, b: Any, *, anchor_a: Values = (0.0, 0.0), anchor_b: Values = (0.0, 0.0), axis: Values = (1.0, 0.0), axle: Values = (0.0, 0.0, 1.0), ratio: float = 1.0,
             limits: Optional[Values] = None, speed: float = 0.0, most: float = 0.0, hertz: float = 0.0, damping: float = 0.7, rest: Optional[float] = None,
             force: float = 0.0, torque: float = 0.0, may_collide: bool = False) -> "np.ndarray[Any, Any]":
        """Joins bodies, pair by pair: "rod", "hinge", "slider", "wheel", "weld", in a plane "gear", in space "ball" (fp3_joint_def has each word). One body goes with all of the others.

        The joints' handles, always as an array. limits: (low, high). rest: None: where a rod or spring is now. After an error nothing is joined.
        """
        if not isinstance(type, str) or type not in _JOINTS:
            raise ArgumentError(f"type: found {shown(type)}, expected {', '.join(repr(name) for name in _JOINTS)}")
        first, second = handles_of(a), handles_of(b)
        if 1 not in (first.size, second.size) and first.size != second.size:
            raise ArgumentError(f"a and b: found {first.size} and {second.size} handles, expected as many")
        first, second = np.broadcast_arrays(first, second)
        one = self._lib.default(d.fp3_joint_def)
        one.type, one.anchor_a[:], one.anchor_b[:], one.axis[:] = _JOINTS[type], _place("anchor_a", anchor_a), _place("anchor_b", anchor_b), _place("axis", axis)
        one.axle[:] = _vector("axle", axle, 3)
        numbers = {"ratio": ratio, "speed": speed, "most": most, "hertz": hertz, "damping": damping, "force": force, "torque": torque}
        for name, value in numbers.items():
            setattr(one, name, as_number(name, value))
        one.may_collide = as_flag("may_collide", may_collide)
        if rest is not None:
            one.rest = as_number("rest", rest)
        if limits is not None:
            one.has_limits, (one.low, one.high) = 1, _pair("limits", limits)
        made = np.repeat(np.frombuffer(one, np.dtype(d.fp3_joint_def)), first.size)
        made["a"], made["b"] = first, second
        joints = np.zeros(first.size, np.uint64)
        with self._c() as c:
            check(self._lib.fp3_bodies_join(c, made.ctypes.data_as(ctypes.POINTER(d.fp3_joint_def)), first.size, joints.ctypes.data), self._error)
        return joints

    def unjoin(self, joints: Any) -> None:
        """Removes joints. After an error all are there."""
        column = handles_of(joints)
        with self._c() as c:
            check(self._lib.fp3_bodies_unjoin(c, column.ctypes.data, column.size), self._error)

    def is_joined(self, joints: Any) -> "np.ndarray[Any, Any]":
        """Which of these joints there still are: others were removed, with a body too, or broke."""
        column = handles_of(joints)
        with self._c() as c:
            return np.array([bool(self._lib.fp3_bodies_is_joined(c, int(joint))) for joint in column], bool)

    @property
    def joints(self) -> int:
        """How many there are."""
        with self._c() as c:
            return int(self._lib.fp3_bodies_joints(c))

    def read_joint(self, name: str, joints: Any) -> "np.ndarray[Any, Any]":
        """at: the distance, way or angle from the start; force_x, force_y, torque: what a joint does to b; speed, most, low, high, rest."""
        key, column = name_bytes("name", name), handles_of(joints)
        found = np.empty(column.size)
        with self._c() as c:
            check(self._lib.fp3_bodies_joint_read(c, key, column.ctypes.data, column.size, found.ctypes.data), self._error)
        return found

    def write_joint(self, name: str, joints: Any, values: Values) -> None:
        """speed, most, low, high or rest: the same for all of these joints, or one for each. Their bodies wake."""
        key, column, given = name_bytes("name", name), handles_of(joints), as_values(f"'{name}'", values)
        if given.shape not in ((), (column.size,)):
            raise ArgumentError(f"'{name}': found shape {given.shape}, expected a number or {column.size}")
        given = np.require(np.broadcast_to(given, (column.size,)), np.float64, ["C", "A"])
        with self._c() as c:
            check(self._lib.fp3_bodies_joint_write(c, key, column.ctypes.data, column.size, given.ctypes.data), self._error)

    # ---- contacts ----

    def changes(self, change: str) -> "np.ndarray[Any, Any]":
        """Contacts that "began", "ended" or "hit" in the last call of step: body_a, body_b, shape_a, shape_b, point, normal, speed, impulse of each.

        An array of records, as changes("hit")["impulse"]; a copy. "ended" has those that the caller's changes have ended since, too.
        """
        if not isinstance(change, str) or change not in _CHANGES:
            raise ArgumentError(f"change: found {shown(change)}, expected 'began', 'ended' or 'hit'")
        with self._c():
            now = self._changed(change)
            if self._told is None:
                return now
            return np.concatenate([self._told[change], now[self._ended:]]) if change == "ended" else self._told[change].copy()

    def _changed(self, change: str) -> "np.ndarray[Any, Any]":
        with self._c() as c:
            return self._contacts(lambda found, count: self._lib.fp3_bodies_changes(c, _CHANGES[change], found, count))

    def contacts(self) -> "np.ndarray[Any, Any]":
        """All contacts that touch now, likewise."""
        with self._c() as c:
            return self._contacts(lambda found, count: self._lib.fp3_bodies_contacts(c, found, count))

    def _contacts(self, call: Any) -> "np.ndarray[Any, Any]":
        found, count = ctypes.POINTER(d.fp3_contact)(), ctypes.c_size_t()
        check(call(ctypes.byref(found), ctypes.byref(count)), self._error)
        made = np.zeros(count.value, np.dtype(d.fp3_contact))
        if count.value:
            ctypes.memmove(made.ctypes.data, found, made.nbytes)
        return self._records(made)

    def _records(self, made: "np.ndarray[Any, Any]") -> "np.ndarray[Any, Any]":
        """In a plane points and normals have two numbers."""
        if self._width == 3:
            return made
        fields = {name: (np.dtype((np.float64, 2)) if name in ("point", "normal") else of[0], of[1]) for name, of in made.dtype.fields.items()}
        shown_as = np.dtype({"names": list(fields), "formats": [of for of, _ in fields.values()], "offsets": [at for _, at in fields.values()], "itemsize": made.itemsize})
        return made.view(shown_as)

    # ---- questions ----

    def ray(self, origins: Values, ways: Values, mask: int = 2**32 - 1) -> "np.ndarray[Any, Any]":
        """What rays meet first, each from an origin along its whole way: records body, shape, point, normal, distance, fraction. body 0: nothing.

        mask: only shapes whose category has a bit of it, as in all questions.
        """
        start, way = _points("origins", np.atleast_2d(origins), self._width), _points("ways", np.atleast_2d(ways), self._width)
        if len(start) != len(way):
            raise ArgumentError(f"origins and ways: found {len(start)} and {len(way)}, expected as many")
        return self._hits(len(start), lambda c, hits: self._lib.fp3_bodies_ray(c, start.ctypes.data, way.ctypes.data, len(start), _mask(mask), hits))

    def _turn(self, angle: float, q: Values) -> "np.ndarray[Any, Any]":
        if angle != 0 if self._width == 3 else tuple(np.ravel(np.asarray(q))) != (1, 0, 0, 0):
            raise ArgumentError("in space q says how a shape stands, not angle" if self._width == 3 else "in a plane angle says how a shape stands, not q")
        return np.array([as_number("angle", angle)] if self._width == 2 else _vector("q", q, 4))

    def cast(self, shape: Shape, x: Values, way: Values, angle: float = 0.0, mask: int = 2**32 - 1, *,
             q: Values = (1.0, 0.0, 0.0, 0.0)) -> "np.ndarray[Any, Any]":
        """What a shape meets first that stands at x and goes along a way without turning: one record, as of ray. angle, in space q: how it stands."""
        pose, along, turn = np.array(_vector("x", x, self._width)), np.array(_vector("way", way, self._width)), self._turn(angle, q)
        return self._hits(1, lambda c, hits: self._lib.fp3_bodies_cast(c, _shape(shape), pose.ctypes.data, turn.ctypes.data, along.ctypes.data, _mask(mask), hits))

    def overlap(self, shape: Shape, x: Values, angle: float = 0.0, mask: int = 2**32 - 1, *, q: Values = (1.0, 0.0, 0.0, 0.0)) -> "np.ndarray[Any, Any]":
        """All shapes that overlap this one, by their numbers: records, whose distance is below 0."""
        pose, turn, count = np.array(_vector("x", x, self._width)), self._turn(angle, q), ctypes.c_size_t()

        def ask(room: int) -> "np.ndarray[Any, Any]":
            return self._hits(room, lambda c, hits: self._lib.fp3_bodies_overlap(
                c, _shape(shape), pose.ctypes.data, turn.ctypes.data, _mask(mask), room, hits, ctypes.byref(count)))
        with self._c():
            found = ask(64)
            return found[:count.value] if count.value <= 64 else ask(count.value)

    def nearest(self, points: Values, mask: int = 2**32 - 1) -> "np.ndarray[Any, Any]":
        """The shape that is nearest to each point: records, as of ray. Within a shape the distance is below 0."""
        where = _points("points", np.atleast_2d(points), self._width)
        return self._hits(len(where), lambda c, hits: self._lib.fp3_bodies_nearest(c, where.ctypes.data, len(where), _mask(mask), hits))

    def _hits(self, count: int, call: Any) -> "np.ndarray[Any, Any]":
        made = np.zeros(count, np.dtype(d.fp3_hit))
        with self._c() as c:
            check(call(c, made.ctypes.data_as(ctypes.POINTER(d.fp3_hit))), self._error)
        return self._records(made)

    # ---- back in time ----

    def save(self, into: Optional[BodiesState] = None) -> BodiesState:
        """A copy of all that the world is; in the memory of one that was made before and is no longer wanted, which is faster."""
        if into is None:
            pointer = ctypes.c_void_p()
            with self._c() as c:
                check(self._lib.fp3_bodies_save(c, ctypes.byref(pointer)), self._error)
            return BodiesState(pointer, self)
        if not isinstance(into, BodiesState) or into._world is not self._handle:
            raise ArgumentError(f"into: found {shown(into)}, expected what save of this world gave")
        with self._c() as c, into._c() as saved:
            check(self._lib.fp3_bodies_save(c, ctypes.byref(saved)), self._error)
        return into

    def checkpoint(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes all that the world is to a file, for Bodies.restart: whole, or not at all. What the file held before stays as path.1."""
        with self._c() as c:
            check(self._lib.fp3_bodies_checkpoint(c, name_bytes("path", path)), self._error)

    def restore(self, state: BodiesState) -> None:
        """Goes back to what was saved of this world; a step then has the same bits."""
        if not isinstance(state, BodiesState):
            raise ArgumentError(f"state: found {shown(state)}, expected what Bodies.save gave")
        with self._c() as c, state._c() as saved:
            check(self._lib.fp3_bodies_restore(c, saved), self._error)
            self._told = None

    # ---- values ----

    def __contains__(self, name: object) -> bool:
        """Whether bodies have a value of this name."""
        try:
            key = name_bytes("name", name)
        except (TypeError, ValueError):
            return False
        with self._c() as c:
            return bool(self._lib.fp3_bodies_read(c, key, None, 0, None) == d.FP3_OK)

    def __getitem__(self, name: str) -> "np.ndarray[Any, Any]":
        """A value of all bodies, in the order of their numbers, as `handles` are: of x, v and force two numbers each, in space three. It is a copy."""
        with self._c():
            return self.read(name, self.handles)

    def read(self, name: str, handles: Any) -> "np.ndarray[Any, Any]":
        """A value of these bodies, as float64: x, v, force, mass, inertia, at_rest, torque, in a plane angle and w, in space q and spin; x_x is a part of x. It is a copy."""
        key, column = name_bytes("name", name), handles_of(handles)
        found = np.empty(self._shape(name, column))
        with self._c() as c:
            check(self._lib.fp3_bodies_read(c, key, column.ctypes.data, column.size, found.ctypes.data), self._error)
        return found

    def write(self, name: str, handles: Any, values: Values) -> None:
        """Writes a value of these bodies: the same for all, or one for each. They wake. After an error nothing is changed."""
        key, column, given = name_bytes("name", name), handles_of(handles), as_values(f"'{name}'", values)
        shape = self._shape(name, column)
        if given.shape not in (shape, shape[1:]):
            raise ArgumentError(f"'{name}': found shape {given.shape}, expected {shape[1:]} or {shape}")
        given = np.require(np.broadcast_to(given, shape), np.float64, ["C", "A"])
        with self._c() as c:
            check(self._lib.fp3_bodies_write(c, key, column.ctypes.data, column.size, given.ctypes.data), self._error)

    def _shape(self, name: str, handles: "np.ndarray[Any, Any]") -> Tuple[int, ...]:
        return (handles.size, _WIDTHS[self._width][name]) if name in _WIDTHS[self._width] else (handles.size,)

    # ---- steps ----

    def step(self, steps: int = 1) -> None:
        """Steps of length h each. FailedError: the position or speed of a body was not finite in one of them; all others have made their steps."""
        left, failed, parts = as_count("steps", steps, 0, STEPS_MOST), None, []
        with self._c():
            while left > 0:
                now, begun = part_of(left, self._part), time.perf_counter()
                try:
                    with self._c() as c:
                        check(self._lib.fp3_bodies_step(c, now), self._error)
                except FailedError as error:
                    failed = failed or error
                self._part = next_part(self._part, now, time.perf_counter() - begun)
                parts.append({change: self._changed(change) for change in _CHANGES} if parts or now < left else None)
                left -= now
            self._told = {change: np.concatenate([part[change] for part in parts]) for change in _CHANGES} if len(parts) > 1 else None
            self._ended = len(parts[-1]["ended"]) if len(parts) > 1 else 0
        if failed is not None:
            raise failed

    @property
    def time(self) -> float:
        """The time since the start."""
        with self._c() as c:
            return float(self._lib.fp3_bodies_time(c))

    @property
    def awake(self) -> int:
        """How many bodies do not sleep, after the last step."""
        with self._c() as c:
            return int(self._lib.fp3_bodies_awake(c))

    @property
    def touching(self) -> int:
        """How many contacts touch, after the last step."""
        with self._c() as c:
            return int(self._lib.fp3_bodies_touching(c))

    @property
    def hash(self) -> int:
        """Of where bodies are, how they move, who sleeps, and of the impulses of contacts."""
        with self._c() as c:
            return int(self._lib.fp3_bodies_hash(c))

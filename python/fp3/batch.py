"""Many objects of one model: columns in, steps, columns out."""

from __future__ import annotations

import ctypes
import os
import sys
import time
import weakref
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _declarations as d
from . import _library
from ._library import Handle, Owner, check, name_bytes
from .errors import ArgumentError, Error, FailedError
from .given import as_count, as_flag, as_mapping, as_number, as_values, handles_of, links_of, split_links
from .model import How, Model, Program, Source, as_model

Value = Union[float, "np.ndarray[Any, Any]", Sequence[float]]
NOBODY = d.FP3_NOBODY    # instead of an object's number
STEPS_MOST = 2**32 - 1  # of a run
PART_SECONDS = 0.2      # of a run, between two looks at the keyboard
PART_FIRST = 64         # steps of the first part


class Failure(NamedTuple):
    """How objects failed in the last steps: how many, the first of them, in which step, and the reason in words."""

    failed: int
    object: int
    step: int
    text: str


class Contacts(NamedTuple):
    """The handles of both objects of each contact that began, and that ended, in the order of the objects' numbers."""

    began_a: "np.ndarray[Any, Any]"
    began_b: "np.ndarray[Any, Any]"
    ended_a: "np.ndarray[Any, Any]"
    ended_b: "np.ndarray[Any, Any]"


class Column(np.ndarray):
    """A column of a batch: it shows what the objects hold after the last step, and cannot be written.

    Other libraries take it by DLPack: torch.from_dlpack(batch["x"]). They must not write into it, either.
    """

    def __dlpack__(self, **options: Any) -> Any:
        if self.flags.writeable:
            return super().__dlpack__(**options)
        # DLPack has no word for memory that is only read, so NumPy exports none. This is the same memory.
        if not self.flags.c_contiguous:
            raise BufferError("a column goes out by DLPack as a whole, not in strides: copy it first")
        return np.asarray(_Memory(self, self.ctypes.data, self.shape, self.dtype.str, False)).__dlpack__(**options)


class _Memory:
    """What an array stands on that is made at an address: it keeps the owner of the memory."""

    def __init__(self, owner: Any, address: int, shape: Tuple[int, ...], kind: str, is_read_only: bool = True) -> None:
        self.owner = owner
        self.__array_interface__ = {"version": 3, "shape": shape, "typestr": kind, "data": (address, is_read_only)}


def link_all(batch: "Batch", links: Optional[Mapping[str, Any]]) -> None:
    for relation, (a, b, fields) in split_links(links).items():
        batch.link(relation, a, b, **fields)


def part_of(left: int, part: int) -> int:
    """The steps of the next part: all that are left, if they are not many more."""
    return left if left <= 2 * part else part


def next_part(part: int, made: int, seconds: float) -> int:
    """How many steps take about PART_SECONDS, if `made` of a part took this long."""
    if made < part and seconds < PART_SECONDS:
        return part
    return min(STEPS_MOST, max(1, int(made * min(8.0, PART_SECONDS / max(seconds, 1e-9)))))


def print_share(share: float) -> None:
    """What progress=True does."""
    print(f"\r  {share:6.1%}" + ("\n" if share >= 1 else ""), end="", file=sys.stderr, flush=True)


class Batch(Owner):
    """Many objects of one model, for loops that write, run and read.

        with fp3.Batch("drone.ode", objects=10_000) as drones:
            x, y = drones["x_x"], drones["x_y"]         # columns, which follow the steps
            for frame in range(600):
                drones["F_x"] = force_x                 # a number, or one for each object
                drones.run()
                draw(x, y)

    objects is the most that live at the same time. empty: nobody lives at first (see add). method, h, arithmetic, config, engine and threads are the words of
    `fp3 run`. tolerance: each object chooses its own steps until the time in its param `until`; 0: steps are h long and are
    cut at events. may_compile: native code, which pays off in long runs and starts a C compiler. links: of each relation of
    links, (a, b) or (a, b, fields).

    A batch may be used by several threads; their calls follow each other. After a fork a child opens its own.
    """

    _what = "batch"
    __iter__ = None  # len() counts objects, and columns have names: there is no order to go through

    def __init__(self, model: Union[Model, Source], objects: int = 1, *, params: Optional[Mapping[str, Value]] = None,
                 method: Optional[str] = None, h: Optional[float] = None, tolerance: Optional[float] = None,
                 absolute: float = 0.0, until: float = 0.0, maxstep: float = 0.0, arithmetic: str = "plain",
                 config: Optional[str] = None, engine: str = "fast", threads: int = 0, may_compile: bool = False,
                 skin: float = 0.0, links: Optional[Mapping[str, Tuple[Any, ...]]] = None, empty: bool = False) -> None:
        numbers = {"tolerance": 0.0 if tolerance is None else tolerance, "absolute": absolute, "until": until, "maxstep": maxstep, "skin": skin}
        numbers = {name: as_number(name, value) for name, value in numbers.items()}
        for name, number in numbers.items():
            if not 0 <= number < np.inf:
                raise ArgumentError(f"{name}: found {number}, expected a finite number, 0 or above")
        self.model = as_model(model)
        adaptive = None if tolerance is None else (numbers["tolerance"], numbers["absolute"], numbers["until"], numbers["maxstep"])
        self._open(self.model.program(How(method, arithmetic, config, adaptive)), as_count("objects", objects, 1, 2**32 - 1), h, engine,
                   as_count("threads", threads, 0, 1024), may_compile, numbers["skin"], empty)
        link_all(self, links)
        for name, value in as_mapping("params", params).items():
            self[name] = value

    def _open(self, program: Program, objects: int, h: Optional[float], engine: str, threads: int, may_compile: bool, skin: float,
              empty: bool = False) -> None:
        self._own()
        lib = self._lib
        definition = lib.default(d.fp3_batch_def)
        definition.compiled = program.c.compiled
        definition.compile.config = program.c.config
        definition.objects, definition.threads, definition.skin = objects, threads, skin
        definition.may_fail = 1  # run looks by itself: a run may have many parts
        definition.may_compile = as_flag("may_compile", may_compile)
        definition.is_empty = as_flag("empty", empty)
        definition.h = 0.0 if h is None else as_number("h", h)
        if h is not None and not definition.h > 0:
            raise ArgumentError(f"h: found {h}, expected a number above 0")
        definition.engine = name_bytes("engine", engine)
        definition.error = ctypes.pointer(self._error)
        pointer = ctypes.c_void_p()
        with _library.loading:
            check(lib.fp3_batch_open(definition, pointer), self._error)
        self._handle = Handle(pointer, "fp3_batch_close", program, definition, self._error)
        #: Where columns are that the engine does not have in one piece, while somebody looks at them.
        self._copies: "weakref.WeakValueDictionary[str, _Memory]" = weakref.WeakValueDictionary()
        self._program, self._objects = program, objects
        self._part, self._is_adaptive = PART_FIRST, program.how.adaptive is not None
        self._is_wide = program.c.compiled.contents.arithmetic == d.FP3_DOUBLE_SINGLE
        self._dtype = np.float64 if self._is_wide else np.float32

    # ---- the object itself ----

    def __enter__(self) -> "Batch":
        return self

    def __len__(self) -> int:
        return self._objects

    def __repr__(self) -> str:
        return f"fp3.Batch({self.model.name}: {self._objects} objects{', closed' if self._handle is None else ''})"

    # ---- values ----

    def __contains__(self, name: object) -> bool:
        """Whether there is a value of this name."""
        try:
            key = name_bytes("name", name)
        except (TypeError, ValueError):
            return False
        with self._c() as c:
            return bool(self._lib.fp3_batch_read(c, (ctypes.c_char_p * 1)(key), 1, 0, 0, (ctypes.c_void_p * 1)()) == d.FP3_OK)

    def __setitem__(self, name: str, value: Value) -> None:
        """A number for all objects, or one for each."""
        key, values = name_bytes("name", name), as_values(f"'{name}'", value)
        if values.ndim:
            self._write(name, values, 0, self._objects)
            return
        with self._c() as c:
            check(self._lib.fp3_batch_set(c, key, float(values)), self._error)
            self._show(name)

    def write(self, name: Union[str, List[str], Tuple[str, ...]], values: Value, first: int = 0, count: Optional[int] = None) -> None:
        """Writes one number for each of the objects from `first` on; for several names, a row of numbers for each. After an error, columns
        of earlier names are written."""
        if isinstance(name, (list, tuple)):
            self._write_table(name, as_values("values", values), as_count("first", first, 0, 2**63), count)
            return
        self._write(name, as_values(f"'{name}'", values), as_count("first", first, 0, 2**63),
                    None if count is None else as_count("count", count, 0, 2**63))

    def _write_table(self, names: Sequence[str], table: "np.ndarray[Any, Any]", first: int, count: Optional[int]) -> None:
        keys = [name_bytes("name", name) for name in names]
        if table.ndim != 2 or table.shape[1] != len(keys):
            raise ArgumentError(f"values: found shape {table.shape}, expected (objects, {len(keys)}): a number of each name")
        if count is not None and len(table) != as_count("count", count, 0, 2**63):
            raise ArgumentError(f"values: found {len(table)} rows, expected one for each of {count} objects")
        with self._c() as c:  # no other thread's steps between two columns
            if table.dtype != np.float32:  # the strided call takes no doubles
                for k, name in enumerate(names):
                    self._write(name, table[:, k], first, None)
                return
            rows = np.require(table, np.float32, ["C", "A"])
            try:
                check(self._lib.fp3_batch_write_strided(c, (ctypes.c_char_p * len(keys))(*keys), len(keys), first, len(rows), rows.ctypes.data, len(keys)),
                      self._error)
            finally:
                self._show(*names)

    def _write(self, name: str, array: "np.ndarray[Any, Any]", first: int, count: Optional[int]) -> None:
        key = name_bytes("name", name)
        if array.ndim != 1:
            raise ArgumentError(f"'{name}': found {array.dtype} of shape {array.shape}, expected a column of numbers")
        if count is not None and len(array) != count:
            raise ArgumentError(f"'{name}': found {len(array)} numbers, expected one for each of {count} objects")
        if array.dtype == np.float32:
            array, call = np.require(array, np.float32, ["C", "A"]), self._lib.fp3_batch_write
        else:
            array, call = np.require(array, np.float64, ["C", "A"]), self._lib.fp3_batch_write_double
        with self._c() as c:
            check(call(c, key, first, len(array), array.ctypes.data), self._error)
            self._show(name)

    def read(self, name: Union[str, List[str], Tuple[str, ...]], first: int = 0, count: Optional[int] = None,
             out: Optional["np.ndarray[Any, Any]"] = None) -> "np.ndarray[Any, Any]":
        """A copy of a column: float32, or float64 in double-single. out: an array of this type that receives it.

        Of several names, an array of shape (objects, names). Then out may be columns of a larger array.
        """
        if isinstance(name, (list, tuple)):
            return self._read_table(name, first, count, out)
        key, first = name_bytes("name", name), as_count("first", first, 0, self._objects)
        count = self._objects - first if count is None else as_count("count", count, 0, self._objects - first)
        if out is None:
            out = np.empty(count, self._dtype)
        elif not isinstance(out, np.ndarray) or isinstance(out, np.ma.MaskedArray) or out.dtype not in (np.float32, np.float64) or out.shape != (count,) \
                or not out.flags.carray or not out.dtype.isnative:
            raise ArgumentError(f"out: expected an array of float32 or float64 that can be written, of shape ({count},) and without strides")
        with self._c() as c:
            self._read(c, key, first, count, out)
        return out

    def _read_table(self, names: Sequence[str], first: int, count: Optional[int], out: Optional["np.ndarray[Any, Any]"]) -> "np.ndarray[Any, Any]":
        keys, first = [name_bytes("name", name) for name in names], as_count("first", first, 0, self._objects)
        count = self._objects - first if count is None else as_count("count", count, 0, self._objects - first)
        if out is None:
            out = np.empty((count, len(keys)), self._dtype)
        elif not isinstance(out, np.ndarray) or isinstance(out, np.ma.MaskedArray) or out.dtype not in (np.float32, np.float64) \
                or out.shape != (count, len(keys)) or not out.flags.writeable or not out.dtype.isnative:
            raise ArgumentError(f"out: expected an array of float32 or float64 that can be written, of shape ({count}, {len(keys)})")
        stride, rest = divmod(out.strides[0], 4)
        with self._c() as c:
            if out.dtype == np.float32 and out.flags.aligned and (len(keys) < 2 or out.strides[1] == 4) and not rest and stride >= len(keys):
                check(self._lib.fp3_batch_read_strided(c, (ctypes.c_char_p * len(keys))(*keys), len(keys), first, count, out.ctypes.data, stride), self._error)
                return out
            column = np.empty(count, out.dtype)
            for k, key in enumerate(keys):
                self._read(c, key, first, count, column)
                out[:, k] = column
        return out

    def _read(self, c: Any, key: bytes, first: int, count: int, out: "np.ndarray[Any, Any]") -> None:
        call = self._lib.fp3_batch_read if out.dtype == np.float32 else self._lib.fp3_batch_read_double
        check(call(c, (ctypes.c_char_p * 1)(key), 1, first, count, (ctypes.c_void_p * 1)(out.ctypes.data)), self._error)

    def __getitem__(self, name: str) -> Column:
        """A column of all objects, which follows the steps: the engine's own memory, or else a copy that each step renews."""
        key, address = name_bytes("name", name), ctypes.c_void_p()
        with self._c() as c:
            check(self._lib.fp3_batch_column(c, key, address), self._error)
            if address.value is not None and not self.model.relations:  # of objects that see each other it is another one after a step
                return np.asarray(_Memory(self._handle, address.value, (self._objects,), "<f4")).view(Column)
            name = key.decode(errors="surrogateescape")
            memory = self._copies.get(name)
            if memory is None:
                copy = np.empty(self._objects, self._dtype)
                memory = _Memory(copy, copy.ctypes.data, copy.shape, copy.dtype.str)
            self._read(c, key, 0, self._objects, memory.owner)
            self._copies[name] = memory
            return np.asarray(memory).view(Column)

    def _show(self, *names: str) -> None:
        """Renews the copies of these columns that somebody looks at."""
        if not self._copies:
            return
        with self._c() as c:
            for name in names:
                memory = self._copies.get(name)
                if memory is not None:
                    self._read(c, os.fsencode(name), 0, self._objects, memory.owner)

    def link(self, relation: str, a: Any, b: Any, **fields: Any) -> None:
        """Gives a relation its links, in place of those before: the two objects of each, and its fields by name."""
        keep: List[Any] = []
        key, links = name_bytes("relation", relation), links_of(a, b, fields, keep)
        with self._c() as c:
            check(self._lib.fp3_batch_link(c, key, links), self._error)

    def link_more(self, relation: str, a: Any, b: Any, **fields: Any) -> None:
        """Gives a relation more links. Those that it has stay, with what their pairs remember."""
        keep: List[Any] = []
        key, links = name_bytes("relation", relation), links_of(a, b, fields, keep)
        with self._c() as c:
            check(self._lib.fp3_batch_link_more(c, key, links), self._error)

    def unlink(self, relation: str, a: Any, b: Any) -> None:
        """Removes the links of these pairs of objects, whose ends may be in either order. The others stay, with what their pairs remember."""
        keep: List[Any] = []
        key, links = name_bytes("relation", relation), links_of(a, b, {}, keep)
        with self._c() as c:
            check(self._lib.fp3_batch_unlink(c, key, links.a, links.b, links.count), self._error)

    # ---- objects that come and go ----

    def add(self, count: int, /, **values: Value) -> "np.ndarray[Any, Any]":
        """`count` objects are born, with the model's defaults; values: by name, a number or one for each of them.

        Their handles: an object's own for as long as it lives. They get the lowest numbers that are free. LimitError: there
        is no room for them. After an error nobody was born.
        """
        handles = np.zeros(as_count("count", count, 0, 2**32 - 1), np.uint64)
        columns = {name: as_values(f"'{name}'", value) for name, value in values.items()}
        for name, column in columns.items():
            if column.shape not in ((), handles.shape):
                raise ArgumentError(f"'{name}': found shape {column.shape}, expected a number or one for each of {count} objects")
        with self._c() as c:
            check(self._lib.fp3_batch_add(c, len(handles), handles.ctypes.data), self._error)
            try:
                for name, column in columns.items():
                    self.write_of(name, handles, np.broadcast_to(column, handles.shape))
            except Error:
                check(self._lib.fp3_batch_remove(c, handles.ctypes.data, len(handles)), self._error)
                raise
            self._show(*self._copies)
        return handles

    def remove(self, handles: Any) -> None:
        """Removes objects. Nobody sees them any more, and their links and what pairs remember of them are gone for good."""
        column = handles_of(handles)
        with self._c() as c:
            check(self._lib.fp3_batch_remove(c, column.ctypes.data, column.size), self._error)

    @property
    def living(self) -> int:
        """How many objects live."""
        with self._c() as c:
            return int(self._lib.fp3_batch_living(c))

    @property
    def handles(self) -> "np.ndarray[Any, Any]":
        """The handle of each object number; 0: nobody lives there."""
        found = np.empty(self._objects, np.uint64)
        with self._c() as c:
            check(self._lib.fp3_batch_handles(c, 0, self._objects, found.ctypes.data), self._error)
        return found

    def numbers(self, handles: Any) -> "np.ndarray[Any, Any]":
        """The numbers of these objects, by which columns have them; NOBODY of who was removed."""
        column = handles_of(handles)
        found = np.empty(column.shape, np.uint32)
        with self._c() as c:
            self._lib.fp3_batch_numbers(c, column.ctypes.data, column.size, found.ctypes.data)
        return found

    def write_of(self, name: str, handles: Any, values: Value) -> None:
        """Writes a number for all of these objects, or one for each."""
        key, column, given = name_bytes("name", name), handles_of(handles), as_values(f"'{name}'", values)
        if given.shape not in ((), column.shape):
            raise ArgumentError(f"'{name}': found shape {given.shape}, expected a number or one for each of {column.size} objects")
        is_single = given.dtype == np.float32
        given = np.require(np.broadcast_to(given, column.shape), np.float32 if is_single else np.float64, ["C", "A"])
        with self._c() as c:
            call = self._lib.fp3_batch_write_of if is_single else self._lib.fp3_batch_write_of_double
            check(call(c, key, column.ctypes.data, column.size, given.ctypes.data), self._error)
            self._show(name)

    def read_of(self, name: str, handles: Any) -> "np.ndarray[Any, Any]":
        """The numbers of these objects."""
        found = self.numbers(handles)
        if (found == NOBODY).any():  # the library says of whom
            self.write_of(name, handles, np.zeros(found.shape, np.float32))
        return self.read(name)[found]

    # ---- who is where ----

    def pairs(self, of: str, distance: float = 0.0) -> Tuple["np.ndarray[Any, Any]", "np.ndarray[Any, Any]"]:
        """The numbers a < b of all pairs of objects within a distance of each other, ascending; 0: the reach of the relation.

        of: a relation of near objects, or a state that is a position: `x`, of which the model has x[2], say.
        """
        key, far, room = name_bytes("of", of), as_number("distance", distance), 0
        count = ctypes.c_size_t()
        with self._c() as c:
            while True:
                found = np.empty((2, room), np.uint32)
                check(self._lib.fp3_batch_pairs(c, key, far, room, found[0].ctypes.data, found[1].ctypes.data, ctypes.byref(count)), self._error)
                if count.value <= room:
                    return found[0, :count.value], found[1, :count.value]
                room = count.value

    def within(self, of: str, points: Any, radius: Value) -> Tuple["np.ndarray[Any, Any]", "np.ndarray[Any, Any]"]:
        """All objects within a radius of a point, or of each of several: which point, and the number of the object."""
        key, room, count = name_bytes("of", of), 0, ctypes.c_size_t()
        with self._c() as c:
            at = self._points(c, key, "points", points)
            radii = as_values("radius", radius)
            if radii.shape not in ((), (len(at),)):
                raise ArgumentError(f"radius: found shape {radii.shape}, expected a number or one for each of {len(at)} points")
            radii = np.require(np.broadcast_to(radii, len(at)), np.float64, ["C", "A"])
            while True:
                found = np.empty((2, room), np.uint32)
                check(self._lib.fp3_batch_within(c, key, at.ctypes.data, radii.ctypes.data, len(at), room, found[0].ctypes.data, found[1].ctypes.data,
                                                 ctypes.byref(count)), self._error)
                if count.value <= room:
                    return found[0, :count.value], found[1, :count.value]
                room = count.value

    def nearest(self, of: str, points: Any) -> Tuple["np.ndarray[Any, Any]", "np.ndarray[Any, Any]"]:
        """The number of the object that is nearest to each point, and its distance; NOBODY and infinity where nobody lives."""
        key = name_bytes("of", of)
        with self._c() as c:
            at = self._points(c, key, "points", points)
            objects, distances = np.empty(len(at), np.uint32), np.empty(len(at))
            check(self._lib.fp3_batch_nearest(c, key, at.ctypes.data, len(at), objects.ctypes.data, distances.ctypes.data), self._error)
        return objects, distances

    def ray(self, of: str, origins: Any, directions: Any, radius: Union[str, float] = 0.0,
            length: float = 0.0) -> Tuple["np.ndarray[Any, Any]", "np.ndarray[Any, Any]"]:
        """The number of the first object that each ray meets, and how far from its origin; NOBODY and infinity if it meets none.

        Objects are balls; radius: a number, or the name of a param or state. length: how far rays go; 0: without end.
        """
        key, rays = name_bytes("of", of), d.fp3_rays()
        rays.radius_of = name_bytes("radius", radius) if isinstance(radius, str) else None
        rays.radius = 0.0 if isinstance(radius, str) else as_number("radius", radius)
        rays.length = as_number("length", length)
        with self._c() as c:
            start, way = self._points(c, key, "origins", origins), self._points(c, key, "directions", directions)
            if len(start) != len(way):
                raise ArgumentError(f"directions: found {len(way)}, expected one for each of {len(start)} origins")
            rays.count, rays.origins, rays.directions = len(start), start.ctypes.data, way.ctypes.data
            objects, distances = np.empty(len(start), np.uint32), np.empty(len(start))
            check(self._lib.fp3_batch_ray(c, key, rays, objects.ctypes.data, distances.ctypes.data), self._error)
        return objects, distances

    def contacts(self, of: str, distance: float = 0.0) -> Contacts:
        """The contacts that began and ended since the last call with this `of`; at the first call all begin."""
        key, far, found = name_bytes("of", of), as_number("distance", distance), d.fp3_contacts()
        with self._c() as c:
            check(self._lib.fp3_batch_contacts(c, key, far, ctypes.byref(found)), self._error)
            return Contacts(*(np.array(np.ctypeslib.as_array(ctypes.cast(at, ctypes.POINTER(ctypes.c_uint64)), (count,))) if count else np.empty(0, np.uint64)
                              for at, count in ((found.began_a, found.began), (found.began_b, found.began), (found.ended_a, found.ended),
                                                (found.ended_b, found.ended))))

    def remembered(self, relation: str, field: str, a: Any, b: Any) -> "np.ndarray[Any, Any]":
        """What objects a remember of objects b, by their numbers, in a field of a relation of near objects; 0: nothing."""
        ends = [np.ascontiguousarray(np.atleast_1d(as_values(name, end)), np.uint32) for name, end in (("a", a), ("b", b))]
        if ends[0].ndim != 1 or ends[0].shape != ends[1].shape:
            raise ArgumentError(f"b: found shape {ends[1].shape}, expected a column like a, of shape {ends[0].shape}")
        values = np.empty(len(ends[0]), np.float32)
        with self._c() as c:
            check(self._lib.fp3_batch_remembered(c, name_bytes("relation", relation), name_bytes("field", field), ends[0].ctypes.data, ends[1].ctypes.data,
                                                 len(values), values.ctypes.data), self._error)
        return values

    def _points(self, c: Any, of: bytes, what: str, points: Any) -> "np.ndarray[Any, Any]":
        count, at = ctypes.c_uint32(), np.asarray(as_values(what, points), np.float64)
        check(self._lib.fp3_batch_dimensions(c, of, ctypes.byref(count)), self._error)
        at = at.reshape(1, -1) if at.ndim == 0 or (at.ndim == 1 and count.value > 1) else at.reshape(-1, 1) if at.ndim == 1 else at
        if at.ndim != 2 or at.shape[1] != count.value:
            raise ArgumentError(f"{what}: found shape {np.shape(points)}, expected {count.value} numbers for each point")
        return np.require(at, np.float64, ["C", "A"])

    # ---- steps ----

    def run(self, steps: int = 1, *, check_failures: bool = True) -> None:
        """All objects that live make this number of steps; with a tolerance, at most this number of attempts.

        FailedError: objects failed in these steps. The steps are made all the same, and values can be read. Who has made its
        attempts, and can go on to `until` in the next call, has not failed.
        """
        left, found, is_new = as_count("steps", steps, 0, STEPS_MOST), None, True
        with self._c():
            while left > 0 or is_new:
                now, begun = part_of(left, self._part), time.perf_counter()
                try:
                    self._run_part(now, is_new)
                finally:
                    self._show(*self._copies)
                self._part = next_part(self._part, now, time.perf_counter() - begun)
                left, is_new = left - now, False
                is_last = not left or (self._is_adaptive and self._is_over())
                if check_failures and steps and found is None and (is_last or not self._is_adaptive):
                    found = self.failure()
                if is_last:
                    break
            if found is not None:
                more = "at least " if now < steps and not self._is_adaptive else ""  # later parts may have others
                raise FailedError(f"{more}{found.failed} of {self.living} objects failed, first {found.text}")

    def _run_part(self, steps: int, is_new: bool) -> None:
        """A part of a run. is_new: its first one. Who chooses its steps and has reached the end sleeps on in the others."""
        with self._c() as c:
            if is_new or not self._is_adaptive:
                check(self._lib.fp3_batch_run(c, steps), self._error)
            else:
                check(self._lib.fp3_adaptive_run(self._lib.fp3_batch_engine(c), steps, None), self._error)

    def _is_over(self) -> bool:
        """Whether nobody goes on who chooses its steps: who can sleep does so where it ends or is stuck."""
        if self._lib.fp3_image_slept(self._program.c.image) >= 0:
            return bool(self.status()["slept"][self.handles != 0].all())
        return all(self._end(int(i)).end != d.FP3_ADAPTIVE_LIMITED for i in np.flatnonzero(self.handles))

    def _end(self, i: int) -> d.fp3_adaptive_object:
        found = d.fp3_adaptive_object()
        with self._c() as c:
            check(self._lib.fp3_adaptive_look(self._lib.fp3_batch_engine(c), i, found), self._error)
        return found

    def restart(self) -> None:
        """Goes back to the starts, at time 0. Params, h, links and who lives stay as they are."""
        with self._c() as c, _library.loading:
            check(self._lib.fp3_batch_restart(c), self._error)
            self._show(*self._copies)

    @property
    def time(self) -> float:
        """The time since the start. With a tolerance each object has its own: batch["t"]."""
        with self._c() as c:
            return float(self._lib.fp3_batch_time(c))

    @property
    def how(self) -> str:
        """How engine "fast" executes the program, as 'native x86-64-v4'; "" for other engines."""
        with self._c() as c:
            return str(self._lib.fp3_engine_how(self._lib.fp3_batch_engine(c)), "utf-8")

    def failure(self) -> Optional[Failure]:
        """How objects failed in the last step, or None."""
        with self._c() as c:
            found, text = d.fp3_failure(), ctypes.create_string_buffer(d.FP3_FAILURE_TEXT_SIZE)
            check(self._lib.fp3_batch_failure(c, found, text), self._error)
        return Failure(found.failed, found.object, found.step, text.value.decode()) if found.failed else None

    def _unfinished(self) -> Optional[Failure]:
        """Who chooses its steps and has not reached `until`: failed, or without an attempt left."""
        found, text = d.fp3_adaptive_report(), ctypes.create_string_buffer(d.FP3_ADAPTIVE_TEXT_SIZE)
        with self._c() as c:
            check(self._lib.fp3_adaptive_report_make(self._lib.fp3_batch_engine(c), 0, self._objects, found), self._error)
        if not found.failed:
            return None
        self._lib.fp3_adaptive_text(found.first, found.why, text)
        return Failure(found.failed, found.first, found.why.accepted, text.value.decode())

    def status(self) -> Dict[str, "np.ndarray[Any, Any]"]:
        """Of each object: flags (NV DZ OF UF NX in bits 4 to 0), the step in which it first failed and fell asleep; 0: it did not."""
        found = np.zeros((self._objects, 3), np.uint32)
        with self._c() as c:
            check(self._lib.fp3_engine_status(self._lib.fp3_batch_engine(c), 0, self._objects,
                                              ctypes.cast(found.ctypes.data, ctypes.POINTER(d.fp3_object_status))), self._error)
        return {"flags": found[:, 0], "failed": found[:, 1], "slept": found[:, 2]}

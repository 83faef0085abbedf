"""Scenes: groups of objects, each with a program and values of its own, from a file."""

from __future__ import annotations

import ctypes
import os
import time
from typing import Any, Callable, Iterable, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _declarations as d
from . import _library
from ._library import Handle, Owner, check, library, name_bytes
from .batch import PART_FIRST, STEPS_MOST, Failure, next_part, part_of, print_share
from .errors import ArgumentError, FailedError
from .given import as_count, as_mapping, as_number, as_teller


class Group:
    """Objects of a scene that run one program. group["x"] is a copy of a column."""

    __iter__ = None  # len() counts objects, and columns have names: there is no order to go through

    def __init__(self, scene: "Scene", number: int) -> None:
        c = scene._scene_c.groups[number]
        self._scene, self._program = scene, c.program
        self.path: str = os.fsdecode(c.path)
        self.first: int = c.first
        self.objects: int = c.objects
        symbols = c.program.contents.image.contents
        names = [symbols.symbols[i].name.decode() for i in range(symbols.symbol_count)
                 if symbols.symbols[i].symbol_class in (d.FP3_SYMBOL_STATE, d.FP3_SYMBOL_PARAM)]
        if c.program.contents.model:  # a word of another group has no value here
            model = c.program.contents.model.contents
            foreign = {model.params[i].name.decode() for kind in model.kinds[:model.kind_count] for i in range(kind.first, kind.first + kind.count)}
            names = [name for name in names if name not in foreign]
        self.names: Tuple[str, ...] = tuple(names)

    def __len__(self) -> int:
        return self.objects

    def __repr__(self) -> str:
        return f"fp3.Group({self.path}: {self.objects} objects, {', '.join(self.names)})"

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self.names

    def __getitem__(self, name: str) -> "np.ndarray[Any, Any]":
        name_bytes("name", name)
        if name not in self:
            raise ArgumentError(f"the program of this group has no '{name}', it has {', '.join(self.names)}")
        c, lib = self._program.contents, library()
        reg = lib.fp3_image_find(c.image, name.encode(), 1 << d.FP3_SYMBOL_STATE | 1 << d.FP3_SYMBOL_PARAM).contents.index
        high = self._scene._read(self.first, self.objects, reg)
        state = lib.fp3_model_state(c.model, name.encode()) if c.model else d.FP3_NONE
        low = lib.fp3_compiled_low(c.compiled, state) if state != d.FP3_NONE else -1
        return high if low < 0 else high.astype(np.float64) + self._scene._read(self.first, self.objects, low)


class Scene(Owner):
    """A scene file (docs/scenes.md): what `fp3 run --scene FILE` runs.

        scene = fp3.Scene("programs/mixed.scene", engine="fast")
        scene.run()
        scene.groups[0]["r_x"]

    config and engine replace what the file says. values: for the number of a group, values by name, as in its `set`.
    """

    _what = "scene"

    def __init__(self, path: Union[str, "os.PathLike[str]"], *, config: Optional[str] = None, engine: Optional[str] = None, threads: int = 0,
                 values: Optional[Mapping[int, Mapping[str, float]]] = None) -> None:
        self._own()
        pointer = ctypes.POINTER(d.fp3_scene)()
        check(self._lib.fp3_scene_open(name_bytes("path", path), None if config is None else name_bytes("config", config), pointer, self._error),
              self._error)
        self._scene = Handle(pointer, "fp3_scene_close")
        for number, given in as_mapping("values", values).items():
            group = self._scene_c.groups[as_count("values", number, 0, self._scene_c.group_count - 1)]
            for name, value in as_mapping(f"values: {number}", given).items():
                check(self._lib.fp3_params_put(group.params, name_bytes("values", name), as_number(name, value), self._error), self._error)
        self._definition = self._lib.default(d.fp3_engine_def)
        self._lib.fp3_scene_set_engine(pointer, self._definition)
        self._definition.error = ctypes.pointer(self._error)
        self._definition.threads = as_count("threads", threads, 0, 1024)
        if engine is not None:
            self._definition.engine = name_bytes("engine", engine)
        opened = ctypes.c_void_p()
        with _library.loading:
            check(self._lib.fp3_engine_open(self._definition, opened), self._error)
            self._handle = Handle(opened, "fp3_engine_close", self._scene, self._definition, self._error)
            check(self._lib.fp3_scene_load(pointer, opened, self._error), self._error)
        #: The groups, in the order of the file.
        self.groups: List[Group] = [Group(self, i) for i in range(self._scene_c.group_count)]
        self.steps: int = self._scene_c.steps
        self.objects: int = self._scene_c.objects
        # A program in assembly may do more in its first and last part than prepare: then a run is not the same in parts.
        self._goes_on = False  # the last run was of a number of attempts that the caller chose
        self._has_parts = all(self._scene_c.groups[i].program.contents.model for i in range(len(self.groups)))

    @property
    def _scene_c(self) -> Any:
        return self._scene.pointer.contents

    def __enter__(self) -> "Scene":
        return self

    def __repr__(self) -> str:
        return f"fp3.Scene({os.fsdecode(self._scene_c.path)}: {self.objects} objects in {len(self.groups)} groups)"

    def _read(self, first: int, count: int, reg: int) -> "np.ndarray[Any, Any]":
        values = np.empty(count, np.float32)
        with self._c() as engine:
            check(self._lib.fp3_engine_read(engine, first, count, reg, values.ctypes.data), self._error)
        return values

    def run(self, steps: Optional[int] = None, *, check_failures: bool = True,
            progress: Union[None, bool, Callable[[float], None]] = None) -> None:
        """Runs the scene's steps, or this number; with a tolerance these are attempts.

        FailedError: objects failed; all values can be read. After the scene's own attempts that includes the objects that have not
        reached `until`; after a number of yours they have not failed, and go on in the next call.
        """
        self._goes_on = steps is not None
        left = total = self.steps if steps is None else as_count("steps", steps, 0, STEPS_MOST)
        tell = as_teller(progress, print_share) or (lambda share: None)
        with self._c() as engine:  # counted from here; a configuration that keeps no status has nothing to clear
            self._lib.fp3_engine_clear_status(engine, 0, self.objects)
        part, first = PART_FIRST if self._has_parts and not self._is_mixed() else total, None
        while left > 0 and not (left < total and self._is_over()):
            now, begun = part_of(left, part), time.perf_counter()
            with self._c() as engine:
                check(self._lib.fp3_adaptive_run(engine, now, None), self._error)
                if check_failures and (not self._is_adaptive() or left == now or self._is_over()):
                    first = first or self.failure()
            part, left = next_part(part, now, time.perf_counter() - begun), left - now
            tell(1 - left / total)
        tell(1.0)
        if first is not None:
            failed = max(first.failed, int(np.count_nonzero(self._status()[:, 1])))  # in later parts, too
            raise FailedError(f"{failed} objects failed, first {first.text}")

    def _is_adaptive(self) -> bool:
        return any(self._adaptive(group) for group in self.groups)

    def _is_mixed(self) -> bool:
        """Steps that are chosen beside fixed ones, or where nobody can sleep: how far it is only the engine can say."""
        return self._is_adaptive() and not all(self._adaptive(group) and self._lib.fp3_image_slept(group._program.contents.image) >= 0 for group in self.groups)

    def _is_over(self) -> bool:
        """Whether all objects that choose their steps have ended, or are stuck: then they sleep."""
        if not self._is_adaptive() or self._is_mixed():
            return False
        return bool(self._status()[:, 2].all())

    def _status(self) -> "np.ndarray[Any, Any]":
        """A row of fp3_object_status for each object: flags, failed, slept."""
        found = np.zeros((self.objects, 3), np.uint32)
        with self._c() as engine:
            check(self._lib.fp3_engine_status(engine, 0, self.objects, ctypes.cast(found.ctypes.data, ctypes.POINTER(d.fp3_object_status))), self._error)
        return found

    def _adaptive(self, group: Group) -> bool:
        return bool(self._lib.fp3_adaptive_is(group._program.contents.image))

    def _not_ended(self, engine: Any, objects: Iterable[int]) -> List[Tuple[int, Any]]:
        """Which of the objects failed; while a run can go on, without those that have only made their attempts."""
        fine = {d.FP3_ADAPTIVE_ENDED, d.FP3_ADAPTIVE_STOPPED} | ({d.FP3_ADAPTIVE_LIMITED} if self._goes_on else set())
        found = []
        for number in objects:
            look = d.fp3_adaptive_object()
            check(self._lib.fp3_adaptive_look(engine, number, look), self._error)
            if look.end not in fine:
                found.append((number, look))
        return found

    def failure(self) -> Optional[Failure]:
        """How objects failed in the last run, or None: of the first group with such objects."""
        found, text = d.fp3_failure(), ctypes.create_string_buffer(d.FP3_ADAPTIVE_TEXT_SIZE)
        for group in self.groups:
            with self._c() as engine:
                if self._adaptive(group):
                    report = d.fp3_adaptive_report()
                    check(self._lib.fp3_adaptive_report_make(engine, group.first, group.objects, report), self._error)
                    if report.failed:
                        failed = self._not_ended(engine, range(report.first, group.first + group.objects))
                        if failed:
                            first, why = failed[0]
                            self._lib.fp3_adaptive_text(first, why, text)
                            return Failure(len(failed), first, why.accepted, text.value.decode())
                    continue
                check(self._lib.fp3_engine_failure(engine, group.first, group.objects, found), self._error)
                if found.failed:
                    self._lib.fp3_engine_failure_text(engine, found, text)
                    return Failure(found.failed, found.object, found.step, text.value.decode())
        return None

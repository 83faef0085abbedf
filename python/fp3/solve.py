"""Runs in the form of SciPy's solve_ivp, for one object or for many."""

from __future__ import annotations

import ctypes
import math
import time
import warnings
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _declarations as d
from ._library import check, library, name_bytes
from .batch import STEPS_MOST, Batch, Value, link_all, next_part, part_of, print_share
from .errors import ArgumentError, DigitsWarning, FailedWarning
from .given import as_count, as_flag, as_mapping, as_number, as_teller, as_values, ends_of, shown, split_links
from .loss import standstill
from .model import How, Model, Program, Source, as_model


class Solution(Dict[str, Any]):
    """What solve_ivp returns: SciPy's fields, and the name of a state gives its values.

    t: the times, of `y`'s last axis. y: (states, times), or (objects, states, times): each number is exactly the FP32 number
    of the run. success, status (0: all reached the end, 1: some were stopped by events, -1: some failed) and message.
    failed: of each object, whether it failed. nfev: right-hand sides of an object (an array if they differ), counted by the
    method's table. t_events, y_events: of each object that events stopped, when and where; None: the model stops none.
    steps: of each object. h: the time step; None: each object chose its own. how: what executed the run.
    """

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None

    def __missing__(self, name: str) -> Any:
        if name not in dict.__getitem__(self, "states"):
            raise KeyError(name)
        return self.state(name)

    def __contains__(self, name: object) -> bool:
        return dict.__contains__(self, name) or name in dict.get(self, "states", ())

    def get(self, name: str, default: Any = None) -> Any:
        """What solution[name] is, or the default."""
        return self[name] if name in self else default

    def state(self, name: str) -> "np.ndarray[Any, Any]":
        """The values of a state, also of one that is named like a field: `y`, `t`, `h`."""
        values: "np.ndarray[Any, Any]" = self["y"][..., self["states"].index(name), :]
        return values

    def __dir__(self) -> List[str]:
        return [*self, "state"]

    def __repr__(self) -> str:
        return f"fp3.Solution({self['message']} y: {self['y'].shape}, states {', '.join(self['states'])})"


def solve_ivp(model: Union[Model, Source], t_span: Sequence[float], y0: Union[None, Value, Sequence[Any], Mapping[str, Value]] = None, *,
              params: Optional[Mapping[str, Value]] = None, method: Optional[str] = None, h: Optional[float] = None,
              rtol: Optional[float] = None, atol: Optional[float] = None, max_step: Optional[float] = None,
              t_eval: Optional[Sequence[float]] = None, cut: Optional[bool] = None, objects: Optional[int] = None,
              links: Optional[Mapping[str, Tuple[Any, ...]]] = None, engine: str = "fast", arithmetic: str = "plain",
              config: Optional[str] = None, threads: int = 0, may_compile: bool = True, attempts: int = d.FP3_ADAPTIVE_ATTEMPTS,
              progress: Union[None, bool, Callable[[float], None]] = None) -> Solution:
    """Integrates a model from t_span[0] to t_span[1], for one object or for many.

    y0: starts, (states,) or (objects, states), or by name, a number or one for each object; None or a missing name: the
    model's. params: by name, likewise. objects: how many, if no array says so. links: of each relation, (a, b) or
    (a, b, fields).

    Without rtol steps are fixed, of length h (default: the model's) by `method` (default: rk4; fp3.integrators() has all).
    Where a time of t_eval or the end is no multiple of h, steps are cut there, as by `fp3 run --until`; cut=True does so
    anyway, so that events are met within steps, and cut=False refuses such times. With rtol each object chooses its steps
    (default method: cash_karp): rtol and atol are the command's `tolerance` and `absolute` (default: as rtol), max_step its
    `maxstep`, h the first step, and an object makes at most `attempts` from one time to the next.

    t_eval: times to return (default: the two ends of t_span). arithmetic: plain, compensated, folded or double-single.
    engine, config, threads: as of `fp3 run`. may_compile: whether engine "fast" may start a C compiler; its code is kept.
    progress: True, or a function of the share that is done.

    Where objects failed, success is False, `failed` says which, message says how, and there is a FailedWarning.
    Ctrl-C ends a run within a fraction of a second. See Solution for what is returned, docs/python.md for all else.
    """
    model = as_model(model)
    span = read_span(t_span)
    times = read_times(t_eval, span)
    starts, given = read_starts(model, y0), {name: as_values(f"'{name}'", value) for name, value in as_mapping("params", params).items()}
    count = count_objects({**starts, **given}, objects, links)
    check_params(model, given)
    clock = choose_clock(model, span, times, How(method, arithmetic, config), h, rtol, atol, max_step, cut)
    program = clock.program
    if program.warning:
        warnings.warn(f"{model.name}: {program.warning}", RuntimeWarning, stacklevel=2)
    batch = Batch.__new__(Batch)
    batch.model = model
    batch._open(program, count or 1, clock.h if not clock.chooses else None, engine, as_count("threads", threads, 0, 1024), may_compile, 0.0)
    with batch:
        link_all(batch, links)
        write_values(batch, starts, given)
        clock.begin(batch)
        run = Run(batch, clock, as_count("attempts", attempts, 1, STEPS_MOST), progress)
        solution = run.all()
        lost = run.lost(given)
    if lost:
        warnings.warn(lost, DigitsWarning, stacklevel=2)
    if count is None:
        first_of(solution)
    if not solution["success"]:
        warnings.warn(solution["message"], FailedWarning, stacklevel=2)
    return solution


# ---- what the caller gives ----


def read_span(t_span: Sequence[float]) -> Tuple[float, float]:
    pair = as_values("t_span", t_span, "two times").astype(np.float64)
    if pair.shape != (2,) or not np.isfinite(pair).all() or not pair[1] > pair[0]:
        raise ArgumentError(f"t_span: found {shown(t_span)}, expected two finite times, the second after the first")
    return float(pair[0]), float(pair[1])


def read_times(t_eval: Optional[Sequence[float]], span: Tuple[float, float]) -> "np.ndarray[Any, Any]":
    """A time outside of the span by less than FP32 can tell becomes the span's end: 7 * 0.1 of (0, 0.7). Two that become one do not ascend."""
    if t_eval is None:
        return np.array(span)
    times = as_values("t_eval", t_eval, "a list of times")
    if times.ndim != 1 or not times.size:
        raise ArgumentError(f"t_eval: found {times.dtype} of shape {times.shape}, expected a list of times")
    times, least = times.astype(np.float64), (span[1] - span[0]) * 2**-24
    kept: "np.ndarray[Any, Any]" = np.clip(times, *span)
    if not ((np.abs(times - kept) <= least).all() and (np.diff(kept) > 0).all()):
        raise ArgumentError(f"t_eval: expected times that ascend, from {span[0]:.9g} to {span[1]:.9g}")
    return kept


def read_starts(model: Model, y0: Any) -> Dict[str, Any]:
    if y0 is None:
        return {}
    if isinstance(y0, Mapping):
        for name in y0:
            if name not in model.states:
                raise ArgumentError(f"y0: the model has no state {name!r}, it has {', '.join(model.states)}")
        return {name: as_values(f"'{name}'", value) for name, value in y0.items()}
    array = as_values("y0", y0, f"({len(model.states)},) or (objects, {len(model.states)}) numbers: {', '.join(model.states)}")
    if array.ndim not in (1, 2) or array.shape[-1] != len(model.states):
        raise ArgumentError(f"y0: found {array.dtype} of shape {array.shape}, expected ({len(model.states)},) or "
                            f"(objects, {len(model.states)}) numbers: {', '.join(model.states)}")
    return {name: array[..., i] for i, name in enumerate(model.states)}


def count_objects(values: Mapping[str, Any], objects: Optional[int], links: Optional[Mapping[str, Tuple[Any, ...]]]) -> Optional[int]:
    """None: one object, and the result has no axis of objects."""
    counts = {} if objects is None else {"objects": as_count("objects", objects, 1, 2**32 - 1)}
    for name, value in values.items():
        shape = np.shape(value)
        if len(shape) > 1 or shape == (0,):
            raise ArgumentError(f"'{name}' has the shape {shape}, expected a number or one for each object")
        if shape:
            counts[name] = shape[0]
    if not counts and links:
        counts["links"] = max((int(end.max()) for of in split_links(links).values() for end in map(ends_of, "ab", of[:2]) if end.size), default=0) + 1
    if len(set(counts.values())) > 1:
        raise ArgumentError("the number of objects is not one: " + ", ".join(f"{name} has {n}" for name, n in counts.items()))
    return next(iter(counts.values()), None)


def check_params(model: Model, params: Mapping[str, Any]) -> None:
    own = {"h": "h=", "tolerance": "rtol=", "absolute": "atol=", "maxstep": "max_step=", "until": "t_span", "steps": "t_span", "t": "t_span"}
    for name in params:
        if name in model.states:
            raise ArgumentError(f"params: '{name}' is a state: it starts as y0 says")
        if name in own and name not in model.params:
            raise ArgumentError(f"params: '{name}' is given by {own[name]}")
        if name in model.shared and np.ndim(params[name]):
            raise ArgumentError(f"params: '{name}' is shared: it is one number for all objects")


# ---- time ----


class Clock:
    """Which program makes the steps, how it is told where to stop, and what time that is."""

    def __init__(self, program: Program, h: Optional[float], chooses: bool, is_cut: bool, offset: float, begin: float, marks: List[Any]) -> None:
        self.program, self.h, self.chooses, self.is_cut = program, h, chooses, is_cut
        self.offset, self.begin_at = offset, begin  # the model's time of the caller's 0; where objects start
        self.marks = marks  # numbers of steps, or times in FP32; the last one is the end
        self.times: List[float] = []

    def begin(self, batch: Batch) -> None:
        if self.begin_at and self.is_cut:
            batch["t"] = self.begin_at
        elif self.begin_at:
            batch["steps"] = self.begin_at


def steps_to(program: Program, h: float, at: float) -> Optional[int]:
    """How many steps there are to this time, by the rule of `fp3 run --times`; None: it is no multiple of h."""
    lib, error, params, steps = library(), d.fp3_error(), ctypes.c_void_p(), ctypes.c_uint64()
    check(lib.fp3_params_make(params, error), error)
    try:
        check(lib.fp3_params_put(params, b"h", h, error), error)
        status = lib.fp3_recording_steps(program.pointer, params, ctypes.byref(ctypes.c_double(at)), 1, ctypes.byref(steps), error)
    finally:
        lib.fp3_params_free(params)
    return steps.value if status == d.FP3_OK else None


def choose_clock(model: Model, span: Tuple[float, float], times: "np.ndarray[Any, Any]", how: How, h: Optional[float], rtol: Optional[float],
                 atol: Optional[float], max_step: Optional[float], cut: Optional[bool]) -> Clock:
    if h is not None and not 0 < (h := as_number("h", h)) < math.inf:
        raise ArgumentError(f"h: found {h}, expected a finite number above 0")
    if rtol is None and (atol is not None or max_step is not None):
        raise ArgumentError(f"{'atol' if atol is not None else 'max_step'}: steps are fixed without rtol")
    if rtol is not None and cut is not None:
        raise ArgumentError("cut: steps that are chosen (rtol) end at t_eval and at events anyway")
    if rtol is not None:
        return adaptive_clock(model, span, times, how, h, rtol, atol, max_step)
    h = model.step if h is None else h
    if cut is None or not as_flag("cut", cut):
        clock = fixed_clock(model, span, times, how, h)
        if clock is not None:
            return clock
        if cut is not None:
            raise ArgumentError(f"cut=False: a time of t_span or t_eval is no multiple of h = {h:.9g}")
    return until_clock(model, span, times, how._replace(adaptive=(0.0, 0.0, until_of(model, span), 0.0)), h, False)


def offset_of(model: Model, span: Tuple[float, float]) -> float:
    """Where nothing depends on t, objects start at 0, which has the most digits."""
    return 0.0 if model.uses_time else span[0]


def until_of(model: Model, span: Tuple[float, float]) -> float:
    return span[1] - offset_of(model, span)


def fixed_clock(model: Model, span: Tuple[float, float], times: "np.ndarray[Any, Any]", how: How, h: float) -> Optional[Clock]:
    if (span[1] - span[0]) / h > STEPS_MOST:
        raise ArgumentError(f"t_span: {(span[1] - span[0]) / h:.3g} steps of h = {h:.9g}, expected at most {STEPS_MOST}")
    program = model.program(how)
    begin = 0
    if model.uses_time and span[0]:
        found = steps_to(program, h, abs(span[0]))
        if found is None:
            return None
        begin = found if span[0] > 0 else -found
    found_marks = [steps_to(program, h, at - span[0]) for at in (*times, span[1])]
    marks = [mark for mark in found_marks if mark is not None]
    if len(marks) < len(found_marks) or (np.diff(marks[:-1]) <= 0).any():
        return None
    if library().fp3_image_steps(program.c.image) >= 0 and abs(begin) + marks[-1] > d.FP3_STEPS_LIMIT:
        raise ArgumentError(f"t_span: {abs(begin) + marks[-1]} steps, and a model with t counts at most {d.FP3_STEPS_LIMIT}: a longer h, or rtol")
    clock = Clock(program, h, False, False, 0.0, begin, marks)
    step = rounded(h, how.arithmetic)
    clock.times = [span[0] + n * step for n in marks[:-1]]
    return clock


def rounded(h: float, arithmetic: str) -> float:
    """h as the program has it."""
    high = np.float32(h)
    return float(high) + (float(np.float32(h - float(high))) if arithmetic.replace("-", "_") == "double_single" else 0.0)


def adaptive_clock(model: Model, span: Tuple[float, float], times: "np.ndarray[Any, Any]", how: How, h: Optional[float], rtol: float,
                   atol: Optional[float], max_step: Optional[float]) -> Clock:
    numbers = []
    for name, value in (("rtol", rtol), ("atol", atol), ("max_step", max_step)):
        number = 0.0 if value is None else as_number(name, value)
        is_endless = name == "max_step" and number == math.inf
        if value is not None and not (0 < number < math.inf or is_endless):
            raise ArgumentError(f"{name}: found {value}, expected a finite number above 0")
        numbers.append(0.0 if is_endless else number)
    return until_clock(model, span, times, how._replace(adaptive=(numbers[0], numbers[1], until_of(model, span), numbers[2])), h, True)


def until_clock(model: Model, span: Tuple[float, float], times: "np.ndarray[Any, Any]", how: How, h: Optional[float], chooses: bool) -> Clock:
    offset = offset_of(model, span)
    marks = [float(np.float32(at - offset)) for at in (*times, span[1])]
    begin = span[0] - offset
    if not np.isfinite(marks).all():
        raise ArgumentError(f"t_span: {span[1]:.9g} is out of the range of FP32")
    if (np.diff(marks[:-1]) <= 0).any() or marks[-1] <= float(np.float32(begin)):
        raise ArgumentError("t_eval: two times are the same FP32 number")
    clock = Clock(model.program(how), h, chooses, True, offset, begin, marks)
    clock.times = [mark + offset for mark in marks[:-1]]
    return clock


# ---- values ----


def write_values(batch: Batch, starts: Dict[str, Any], params: Dict[str, Any]) -> None:
    for name, value in {**params, **starts}.items():
        batch[name] = value


# ---- the run ----


class Run:
    def __init__(self, batch: Batch, clock: Clock, attempts: int, progress: Union[None, bool, Callable[[float], None]]) -> None:
        self.batch, self.clock, self.attempts = batch, clock, attempts
        self.lib = library()
        self.model, self.objects = batch.model, len(batch)
        self.tell = as_teller(progress, print_share)
        self.first: Optional[str] = None  # the first failure, in words
        self.failed = np.zeros(self.objects, bool)
        self.y = np.empty((len(clock.marks) - 1, len(self.model.states), self.objects))
        self.names = (ctypes.c_char_p * len(self.model.states))(*(name.encode() for name in self.model.states))

    def all(self) -> Solution:
        if self.clock.h is not None and self.clock.chooses:
            self.batch["h_next"] = self.clock.h
        begin = float(np.float32(self.clock.begin_at)) if self.clock.is_cut else 0
        at, last = begin, self.clock.marks[-1]
        for i, mark in enumerate(self.clock.marks):
            if mark > at:
                self.to(at, mark, begin, last)
            at = mark
            if i < len(self.y):
                self.look(i)
        self.share(1.0)
        return self.solution()

    def share(self, share: float) -> None:
        if self.tell:
            self.tell(min(share, 1.0))

    def to(self, at: Any, mark: Any, begin: Any, last: Any) -> None:
        """Goes on to a mark, in parts that take a fraction of a second each, so that Ctrl-C is heard. Parts change no bit."""
        if self.clock.is_cut:
            self.batch["until"] = mark
        left = self.attempts if self.clock.is_cut else mark - at
        is_new = True
        while left > 0:
            steps, begun = part_of(left, self.batch._part), time.perf_counter()
            self.batch._run_part(steps, is_new)
            seconds = time.perf_counter() - begun
            left, is_new = left - steps, False
            self.batch._part = next_part(self.batch._part, steps, seconds)
            if self.clock.is_cut and self.batch._is_over():
                break
            if not self.clock.is_cut:
                self.note_failure()
                self.share((mark - left - begin) / last)
            elif self.tell:
                self.share(float((np.minimum(self.time(), mark) - begin).mean()) / (last - begin))
        if self.clock.is_cut:
            self.note_ends(mark)
            self.share((mark - begin) / (last - begin))

    def time(self) -> "np.ndarray[Any, Any]":
        """Of each object, the sum of its two words."""
        return self.batch.read("t", out=np.empty(self.objects))

    def has_stopped(self) -> "np.ndarray[Any, Any]":
        """Whether an event has stopped it: then its next step is -0."""
        step = self.batch.read("h_next")
        stopped: "np.ndarray[Any, Any]" = (step == 0) & np.signbit(step)
        return stopped

    def look(self, i: int) -> None:
        pointers = (ctypes.c_void_p * len(self.names))(*(row.ctypes.data for row in self.y[i]))
        with self.batch._c() as c:
            check(self.lib.fp3_batch_read_double(c, self.names, len(self.names), 0, self.objects, pointers), self.batch._error)

    # ---- failures ----

    def note(self, found: Any) -> None:
        if self.first is None and found is not None:
            self.first = found.text

    def note_failure(self) -> None:
        found = self.batch.failure()
        if found is None:
            return
        self.note(found)
        self.failed |= self.batch.status()["failed"] != 0
        self.note_lost()
        self.failed[found.object] = True

    def note_ends(self, mark: float) -> None:
        found = self.batch._unfinished()
        if found is None:
            return
        self.note(found)
        self.failed |= (self.time() < mark) & ~self.has_stopped()
        self.note_lost()
        self.failed[found.object] = True

    def note_lost(self) -> None:
        """Whose states are not finite."""
        for name in self.model.states:
            self.failed |= ~np.isfinite(self.batch.read(name))

    # ---- the result ----

    def lost(self, params: Mapping[str, Any]) -> Optional[str]:
        """The command's warning of a state that stands still; of fixed steps in plain arithmetic, as there."""
        clock = self.clock
        if clock.is_cut or clock.h is None or clock.program.c.compiled.contents.arithmetic != d.FP3_PLAIN:
            return None
        t = (clock.begin_at + clock.marks[-1]) * float(np.float32(clock.h))
        return standstill(self.model, [self.batch.read(name, 0, min(self.objects, 1024)) for name in self.model.states], params, clock.h, clock.marks[-1], t)

    def counts(self) -> Tuple["np.ndarray[Any, Any]", "np.ndarray[Any, Any]"]:
        if self.clock.is_cut:
            return self.batch.read("accepted").astype(np.int64), self.batch.read("rejected").astype(np.int64)
        return np.full(self.objects, self.clock.marks[-1]), np.zeros(self.objects, np.int64)

    def events(self) -> Tuple[Any, Any]:
        """When and where events stopped objects."""
        c = self.model._c
        if not self.clock.is_cut or not any(c.events[i].stops for i in range(c.event_count)):
            return None, None
        states = np.stack([self.batch.read(name) for name in self.model.states], axis=1)
        at, has_stopped = self.time() + self.clock.offset, self.has_stopped()
        return ([[at[i:i + 1] if has_stopped[i] else np.empty(0)] for i in range(self.objects)],
                [[states[i:i + 1].astype(np.float64) if has_stopped[i] else np.empty((0, states.shape[1]))] for i in range(self.objects)])

    def solution(self) -> Solution:
        accepted, rejected = self.counts()
        t_events, y_events = self.events()
        stopped = sum(of[0].size for of in t_events) if t_events else 0
        failed = int(self.failed.sum())
        message = (f"{failed} of {self.objects} objects failed, first {self.first}" if failed else
                   f"{stopped} of {self.objects} objects were stopped by an event." if stopped else "All objects reached the end of t_span.")
        return Solution(t=np.array(self.clock.times), y=self.y.transpose(2, 1, 0), sol=None, t_events=t_events, y_events=y_events,
                        nfev=self.clock.program.evaluations() * (accepted + rejected), njev=0, nlu=0,
                        status=-1 if failed else 1 if stopped else 0, message=message, success=not failed, failed=self.failed,
                        states=self.model.states, steps=accepted, rejected=rejected, h=None if self.clock.chooses else self.clock.h,
                        how=self.batch.how or "")


def first_of(solution: Solution) -> None:
    """One object has no axis of objects."""
    for name in ("y", "t_events", "y_events"):
        if solution[name] is not None:
            solution[name] = solution[name][0]
    for name in ("nfev", "steps", "rejected"):
        solution[name] = int(solution[name][0])

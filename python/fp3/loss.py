"""What FP32 loses in a run without a flag that tells: states that stand still, as `fp3 run` tells them (docs/command.md)."""

from __future__ import annotations

import ctypes
from typing import Any, List, Mapping, Optional

import numpy as np

from . import _declarations as d
from ._library import library
from .model import Model

LOOKED = 1024  # objects, the first: a warning costs little, however many there are
BOUND = 1e-3   # of a state's size, that the steps of the run would have changed it by


def params_of(model: Model, given: Mapping[str, Any], count: int, is_wide: bool) -> "np.ndarray[Any, Any]":
    """A row of params for each object, as the program has them: rounded to FP32, or to two words."""
    table = np.empty((count, len(model.params)))
    for i, name in enumerate(model.params):
        value = np.asarray(given.get(name, model.defaults[name]), np.float64)
        value = value[:count] if value.ndim else value
        high = value.astype(np.float32).astype(np.float64)
        table[:, i] = high + (value - high).astype(np.float32) if is_wide else high
    return table


def standstill(model: Model, ends: List["np.ndarray[Any, Any]"], params: Mapping[str, Any], h: float, steps: int, t: float) -> Optional[str]:
    """Of the first object with a state that its steps are too small to change. ends: a column for each state."""
    c, look, handle = model._c, library().fp3_model_standstill, model._handle.pointer
    states = np.ascontiguousarray(np.stack([column[:LOOKED] for column in ends], axis=1), np.float64)
    table = params_of(model, params, len(states), False)
    room, text = np.empty(2 * c.expr_count + c.state_count), ctypes.create_string_buffer(d.FP3_STANDSTILL_TEXT_SIZE)
    point = d.fp3_point(states.ctypes.data, table.ctypes.data, None, t)
    span, address = steps * float(np.float32(h)), room.ctypes.data
    for n in range(len(states)):
        if look(handle, point, h, span, BOUND, address, text):
            return f"object {n}: {text.value.decode()}; use arithmetic='compensated' or a longer step"
        point.states += states.strides[0]
        point.params = (point.params or 0) + table.strides[0]
    return None

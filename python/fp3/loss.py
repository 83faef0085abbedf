"""What FP32 loses in a run without a flag that tells: the rule of `fp3 run` for states that stand still (docs/command.md).

The command's rule is in the command, over values that a batch does not have, so it is stated here once more;
tests/python compares what the two say.
"""

from __future__ import annotations

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


def slopes_of(model: Model, states: "np.ndarray[Any, Any]", params: "np.ndarray[Any, Any]", t: float) -> "np.ndarray[Any, Any]":
    """Derivatives in double, of objects in rows."""
    c, evaluate, handle = model._c, library().fp3_model_evaluate, model._handle.pointer
    values = np.empty((len(states), c.expr_count))
    point = d.fp3_point(states.ctypes.data, params.ctypes.data, None, t)
    address = values.ctypes.data
    for n in range(len(states)):
        evaluate(handle, point, address + n * values.strides[0])
        point.states += states.strides[0]
        point.params = (point.params or 0) + params.strides[0]
    of = np.array([c.states[i].derivative for i in range(c.state_count)])
    return np.where(of == d.FP3_NONE, 0.0, values[:, np.minimum(of, c.expr_count - 1)])


def standstill(model: Model, ends: List["np.ndarray[Any, Any]"], params: Mapping[str, Any], h: float, steps: int, t: float) -> Optional[str]:
    """Of the first object with a state that its steps are too small to change. ends: a column for each state."""
    h32 = float(np.float32(h))
    states = np.ascontiguousarray(np.stack([column[:LOOKED] for column in ends], axis=1), np.float64)
    table = params_of(model, params, len(states), False)
    with np.errstate(all="ignore"):
        slope = slopes_of(model, states, table, t)
        step = slope * h32
        stays = (step != 0) & np.isfinite(states) & ((states + step.astype(np.float32)).astype(np.float32) == states)
        stays &= np.abs(slope * steps * h32) > BOUND * np.abs(states)
    for n, i in np.argwhere(stays):
        moved = states[n:n + 1].copy()
        moved[0, i] += slope[n, i] * steps * h32
        if slopes_of(model, moved, table[n:n + 1], t)[0, i] * slope[n, i] > 0:  # at an equilibrium it would turn
            x = np.float32(states[n, i])
            return (f"object {n}: {model.states[i]} stands still: a step adds {step[n, i]:.2g}, and FP32 rounds {model.states[i]} = {x:.6g} by up to "
                    f"{float(np.spacing(np.abs(x))) / 2:.2g}; use arithmetic='compensated' or a longer step")
    return None

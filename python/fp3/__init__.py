"""FP3 from Python: models, runs in the form of SciPy's solve_ivp, batches for step loops, rigid bodies, scenes, tables of
measurements.

    import fp3
    solution = fp3.solve_ivp("kepler.ode", (0, 12.5), t_eval=[2.5, 12.5])
    solution.y                       # (states, times), or (objects, states, times)

All words are those of the command `fp3`, and so are all bits. docs/python.md is an introduction.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, List

if TYPE_CHECKING:
    from .batch import NOBODY, Batch, Column, Contacts, Failure
    from .bodies import Bodies, BodiesState, Shape, box, capsule, circle, hull, plane, polygon, sphere
    from .errors import (ArgumentError, DigitsWarning, Error, FailedError, FailedWarning, LimitError, MismatchError, ProgramError,
                         SystemFailure)
    from .model import Model, integrators
    from .scene import Scene
    from .solve import Solution, solve_ivp
    from .tables import Table, Tuning, bench, stress, tune

_MODULES = {
    "batch": ("NOBODY", "Batch", "Column", "Contacts", "Failure"),
    "bodies": ("Bodies", "BodiesState", "Shape", "box", "capsule", "circle", "hull", "plane", "polygon", "sphere"),
    "errors": ("ArgumentError", "DigitsWarning", "Error", "FailedError", "FailedWarning", "LimitError", "MismatchError", "ProgramError", "SystemFailure"),
    "model": ("Model", "integrators"),
    "scene": ("Scene",),
    "solve": ("Solution", "solve_ivp"),
    "tables": ("Table", "Tuning", "bench", "stress", "tune"),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}
__all__ = sorted([*_HOME, "__version__"])


def __getattr__(name: str) -> Any:
    """Loads a part, and NumPy and the library with it, when it is first used: `import fp3` itself costs milliseconds."""
    if name == "__version__":
        from ._declarations import VERSION
        return VERSION
    if name not in _HOME:
        raise AttributeError(f"module 'fp3' has no attribute {name!r}")
    value = getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> List[str]:
    return __all__

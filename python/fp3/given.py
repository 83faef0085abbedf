"""What callers give, as the library takes it. Whatever else they give is refused before the library sees it.

A value may run code of the caller when it is read: `__float__`, `__index__`, `__array__`. So a call reads all of its
arguments here before it takes a batch or a scene in hand: that code may close it.
"""

from __future__ import annotations

import ctypes
import operator
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _declarations as d
from ._library import name_bytes
from .errors import ArgumentError

_NO_NUMBERS = (bool, np.bool_, str, bytes)  # though float() takes them
_SHOWN = 80  # characters of a value in a message


def shown(value: Any) -> str:
    """A value in a message, on one line. Python does not print integers of thousands of digits."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:
        text = f"a large {type(value).__name__}"
    return text if len(text) <= _SHOWN else text[:_SHOWN - 3] + "..."


def check_mask(what: str, value: Any) -> None:
    """A mask says that a number is none; the library has no word for that."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise ArgumentError(f"{what}: found masked values, expected a number everywhere")


def as_values(what: str, value: Any, expected: str = "a number") -> "np.ndarray[Any, Any]":
    """A number (of no axis) or an array of numbers. Text that looks like a number is none, and neither is a bool."""
    check_mask(what, value)
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O" and not array.ndim and not isinstance(array.item(), _NO_NUMBERS):
            array = np.asarray(float(array.item()))  # a Fraction, an int beyond 64 bits
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"{what}: found {shown(value)}, expected {expected}") from None
    if array.dtype.kind not in "fiu":
        found = f"{array.dtype} of shape {array.shape}" if array.ndim else shown(value)
        raise ArgumentError(f"{what}: found {found}, expected {expected}")
    return array


def as_number(what: str, value: Any) -> float:
    array = as_values(what, value)
    if array.ndim:
        raise ArgumentError(f"{what}: found an array of shape {array.shape}, expected a number")
    return float(array)


def as_count(what: str, value: Any, least: int, most: int) -> int:
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise ArgumentError(f"{what}: found {shown(value)}, expected a whole number") from None
    if not least <= number <= most:
        raise ArgumentError(f"{what}: found {shown(number)}, expected {least} to {most}")
    return number


def as_flag(what: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise ArgumentError(f"{what}: found {shown(value)}, expected True or False")
    return bool(value)


def as_mapping(what: str, value: Optional[Mapping[Any, Any]]) -> Dict[Any, Any]:
    if value is not None and not isinstance(value, Mapping):
        raise ArgumentError(f"{what}: found {shown(value)}, expected a dict")
    return dict(value or {})


def as_teller(progress: Union[None, bool, Callable[[float], None]], default: Callable[[float], None]) -> Optional[Callable[[float], None]]:
    """Who is told the share that is done. default: what True means."""
    if progress is None or progress is False:
        return None
    if progress is True:
        return default
    if not callable(progress):
        raise ArgumentError(f"progress: found {shown(progress)}, expected True or a function")
    return progress


def handles_of(handles: Any) -> "np.ndarray[Any, Any]":
    """A column of what Batch.add or Bodies.add gave."""
    check_mask("handles", handles)
    try:
        column = np.asarray(handles)
    except ValueError:
        raise ArgumentError(f"handles: found {shown(handles)}, expected a column of handles as add gives them") from None
    if column.ndim > 1 or (column.size and column.dtype.kind not in "iu") or (column.size and column.min() < 0):
        raise ArgumentError(f"handles: found {column.dtype} of shape {column.shape}, expected a column of handles as add gives them")
    return np.ascontiguousarray(np.atleast_1d(column), np.uint64)


# ---- links ----


def ends_of(what: str, objects: Any) -> "np.ndarray[Any, Any]":
    """The numbers of objects at one end of each link."""
    column = as_values(f"links: '{what}'", objects, "whole numbers, one for each link")
    if column.ndim != 1 or (column.size and column.dtype.kind == "f"):  # an empty list has no kind
        raise ArgumentError(f"links: '{what}' is of {column.dtype} and shape {column.shape}, expected whole numbers, one for each link")
    if column.size and (column.min() < 0 or column.max() >= 2**32 - 1):
        raise ArgumentError(f"links: '{what}' has {column.min() if column.min() < 0 else column.max()}, expected numbers of objects")
    return np.ascontiguousarray(column, np.uint32)


def links_of(a: Any, b: Any, fields: Mapping[str, Any], keep: List[Any]) -> d.fp3_links:
    """Links as the library takes them; `keep` gets the arrays."""
    ends = [ends_of("a", a), ends_of("b", b)]
    if len(ends[0]) != len(ends[1]):
        raise ArgumentError(f"links: 'a' has {len(ends[0])} and 'b' {len(ends[1])} numbers, expected one of each for each link")
    columns = []
    for name, given in fields.items():
        values = as_values(f"links: '{name}'", given)
        if values.shape not in ((), ends[0].shape):
            raise ArgumentError(f"links: '{name}' has the shape {values.shape}, expected a number or one for each of {len(ends[0])} links")
        columns.append(np.ascontiguousarray(np.broadcast_to(values.astype(np.float64), ends[0].shape)))
    names = (ctypes.c_char_p * len(fields))(*(name_bytes("links", name) for name in fields))
    pointers = (ctypes.c_void_p * len(fields))(*(column.ctypes.data for column in columns))
    keep += [*ends, *columns, names, pointers]
    return d.fp3_links(len(ends[0]), ends[0].ctypes.data, ends[1].ctypes.data, names, pointers, len(fields))


def split_links(links: Optional[Mapping[str, Any]]) -> Dict[str, Tuple[Any, Any, Mapping[str, Any]]]:
    """Of each relation: a, b and fields."""
    found = {}
    for name, of in as_mapping("links", links).items():
        if not isinstance(of, (tuple, list)) or len(of) not in (2, 3) or (len(of) == 3 and not isinstance(of[2], Mapping)):
            raise ArgumentError(f"links: '{name}' is {type(of).__name__}, expected (a, b) or (a, b, fields)")
        found[name] = (of[0], of[1], of[2] if len(of) == 3 else {})
    return found

"""Finds the shared library and the command, and calls the library's functions by their declarations."""

from __future__ import annotations

import contextlib
import ctypes
import os
import pathlib
import threading
import weakref
from typing import Any, Iterator, NoReturn, Optional

from . import _declarations as d
from . import errors

_KINDS = {d.FP3_E_ARGUMENT: errors.ArgumentError, d.FP3_E_PROGRAM: errors.ProgramError, d.FP3_E_LIMIT: errors.LimitError,
          d.FP3_E_SYSTEM: errors.SystemFailure, d.FP3_E_MISMATCH: errors.MismatchError, d.FP3_E_FAILED: errors.FailedError}
_HERE = pathlib.Path(__file__).resolve().parent
_LIBRARY = "libfp3.so.0"


def home() -> pathlib.Path:
    """The directory with bin/fp3 and lib/libfp3.so.0: of FP3_HOME, of the wheel, or of the build beside the sources."""
    chosen = os.environ.get("FP3_HOME")
    places = [pathlib.Path(chosen)] if chosen else [_HERE / "_native", _HERE.parents[1] / "build"]
    for place in places:
        if (place / "lib" / _LIBRARY).exists():
            return place
    raise ImportError(f"no {_LIBRARY}; looked in {', '.join(str(place / 'lib') for place in places)} "
                      "(FP3_HOME names another directory, with lib/ and bin/ in it; in the sources, make all builds it)")


class _Library:
    """Its attributes are the functions; each is declared when it is first used."""

    def __init__(self) -> None:
        path = home() / "lib" / _LIBRARY
        try:
            self._cdll = ctypes.CDLL(str(path))
        except OSError as why:
            raise ImportError(f"{path}: {why} (it needs libconfig and zlib of this machine)") from why
        self.free = ctypes.CDLL(None).free
        self.free.argtypes, self.free.restype = [ctypes.c_void_p], None
        version = self._declared("fp3_version")(None).decode()
        if version != d.VERSION or not self.default(d.fp3_batch_def).objects:  # another size: the library leaves it empty
            raise ImportError(f"{self._cdll._name} is of version {version}, this package is of {d.VERSION}: "
                              "both must come from one build")

    def default(self, kind: Any) -> Any:
        """A definition with its defaults. ctypes cannot call fp3_NAME_default(), which is inline: this does what it does."""
        made = kind()
        getattr(self, kind.__name__.replace("_def", "_set_default"))(made, ctypes.sizeof(made))
        return made

    def _declared(self, name: str) -> Any:
        function = getattr(self._cdll, name)
        function.restype, function.argtypes = d.PROTOTYPES[name]
        return function

    def __getattr__(self, name: str) -> Any:
        if name not in d.PROTOTYPES:
            raise AttributeError(name)
        function = self._declared(name)
        setattr(self, name, function)
        return function


class _Loading:
    """Around calls that load code, or take it away. A fork waits for those of other threads: the linker's lock, which such a thread
    holds, would never be free in the child."""

    def __init__(self) -> None:
        self._changed, self._inside, self._own = threading.Condition(), 0, threading.local()

    def _mine(self) -> int:
        return int(getattr(self._own, "inside", 0))

    def _add(self, count: int) -> None:
        with self._changed:
            self._inside += count
            self._own.inside = self._mine() + count
            self._changed.notify_all()

    def __enter__(self) -> None:
        self._add(1)

    def __exit__(self, *of: Any) -> None:
        self._add(-1)

    def hold(self) -> None:
        """Before a fork. A thread that Ctrl-C has stopped on its way in is counted for ever: so the wait ends."""
        self._changed.acquire()
        self._changed.wait_for(lambda: self._inside <= self._mine(), FORK_SECONDS)

    def let_go(self) -> None:
        self._changed.release()


FORK_SECONDS = 60  # a C compiler may be at work for some of them
loading = _Loading()
_lock = threading.Lock()
_loaded: Optional[_Library] = None


def _renew() -> None:
    """In the child of a fork: a thread that held these is not there to let go of them."""
    global loading, _lock
    loading, _lock = _Loading(), threading.Lock()


os.register_at_fork(before=lambda: loading.hold(), after_in_parent=lambda: loading.let_go(), after_in_child=_renew)


def library() -> _Library:
    """The library, loaded when it is first needed."""
    global _loaded
    if _loaded is None:
        with _lock, loading:
            _loaded = _loaded or _Library()
    return _loaded


def check(status: int, error: d.fp3_error, report: Optional[ctypes.c_char_p] = None) -> None:
    """Raises what a call has said, with all mistakes of a model if there is a report, which is freed."""
    text = ""
    if report is not None and report.value is not None:
        text = report.value.decode(errors="replace")
        library().free(ctypes.cast(report, ctypes.c_void_p))
    if status == d.FP3_OK:
        return
    message = error.text.decode(errors="replace") or "fp3: no reason is known"
    file = error.text[:error.path_size].decode(errors="replace") if error.path_size else None
    raise _KINDS.get(status, errors.Error)(message, file=file, line=error.line or None, column=error.column or None, report=text)


def name_bytes(what: str, value: object) -> bytes:
    """A name or a path for the library."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{what}: found {value!r}, expected a string")
    try:
        encoded = os.fsencode(value)
    except UnicodeEncodeError:
        raise errors.ArgumentError(f"{what}: found {value!r}, which no file can be called") from None
    if b"\0" in encoded:
        raise errors.ArgumentError(f"{what}: found {value!r}, a name has no NUL")
    return encoded


class Handle:
    """A C object: freed once, when nothing refers to it, in the process that made it.

    A child of a fork must not free it: the threads of engine "fast" are not there to be joined.
    """

    def __init__(self, pointer: Any, close: str, *keep: Any) -> None:
        self.pointer, self.keep, self.pid = pointer, keep, os.getpid()
        self._free = weakref.finalize(self, _free, getattr(library(), close), pointer, self.pid, keep)
        self._free.atexit = False

    def __reduce__(self) -> NoReturn:
        raise TypeError("what the library has opened cannot be pickled or copied")


def _free(close: Any, pointer: Any, pid: int, keep: Any) -> None:
    if os.getpid() == pid:
        with loading:
            close(ctypes.byref(pointer))


class Owner:
    """What has a C object that is used by one thread at a time, until it is closed, in the process that opened it."""

    _what = ""  # in messages

    def _own(self) -> None:
        """To be called first. The C object follows, in _handle."""
        self._lock, self._error, self._lib, self._pid = threading.RLock(), d.fp3_error(), library(), os.getpid()
        self._handle: Optional[Handle] = None

    def close(self) -> None:
        """Frees it, after the call that uses it now. What a column shows stays as it is."""
        if os.getpid() != self._pid:  # a thread of the parent may have held the lock when it forked
            self._handle = None
            return
        with self._lock:
            self._handle = None

    def __exit__(self, *of: Any) -> None:
        self.close()

    def __reduce__(self) -> NoReturn:
        raise TypeError(f"a {self._what} cannot be pickled or copied: open another one, and give it the values of this one")

    @contextlib.contextmanager
    def _c(self) -> Iterator[Any]:
        """The C object, for one thread at a time. Arguments are read before: they may run code of the caller."""
        if os.getpid() != self._pid:  # before the lock, as in close
            raise errors.ArgumentError(f"this {self._what} was opened by the process that forked this one: open another one here")
        with self._lock:
            handle = self._handle  # kept here: a signal handler may close it at any time, and then the call goes on with it
            if handle is None:
                raise errors.ArgumentError(f"this {self._what} is closed")
            yield handle.pointer

"""What goes wrong, as exceptions. Each has the line that the command prints, and the place in a file if there is one."""

from __future__ import annotations

from typing import Any, Optional, Tuple, Type


class Error(Exception):
    """Any failure of fp3.

    text is one line. file, line and column say where the mistake is (None: unknown; they count from 1). report shows every
    mistake of a model with its line and a caret; it is "" for other failures.
    """

    def __init__(self, text: str, *, file: Optional[str] = None, line: Optional[int] = None, column: Optional[int] = None,
                 report: str = "") -> None:
        super().__init__(report.rstrip("\n") or text)
        self.text, self.file, self.line, self.column, self.report = text, file, line, column, report

    def __reduce__(self) -> Tuple[Any, ...]:
        return _again, (type(self), self.text, self.file, self.line, self.column, self.report)


def _again(kind: Type[Error], text: str, file: Optional[str], line: Optional[int], column: Optional[int], report: str) -> Error:
    return kind(text, file=file, line=line, column=column, report=report)


class ArgumentError(Error, ValueError):
    """The caller asks for something impossible: a name, a value, a shape."""


class ProgramError(Error, ValueError):
    """A model, a scene or a program is wrong, or does not fit the configuration."""


class LimitError(Error, RuntimeError):
    """A run was stopped at a limit that the caller set."""


class SystemFailure(Error, RuntimeError):
    """Memory, a file or a device failed."""


class MismatchError(Error, RuntimeError):
    """Two results that must agree differ."""


class FailedError(Error, ArithmeticError):
    """Objects failed in a run: an overflow, an invalid operation, or a state that is not finite. All values can be read."""


class DigitsWarning(RuntimeWarning):
    """FP32 has too few digits for a run, and no flag tells: a state stands still."""


class FailedWarning(RuntimeWarning):
    """The same, of a result that says so itself: fp3.solve_ivp."""

"""Bugs put into the source on purpose: a test that does not see them would show nothing."""

import shutil
from typing import NamedTuple

import pytest


def few(rows, kind=lambda row: None):
    """Params of a test of seeded bugs, each a name and values: the first of each kind runs always, the others with --long.
    That each bug still applies to the source, tests/lint/test_bugs.py sees always."""
    seen = set()
    for name, *values in rows:
        marks = [pytest.mark.long] if kind(values) in seen else []
        seen.add(kind(values))
        yield pytest.param(*values, id=name, marks=marks)


class Bug(NamedTuple):
    """A change of one place in a file of rtl/ or of a bench, wherever it lies there: one module per file."""
    name: str
    file: str
    right: str                           # must be in the file once
    wrong: str

    def put(self, text):
        """The text with the bug in it."""
        count = text.count(self.right)
        if count != 1:
            raise RuntimeError(f"{self.file} has this {count} times, expected once: {self.right!r}; see the seeded bug '{self.name}'")
        return text.replace(self.right, self.wrong)


def source(root, file):
    """Where a file of rtl/ or of a bench lies; not one of those that take its place on a device."""
    return next(path for folder in ("rtl", "tests") for path in (root / folder).rglob(file) if "fpga" not in path.parts)


def tree(root, folder, *bugs):
    """A copy of rtl/ with bugs in it."""
    shutil.copytree(root / "rtl", folder / "rtl")
    for bug in bugs:
        path = source(folder, bug.file)
        path.write_text(bug.put(path.read_text()))
    return folder

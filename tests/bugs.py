"""Bugs put into the source on purpose: a test that does not see them would show nothing."""

import shutil
from typing import NamedTuple


class Bug(NamedTuple):
    """A change of one place in a file of rtl/, wherever it lies there: one module per file."""
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
    """Where a file of rtl/ lies; not one of those that take its place on a device."""
    return next(path for path in (root / "rtl").rglob(file) if "fpga" not in path.parts)


def tree(root, folder, *bugs):
    """A copy of rtl/ with bugs in it."""
    shutil.copytree(root / "rtl", folder / "rtl")
    for bug in bugs:
        path = source(folder, bug.file)
        path.write_text(bug.put(path.read_text()))
    return folder

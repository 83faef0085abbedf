"""Every bug that a test puts into the source has its place there, also those that only --long looks for: text that has changed is told at once."""

import importlib.util
import sys

import pytest

from bugs import Bug, source


def module(root, path):
    """A file of lists, as the tests beside it import it."""
    folder = str((root / path).parent)
    sys.path.insert(0, folder)
    try:
        spec = importlib.util.spec_from_file_location(f"bugs_of_{path.replace('/', '_')[:-3]}", root / path)
        found = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(found)
        return found
    finally:
        sys.path.remove(folder)


def named(root, rows):
    for name, (file, right, *_) in rows:
        yield name, root / "rtl" / file, right


def formal(root, rows):
    return [(bug.name, source(root, bug.file), bug.right) for bug in rows]


def subjects(root, at):
    return [(name, source(root, subject.sources[0]), right) for subject in vars(at).values() if isinstance(subject, at.Subject) for name, right, *_ in subject.bugs]


LISTS = {
    "tests/modules/test_modules.py": lambda root, at: formal(root, [bug for promise in at.BUGS.values() for bug in promise]),
    "tests/modules/test_parts.py": lambda root, at: formal(root, [bug for part in at.BUGS.values() for bug in part]),
    "tests/formal/mutants.py": lambda root, at: formal(root, at.BUGS),
    "tests/formal/scale.py": lambda root, at: formal(root, at.BUGS),
    "tests/formal/control.py": lambda root, at: subjects(root, at),
    "tests/formal/tile.py": lambda root, at: subjects(root, at),
    "tests/formal/values.py": lambda root, at: subjects(root, at),
    "tests/fast/test_fast.py": lambda root, at: [(bug.name, root / bug.file, bug.right) for bug in at.BUGS],
    "tests/fp/test_fp.py": lambda root, at: [(bug.name, root / bug.file, bug.right) for bug in at.BUGS],
    "tests/fpga/test_ecp5.py": lambda root, at: named(root, [(name, (f"fpga/{'/'.join(at.place(bug[0]))}.v", bug[1])) for name, bug in at.BUGS.items()]),
    "tests/fpga/test_ice40.py": lambda root, at: named(root, [(name, (f"fpga/ice40/fp3_{bug[0]}.v", bug[1])) for name, bug in at.BUGS.items()]),
    "tests/cosim/test_overlap.py": lambda root, at: formal(root, at.BUGS),
    "tests/board/test_bridge.py": lambda root, at: named(root, [(name, (f"board/fp3_{bug[0]}.v", bug[1])) for name, bug in at.BUGS.items()]),
    "tests/replay/test_checks.py": lambda root, at: named(root, at.BUGS.items()),
    "tests/video/test_frames.py": lambda root, at: formal(root, at.BUGS),
    "tests/replay/test_unknown.py": lambda root, at: named(root, [(name, bug[2]) for name, bug in at.BUGS.items()]),
}


@pytest.mark.smoke
@pytest.mark.parametrize("path", LISTS)
def test_every_seeded_bug_has_its_place(root, path):
    rows = list(LISTS[path](root, module(root, path)))
    for name, file, right in rows:
        Bug(name, file.name, right, "").put(file.read_text())
    assert len(rows) > 1

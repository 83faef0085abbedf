"""The C of the laws of bodies is that of their texts."""

import os
import shutil
import subprocess
import sys

import pytest


def checked(tree, build):
    return subprocess.run([sys.executable, tree / "tools/laws.py", "--check"], env={**os.environ, "FP3_BUILD": str(build)}, capture_output=True, text=True)


def test_the_header_is_what_the_tool_writes(root, build):
    done = checked(root, build)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("file, old, new, said", [
    ("programs/bodies/contact2.ode", "r - jr*(wb - wa)", "r - 2*jr*(wb - wa)", "is stale"), ("sw/bodies/laws.h", "row[k].mu * row[k].p1", "row[k].mu * row[k].p2", "is stale"),
    ("programs/bodies/gap2.ode", "shared pace", "param pace", "the law has params")])
def test_a_change_makes_it_stale(root, build, tmp_path, file, old, new, said):
    for name in ("tools/laws.py", "sw/bodies/laws.h", ".clang-format", *(path.relative_to(root) for path in (root / "programs/bodies").glob("*.ode"))):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(root / name, tmp_path / name)
    text = (tmp_path / file).read_text()
    assert old in text
    (tmp_path / file).write_text(text.replace(old, new))
    done = checked(tmp_path, build)
    assert done.returncode == 1 and said in done.stderr

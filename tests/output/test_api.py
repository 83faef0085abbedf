"""fp3/recording.h as a program uses it."""

import subprocess


def test_what_the_header_promises(build, root, tmp_path):
    done = subprocess.run([build / "tests/recording_api", root / "programs/ship.ode"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")

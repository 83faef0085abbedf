"""A host with another locale, another rounding or numbers flushed to zero gets the same bits and texts, and keeps what it has."""

import os
import subprocess

import pytest


def run(root, build, *host, **environment):
    done = subprocess.run([build / "tests/host", root / "programs/ship.ode", *host], capture_output=True, text=True,
                          env={**os.environ, **environment}, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("host", ["up", "down", "cut", "flush", "locale"])
def test_the_host_does_not_count(root, build, tmp_path, host):
    environment = {}
    if host == "locale":
        if subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", tmp_path / "de_DE.UTF-8"], capture_output=True).returncode:
            pytest.skip("no sources of locales here")
        environment = {"LOCPATH": str(tmp_path)}
    assert run(root, build, host, **environment) == run(root, build)

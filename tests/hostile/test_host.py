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


def test_a_definition_of_other_headers_is_refused_by_name(build):
    """Smaller or larger than the library's, nothing is written beyond its end; without a default it is refused, too."""
    out = subprocess.run([build / "tests/definitions"], capture_output=True, text=True, timeout=60)
    assert out.returncode == 0, out.stdout + out.stderr
    *lines, null = out.stdout.splitlines()
    assert null == "NULL: 1 1 1 1 1 1 1 1 1 1 1 1 1, 0 0 0" and len(lines) == 48
    for line in lines:
        (what, name), status, said = line.split(": ", 1)[0].split(), *line.split(": ", 1)[1].split(" ", 1)
        if what == "right":
            assert "headers" not in said and "default" not in said, line
        else:
            assert status == "1" and said.startswith(f"fp3_{name}_def has "), line
            assert f"begin with fp3_{name}_default()" in said if what == "zeros" else "headers of another version" in said, line

"""The smallest error that a program of rk4 reaches, beside plain C in FP32 with the host's functions."""

import subprocess

import pytest

STIFF = {"robertson": 16384, "van_der_pol_stiff": 65536}  # what rk4 needs at least
NAMES = ["arenstorf", "bouncing_ball", "double_pendulum", "double_spring", "duffing", "elastic_pendulum", "fitzhugh_nagumo",
         "kepler", "lorenz", "lotka_volterra", "oscillator", "pendulum", "projectile", "rc_ladder", "rigid_body", "robertson",
         "roessler", "ship", "ship_drag", "sir", "thermostat", "three_body", "van_der_pol", "van_der_pol_stiff"]


def test_every_model_has_a_row(root):
    assert [path.stem for path in sorted(root.glob("programs/*.ode"))] == NAMES


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.long if name in STIFF else ()) for name in NAMES])
def test_the_floor_is_near_that_of_plain_c(name, build, root):
    got = subprocess.run([build / "tests" / "plain", root / f"programs/{name}.ode", str(STIFF.get(name, 8192))],
                         text=True, capture_output=True, timeout=300)
    assert (got.returncode, got.stderr) == (0, "")
    words = got.stdout.split()
    plain, ours = float(words[2]), float(words[6])
    assert 1e-9 < plain < 0.05 and ours < 3 * plain, got.stdout

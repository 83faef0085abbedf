"""A splitting that loses its order on a model: every command that compiles says so; what it cannot move is refused."""

import re
import subprocess

import pytest

HEAD = "param k = 4\nparam c = 0.1\nstate x = 1\nstate v = 0\nstate T = 1\nstep 0.125\nspan 1\nx' = v\n"
DRAG = HEAD + "v' = -k*x - c*v\nT' = x\n"
PLAIN = HEAD + "v' = -k*x\nT' = x - T\n"
WELL = HEAD + "v' = -k*x\nT' = x\n"
WARNINGS = [
    (DRAG, "verlet", "line 9: 'verlet' has order 1 here, not 2: v' depends on v, which is not a position, and a splitting"),
    (DRAG, "yoshida6", "line 9: 'yoshida6' has order 1 here, not 6: v' depends on v, which is not a position, and a splitting"),
    (PLAIN, "pefrl", "line 10: 'pefrl' has order 1 here, not 4: T' depends on T, which is not a position, and a splitting"),
    (WELL, "pefrl", ""), (DRAG, "rk4", ""), (DRAG, "semi_implicit_euler", ""),
]


@pytest.fixture
def start(fp3, tmp_path):
    def start(*arguments):
        return subprocess.run([fp3, *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=300)

    return start


@pytest.mark.parametrize("text,integrator,warning", WARNINGS)
def test_all_commands_say_that_an_order_falls(start, tmp_path, text, integrator, warning):
    (tmp_path / "m.ode").write_text(text)
    (tmp_path / "m.scene").write_text('config = "shared_full"; engine = "isa"; groups = ('
                                      + ", ".join([f'{{ program = "m.ode"; integrator = "{integrator}"; objects = 2; }}'] * 2) + ");")
    for command, *arguments in (["run", "m.ode", "-i", integrator, "-e", "isa"], ["run", "--scene", "m.scene"],
                                ["compile", "m.ode", "-i", integrator], ["compile", "m.ode", "-i", integrator, "-o", "m.s"]):
        done = start(command, *arguments)
        assert done.returncode == 0, done.stderr
        if warning:
            assert done.stderr.startswith(f"fp3 {command}: m.ode: warning: {warning}"), done.stderr
            assert done.stderr.count("\n") == 1
        else:
            assert done.stderr == ""
    rows = [line for line in start("compare", "m.ode", "-i", integrator, "--arithmetic", "plain", "--quick").stdout.splitlines() if "warning" in line]
    assert [re.sub("^m +[a-z0-9_]+ +", "", row).startswith(f"warning: {warning}") for row in rows] == ([True] if warning else [])


@pytest.mark.parametrize("command", [["run", "-e", "isa"], ["compile"]])
def test_states_that_a_splitting_cannot_move_are_refused(start, tmp_path, command):
    (tmp_path / "m.ode").write_text("state x = 1\nstate y = 1\nstep 0.125\nx' = -x + y\ny' = -y\n")
    done = start(*command, "m.ode", "-i", "verlet")
    assert done.returncode == 2 and "found no state whose derivative is another state" in done.stderr


def test_states_that_nobody_reads_lower_no_order(start, tmp_path):
    (tmp_path / "m.ode").write_text(PLAIN)
    assert "T' depends on T" in start("compile", "m.ode", "-i", "verlet").stderr
    assert start("compile", "m.ode", "-i", "verlet", "--observe", "x").stderr == ""

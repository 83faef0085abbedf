"""Scenes of groups that see each other, as nobody should write them: refused by name, or right."""

import os
import re
import subprocess
import sys

import pytest

A = "model a\nkind b(R, z)\nstate z = 0\nall s(b)\nstep 0.25\nz' = sum(o in s: o.z - z)\n"
B = "model b\nkind a(z)\nparam R = 2\nstate z = 1\nall s(a)\nstep 0.25\nz' = sum(o in s: o.z - z)\n"


@pytest.fixture
def scene(start, folder):
    """Runs groups (model, settings): what the command did, and the words of each object."""
    def scene(*groups, options=(), top='config = "world"; steps = 2;', **models):
        for name, text in {"a": A, "b": B, **models}.items():
            (folder / f"{name}.ode").write_text(text)
        one = ",\n".join(f'{{ program = "{name}.ode"; integrator = "heun"; {settings} }}' for name, settings in groups)
        (folder / "x.scene").write_text(f"{top}\ngroups = (\n{one}\n);\n")
        done = start("--scene", "x.scene", "--all", *options)
        return done, re.findall(r"^(\w+) +(\S+) +0x\w+ +object (\d+)$", done.stdout, re.M)
    return scene


def refused(done, why):
    assert done.returncode == 2 and why in done.stderr and "object" not in done.stdout, done.stdout + done.stderr


STILL = "model b\nparam R = 2\nstate z = 1\nstep 0.5\nz' = 1\n"


@pytest.mark.parametrize("seen, other", [(B, "set = { h = 0.125; };"), (B.replace("0.25", "0.5"), ""), (STILL, "")])
def test_lengths_of_steps(scene, seen, other):
    done, _ = scene(("a", "objects = 1;"), ("b", f"objects = 1; {other}"), b=seen)
    refused(done, "groups that see each other make their steps together, so give the scene one h")
    if not other:
        assert scene(("a", "objects = 1;"), ("b", "objects = 1;"), b=seen, top='config = "world"; steps = 2; h = 0.25;')[0].returncode == 0


def test_first_word_is_not_read(scene):
    """The group is found by any word of the kind."""
    for engine in ("isa", "fast"):
        done, words = scene(("a", "objects = 1;"), ("b", "objects = 2;"), options=("--engine", engine))
        assert done.returncode == 0, done.stderr
        assert [name for name, _, _ in words] == ["z", "z", "z"]


@pytest.mark.parametrize("relation, term", [("all s(b)", "count(o in s: 1 > 0)"), ("links s(b, w = 3)", "sum(o in s: o.w)")])
def test_no_word_is_read(scene, relation, term):
    done, _ = scene(("a", "objects = 1;"), ("b", "objects = 2;"), a=f"model a\nkind b(R)\nstate z = 0\n{relation}\nstep 0.25\nz' = {term}\n")
    refused(done, "a.ode:4: group 'a': sums over 's' read no word of 'b': expected one that does, as sum(o in s: 0*o.R)")


@pytest.mark.parametrize("lives", ["", "born = [0, 2]; gone = [6, 8];"])
def test_check(scene, lives):
    """Groups that see each other run again together: the estimate is 4/3 of what half the step changes, as heun has order 2."""
    def run(factor, *options):
        told = re.sub(r"\d+", lambda number: str(factor*int(number[0])), lives)
        return scene(("a", "objects = 1;"), ("b", f"objects = 3; {told} spread = {{ z = [1, 3]; }};"), options=("-e", "isa", *options),
                     top=f'config = "world"; steps = {8*factor}; h = {0.25/factor};')
    first, half = (dict(((name, number), float(value)) for name, value, number in run(factor)[1]) for factor in (1, 2))
    done, _ = run(1, "--check")
    assert done.returncode == 0 and len(re.findall(r"^check .*h = 0.125 in 16 steps", done.stdout, re.M)) == 2, done.stderr
    found = {(name, number): float(error) for name, number, error in re.findall(r"^(\w+) .*object (\d+) +error (\S+), relative", done.stdout, re.M)}
    assert found.keys() == first.keys() and len(found) == 4
    for one, error in found.items():
        assert error == pytest.approx(4/3*abs(first[one] - half[one]), rel=0.06, abs=1e-6), one
    assert max(found.values()) > 1e-3
    assert run(1, "--check", "--strict")[0].returncode == 3 and run(1, "--check", "--strict=0.9")[0].returncode == 0


@pytest.mark.parametrize("groups", [2, 8])
def test_occupancy(scene, groups):
    """Shares of what several groups spent are at most all of it, and fit their lines."""
    models = {}
    for i in range(groups):
        own, other = f"g{i}", f"g{(i + 1) % groups}"
        models[own] = A.replace("model a", f"model {own}").replace("b(R, z)", f"{other}(z)").replace("(b)", f"({other})")
    done, words = scene(*((name, "objects = 2;") for name in models), options=("--engine", "rtl", "--clock", "100MHz"), **models)
    assert done.returncode == 0 and len(words) == 2*groups, done.stderr
    shares = [(float(share), len(bar)) for share, bar in re.findall(r"(\d+\.\d) %(?:  (#+))?$", done.stdout, re.M)]
    assert shares and all(share <= 100 and bar <= 40 for share, bar in shares)
    assert re.search(r"^  cycles +\d+  100.0 %$", done.stdout, re.M) and "balance" not in done.stdout
    assert re.search(r"^bus .*: [1-9]\d* transfers in [1-9]\d* cycles$", done.stdout, re.M)


def test_python_has_no_words_of_others(scene, folder, root, build):
    """They are params of the program, which hold nothing where own objects are."""
    scene(("a", "objects = 1;"), ("b", "objects = 2;"))
    text = "import fp3\ns = fp3.Scene('x.scene')\ns.run(2)\nprint('b_z' in s.groups[0], 'a_z' in s.groups[1], *(g['z'].size for g in s.groups))"
    done = subprocess.run([sys.executable, "-c", text], cwd=folder, capture_output=True, text=True, timeout=60,
                          env={**os.environ, "PYTHONPATH": str(root / "python"), "FP3_HOME": str(build)})
    assert done.stdout == "False False 1 2\n", done.stdout + done.stderr


@pytest.mark.parametrize("integrator", ["euler", "rk4"])
def test_remember_of_one_and_projection_of_the_other(start, folder, integrator):
    """One has no projection, and its pairs remember behind its last phase: the other's projection sees what it ends its step with."""
    (folder / "a.ode").write_text("model a\nkind b(x)\nstate x = 0\nlinks l(b, m = 1)\nstep 0.125\nx' = 1\nremember o in l: o.m = o.m + o.x\n")
    (folder / "b.ode").write_text("model b\nkind a(x)\nstate x = 1\nall s(a)\nstep 0.125\nx' = 0*x\nproject x = x + sum(o in s: o.x)\n")
    (folder / "l.csv").write_text("a,b\n0,0\n1,1\n")
    group = '{{ program = "{}.ode"; integrator = "{}"; objects = 2; {} }}'
    (folder / "x.scene").write_text(f"""steps = 4;
groups = ( {group.format("a", integrator, 'links = { relation = "l"; file = "l.csv"; };')}, {group.format("b", integrator, "")} );
""")
    for engine in ("isa", "fast", "rtl"):
        done = start("--scene", "x.scene", "--engine", engine, "--all")
        assert re.findall(r"^x +(\S+)", done.stdout, re.M) == ["0.5", "0.5", "3.5", "3.5"], done.stdout + done.stderr


def test_event_of_one_behind_a_projection_of_the_other(scene):
    """An event sees what projections have left, where its own model has none, too."""
    a = "model a\nkind b(x)\nstate n = 0\nall s(b)\nstep 0.5\nn' = 0\nwhen sum(o in s: o.x) > 100: n = n + 1\n"
    b = "model b\nkind a(n)\nstate x = 0\nall s(a)\nstep 0.5\nx' = 0\nproject x = 101 + 0*sum(o in s: o.n)\n"
    for engine in ("isa", "fast", "rtl"):
        done, words = scene(("a", "objects = 1;"), ("b", "objects = 1;"), options=("--engine", engine), top='config = "world"; steps = 1;', a=a, b=b)
        assert words == [("n", "1", "0"), ("x", "101", "1")], done.stdout + done.stderr


def test_messages_name_the_group(scene):
    done, _ = scene(("a", "objects = 1;"), ("b", "objects = 1;"), b=B.replace("all s(a)", "links s(a)"))
    refused(done, "group 1: objects are linked by 's' (line 5 of the model), and no links are given")


def test_a_kind_that_no_sum_uses(scene):
    done, _ = scene(("a", "objects = 1;"), ("b", "objects = 1;"), a="model a\nkind b(z)\nstate z = 0\nall s(b)\nstep 0.25\nz' = 1\n", b="model b\nstate z = 0\nstep 0.25\nz' = 1\n")
    refused(done, "found 2 groups that do not see each other (no sum of a model goes over objects of a `kind`)")

"""What a run gets wrong without a flag: `fp3 run --check` estimates it, warnings name it, and --strict makes it exit code 3."""

import math
import re
import subprocess

import pytest

GROW = "state x = 1\nx' = 1e-5*x\nstep 0.00390625\n"
COUNT = "state x = 16380\nx' = 1\nstep 0.0009765625\n"
UNDERFLOW = "state T = 1\nstate y = 0\nT' = 0\ny' = 1e38*exp(-105/T)*1e8\nstep 0.0078125\n"
SUBNORMAL = "param k = 2e-45\nstate y = 0\nstate z = 1e37\nz' = 0\ny' = k*z*1e8\nstep 0.0078125\n"
ROOT = "state x = 2^-70\nstate s = 0\nx' = 0*x\ns' = sqrt(x*x)\nstep 1\n"  # the square is exact, so nothing raises underflow
BELOW = ROOT.replace("sqrt(x*x)", "min(3, 1e-30/(x*x)^0.5)")
NUMBER = SUBNORMAL.replace("param k = 2e-45\n", "").replace("k*", "2e-45*")
OREGONATOR = ("state x = 1\nstate y = 2\nstate z = 3\nx' = 77.27*(y - x*y + x - 8.375e-6*x^2)\n"
              "y' = (-(1 + x)*y + z)/77.27\nz' = 0.161*(x - z)\nstep 0.0078125\n")
EXACT = {"grow": math.exp(1e-5*2**20/256), "count": 16380 + 16384*2.0**-10, "underflow": 1e46*math.exp(-105), "subnormal": 2}
FAST = ["-e", "fast", "-c", "many_full"]


@pytest.fixture
def run(fp3, root, tmp_path):
    def start(model, *arguments, objects=1, code=0, engine=FAST):
        path = root / "programs" / model if model.endswith(".ode") else tmp_path / "m.ode"
        if not model.endswith(".ode"):
            path.write_text(model)
        done = subprocess.run([fp3, "run", path, *engine, "-N", str(objects), *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=300)
        assert done.returncode == code, done.stdout + done.stderr
        return done
    return start


def estimates(done):
    """(state, object): value, error, relative error."""
    rows = re.findall(r"^(\w+) +(\S+) +0x\w+(?: 0x\w+)?   object (\d+)   error (\S+), relative (\S+)$", done.stdout, re.M)
    return {(name, int(number)): tuple(map(float, figures)) for name, figures, number in ((r[0], (r[1], r[3], r[4]), r[2]) for r in rows)}


def worst(done):
    number, name, error, relative = re.search(r"^worst +object (\d+), (\w+): error (\S+), relative (\S+)$", done.stdout, re.M).groups()
    return int(number), name, float(error), float(relative)


# ---- estimates ----

@pytest.mark.parametrize("name, model, steps, state", [
    ("grow", GROW, 2**20, "x"), ("count", COUNT, 16384, "x"), ("underflow", UNDERFLOW, 128, "y"), ("subnormal", SUBNORMAL, 128, "y"), ("subnormal", NUMBER, 128, "y")])
def test_what_fp32_loses_is_estimated(run, name, model, steps, state):
    done = run(model, "-n", str(steps), "--check")
    value, error, _ = estimates(done)[state, 0]
    real = abs(value - EXACT[name])
    assert real > 1e-4 * EXACT[name] and real / 2 < error < 2 * real
    assert worst(done)[:3] == (0, state, error)
    assert "allows" in run(model, "-n", str(steps), "--check", "--strict=1e-4", code=3).stderr


def test_an_unstable_run_is_seen(run):
    """Its reference is y = 2065."""
    done = run(OREGONATOR, "-i", "ros2", "-n", "3850", "--check", "--strict", code=3)
    assert worst(done)[1] == "y" and worst(done)[3] > 0.5
    assert "object 0, y: relative error" in done.stderr and not re.search("warning", done.stderr)


def kepler(t):
    """programs/kepler.ode at time t: r, v."""
    e, E = 0.5, t
    for _ in range(99):
        E -= (E - e*math.sin(E) - t) / (1 - e*math.cos(E))
    b, rate = math.sqrt(1 - e*e), 1 / (1 - e*math.cos(E))
    return {"r_x": math.cos(E) - e, "r_y": b*math.sin(E), "v_x": -math.sin(E)*rate, "v_y": b*math.cos(E)*rate}


@pytest.mark.parametrize("how", [
    ["--set=h=2^-4", "-n200"], ["--set=h=2^-5", "-n400", "-k"], ["-i", "verlet", "--set=h=2^-6", "-n800"], ["-i", "euler", "--set=h=2^-8", "-n256"],
    pytest.param(["--tolerance", "1e-4"], marks=pytest.mark.long), ["--tolerance", "1e-3", "-i", "heun", "--until", "4"]])
def test_estimates_are_near_the_errors(run, how):
    steps = [int(word[2:]) for word in how if word.startswith("-n")]
    h = [2.0**int(word.split("^")[1]) for word in how if "h=" in word]
    t = steps[0]*h[0] if steps else float(how[-1]) if "--until" in how else 12.5
    exact = kepler(t)
    done = run("kepler.ode", *how, "--check")
    found = estimates(done)
    assert {name for name, _ in found} == set(exact)
    for name, real in exact.items():
        value, error, _ = found[name, 0]
        assert abs(value - real) / 10 < error < 10 * abs(value - real), name


def test_a_check_changes_nothing_else_and_engines_agree(run):
    plain, done = (run("kepler.ode", "-n", "300", "--spread=r_x=0.4:0.6", *more, objects=12) for more in ([], ["--check"]))
    bare = re.sub(r"   error \S+, relative \S+$|^(check|worst|invariant) .*\n", "", done.stdout, flags=re.M)
    assert re.sub("^time.*", "", bare, flags=re.M) == re.sub("^time.*", "", plain.stdout, flags=re.M)
    assert len(estimates(done)) == 8 * 4 and re.search(r"^check +h = 0.0078125 in 600 steps, double-single; ", done.stdout, re.M)
    for engine in ("isa", "rtl"):
        other = run("kepler.ode", "-n", "300", "--spread=r_x=0.4:0.6", "--check", objects=12, engine=["-e", engine, "-c", "many_full"])
        assert estimates(other) == estimates(done) and worst(other) == worst(done)


def test_the_worst_object_may_be_one_that_is_not_printed(run):
    done = run("kepler.ode", "-n", "800", "--spread=v_y=1.6:0.9", "--check", objects=20)
    number, _, error, relative = worst(done)
    assert number == 19 and relative > max(row[2] for row in estimates(done).values())


def test_what_is_not_finite_is_the_worst(run):
    done = run("state x = 1\nstate y = 1\nx' = x^2\ny' = -y\nstep 0.125\n", "-n", "60", "--check", "--allow-failures", "--strict", code=3)
    assert worst(done)[1] == "x" and not math.isfinite(worst(done)[3])


@pytest.mark.parametrize("source, arguments, why", [
    ("x.s", ["--check"], "--check: expected a model"), ("m.ode", ["--strict=1e-3"], "--strict=TOL: expected --check"),
    ("m.ode", ["--check", "--set=steps=3"], "--check: found a value of 'steps'"), ("m.ode", ["--check", "--strict=0"], "--strict"),
    ("m.ode", ["--check", "--params", "f.cfg"], "'x' is computed from a value that a check changes"),
    ("m.ode", ["--check", "--tolerance", "1e-3", "--until", "2", "--times", "0.5,1", "--output", "o.csv"], "ends at 1, its last snapshot, not at 2")])
def test_where_a_check_has_no_meaning(fp3, tmp_path, source, arguments, why):
    (tmp_path / "x.s").write_text(".state v\nstep: add v, v, 1.0\n")
    (tmp_path / "m.ode").write_text("state x = 1\nx' = -x*t\nstep 0.125\nspan 1\n")
    (tmp_path / "f.cfg").write_text('h = 0.125; x = "2*h";\n')
    done = subprocess.run([fp3, "run", source, "-c", "single_full", "-e", "isa", *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and why in done.stderr, done.stdout + done.stderr


# ---- warnings ----

def test_more_steps_than_t_can_count_are_refused_before_they_are_made(run):
    text = "state x = 1\nx' = -x + sin(t)\nstep 0.0009765625\nspan 1\n"
    assert "half the step takes 16777218 steps, and a program with t counts 16777216 at most" in run(text, "-n", "8388609", "--check", code=2).stderr


@pytest.mark.parametrize("model, steps, text", [
    (GROW, 2**20, "object 0: x stands still: a step adds 3.9e-08, and FP32 rounds x = 1 by up to 6e-08; use --compensated or a longer step"),
    (COUNT, 2**16, "object 0: x stands still: a step adds 0.00098, and FP32 rounds x = 16384 by up to 0.00098; use --compensated or a longer step"),
    (UNDERFLOW, 128, "object 0: y' is 2.51, but FP32 makes it 0: a value of 2.51e-46 in line 4 is too small for FP32; scale the equations"),
    (ROOT, 4, "object 0: s' is 8.47e-22, but FP32 makes it 1.24e-23: a value of 7.17e-43 in line 4 is too small for FP32; scale the equations"),
    (BELOW, 4, "object 0: s' is 1.18e-09, but FP32 makes it 3: a value of 7.17e-43 in line 4 is too small for FP32; scale the equations"),
    (SUBNORMAL, 128, "object 0: k = 2e-45 loses digits: FP32 has 1.4e-45 (30 % off)"),
    (NUMBER, 128, "object 0: a number in line 4 = 2e-45 loses digits: FP32 has 1.4e-45 (30 % off)"),
    ("state x = 3e-45\nx' = 0*x\nstep 1\n", 1, "object 0: x = 3e-45 loses digits: FP32 has 2.8e-45 (6.6 % off)")])
def test_a_loss_is_told_and_strict_fails(run, model, steps, text):
    done = run(model, "-n", str(steps))
    assert re.search(r"^fp3 run: .*m\.ode: warning: " + re.escape(text) + "$", done.stderr, re.M), done.stderr
    strict = run(model, "-n", str(steps), "--strict", code=3)
    assert strict.stderr.startswith(done.stderr) and "--strict allows none" in strict.stderr


@pytest.mark.parametrize("config, arguments", [("single_full", []), ("many_full", ["--double-single"]), ("flush", [])])
def test_the_error_of_a_subnormal_number_s_root_is_estimated(run, config, arguments):
    """The second run has the same wrong root."""
    value, error, _ = estimates(run(ROOT, "-n", "10", "--check", *arguments, engine=["-e", "fast", "-c", config]))["s", 0]
    assert error > 5e-21 and abs(10*2**-70 - value) == pytest.approx(error, rel=0.02)


@pytest.mark.parametrize("model, arguments", [
    (GROW, ["-n", str(2**20), "-k"]), (GROW, ["-n", "1000"]),                     # compensated; too short to lose much
    (COUNT, ["-n", "4096"]),                                                       # exact as far as it goes
    ("state x = 0\nx' = 1 - x\nstep 0.001\n", ["-n", "1000000", "-i", "euler"]),                   # an equilibrium stands still
    ("param k = 2e-45\nstate x = 1\nx' = (k*1e45)*x\nstep 0.125\n", ["-n", "8"]),  # no instruction reads k
    ("state x = 1\nstate y = 10\nx' = -x + exp(-y^2)\ny' = 1\nstep 0.125\n", ["-n", "80"])])  # an underflow that changes nothing
def test_what_loses_nothing_is_not_told(run, model, arguments):
    assert run(model, *arguments, "--strict").stderr == ""


@pytest.mark.parametrize("model, arguments, angle", [
    ("state x = 0\nx' = cos(64*pi*t)\nstep 0.5\n", ["-n", "700"], "cos in line 2 is 70371.6754"),
    ("state x = 0\nx' = cos(64*pi*t)\nstep 0.5\nspan 400\n", ["--until", "400"], "cos in line 2 is "),
    ("state a = 65000\nstate x = 0\na' = 1\nx' = sin(a) + sin(x)\nstep 0.5\n", ["-n", "1200"], "sin in line 4 is 65600")])
def test_the_angle_that_was_too_large_is_named(run, model, arguments, angle):
    done = run(model, *arguments, code=3)
    assert f"warning: object 0: the argument of {angle}" in done.stderr and "below 65536 only" in done.stderr


def test_each_group_of_a_scene_is_looked_at(fp3, tmp_path):
    (tmp_path / "a.ode").write_text("state x = 1\nx' = -x\nstep 0.0078125\n")
    (tmp_path / "b.ode").write_text(UNDERFLOW)
    (tmp_path / "m.scene").write_text('config = "shared_full"; engine = "isa"; steps = 9; groups = ({ program = "a.ode"; objects = 2; }, { program = "b.ode"; objects = 2; });')
    done = subprocess.run([fp3, "run", "--scene", "m.scene", "--strict"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 3 and re.search(r"^fp3 run: .*b\.ode: warning: object 2: y' is 2.51", done.stderr, re.M), done.stderr


# ---- scenes, and objects that see each other ----

SPRING = ("shared k = 4\nstate x = 0\nstate v = 0\nlinks s\nstep 0.0625\n"
          "x' = v\nv' = sum(o in s: k*(o.x - x))\n")
TWO = 'links = { relation = "s"; file = "s.csv"; };'


@pytest.fixture
def scene(fp3, tmp_path):
    def start(model, groups, *arguments, code=0):
        """groups: what each says besides its program; model: of the first."""
        (tmp_path / "m.ode").write_text(model)
        (tmp_path / "s.csv").write_text("a,b\n0,1\n")
        (tmp_path / "alone.ode").write_text("state x = 1\nx' = -x\nstep 0.125\n")
        named = ", ".join("{ program = \"%s\"; %s }" % ("alone.ode" if i else "m.ode", text) for i, text in enumerate(groups))
        (tmp_path / "m.scene").write_text(f"groups = ( {named} );")
        done = subprocess.run([fp3, "run", "--scene", "m.scene", *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=120)
        assert done.returncode == code, done.stdout + done.stderr
        return done
    return start


@pytest.mark.parametrize("integrator, engine", [("leapfrog", "fast"), ("rk4", "fast"), ("semi_implicit_euler", "isa")])
def test_estimates_of_objects_that_see_each_other_are_near_the_errors(run, tmp_path, integrator, engine):
    """Two equal masses, one spring: x0 - x1 is a cosine of sqrt(2 k) t. A bystander rests."""
    (tmp_path / "s.csv").write_text("a,b\n0,1\n")
    done = run(SPRING, "-i", integrator, "--spread=x=1:-1", "--links=s=s.csv", "-n", "100", "--check", objects=3, engine=["-e", engine, "-c", "world"])
    # x of the three is 1, 0, -1 at the start: the mean of the first two stays, their difference swings
    swing = 0.5 * math.cos(math.sqrt(8) * 6.25)
    exact = {0: 0.5 + swing, 1: 0.5 - swing, 2: -1}
    found = estimates(done)
    for number, real in exact.items():
        value, error, relative = found["x", number]
        assert abs(value - real) / 4 <= error <= 4 * abs(value - real) and relative == pytest.approx(error, rel=0.2), (number, real, found)


def test_a_close_encounter_is_told_and_strict_fails(scene):
    """Burrau, 1913: three bodies at rest, of masses 3, 4, 5. The first pass is closer than steps of 2^-10 resolve."""
    model = ("shared G = 1\nparam m = 1\nstate v[2] = (0, 0)\nstate r[2] = (0, 0)\nall others\nstep 2^-10\n"
             "r' = v\nv' = sum(o in others: G*o.m/norm(o.r - r)^3*(o.r - r))\n")
    bodies = ("objects = 3; integrator = \"leapfrog\"; only = ( { objects = 0; set = { m = 3; r_x = 1; r_y = 3; }; }, "
              "{ objects = 1; set = { m = 4; r_x = -2; r_y = -1; }; }, { objects = 2; set = { m = 5; r_x = 1; r_y = -1; }; } );")
    done = scene(model, [bodies], "-n", "3072", "--check", "--strict", code=3)
    assert worst(done)[3] > 0.1 and "--strict allows 0.001" in done.stderr
    assert scene(model, [bodies], "-n", "512", "--check", "--strict").stderr == ""


@pytest.mark.parametrize("integrator, limit, growth", [
    ("semi_implicit_euler", 2, lambda z: z*z/2 - 1 + math.sqrt((z*z/2 - 1)**2 - 1)), ("leapfrog", 2, lambda z: z*z/2 - 1 + math.sqrt((z*z/2 - 1)**2 - 1)),
    ("rk4", 2.8284271, lambda z: math.hypot(1 - z**2/2 + z**4/24, z - z**3/6))])
def test_a_step_too_long_for_a_sum_is_told(scene, integrator, limit, growth):
    """The frequency of two masses at one spring is sqrt(2 k/m). The step beyond which it grows is the method's, by theory."""
    group = f'objects = 2; integrator = "{integrator}"; {TWO} spread = {{ x = [1e-9, -1e-9]; }};'
    for share, is_told in ((0.98, False), (1.1, True)):
        h = share * limit / math.sqrt(8)
        done = scene(SPRING, [group.replace("spread", f"set = {{ h = {h!r}; }}; spread")], "-n", "100", *([] if is_told else ["--strict"]))
        if not is_told:
            assert done.stderr == ""
            continue
        found = re.search(r"warning: object [01]: the step is too long: a small error grows (\S+) times in each step of h = (\S+) by (\w+); "
                          r"with h = (\S+) it does not grow$", done.stderr, re.M)
        assert float(found[1]) == pytest.approx(growth(share * limit), rel=0.02) and float(found[2]) == pytest.approx(h, rel=0.01)
        assert found[3] == integrator and 0.85 * h / share < float(found[4]) < h / share


def test_motion_that_grows_by_itself_is_no_fault_of_the_step(scene):
    """x' = v, v' = 40 x: a factor of e^0.4 a step, whatever the step."""
    model = SPRING.replace("k = 4", "k = -20")
    group = f'objects = 2; integrator = "rk4"; {TWO} spread = {{ x = [1e-30, -1e-30]; }}; set = {{ h = 0.0625; }};'
    assert scene(model, [group], "-n", "100", "--strict").stderr == ""


def test_what_has_flown_apart_is_seen_at_the_start_and_by_a_check(scene):
    model = ("state x = 0\nstate v = 0\nnear touch(x, 1)\nstep 0.03125\nx' = v\n"
             "v' = sum(o in touch: abs(o.x - x) < 1 ? 5000*(1 - abs(o.x - x))*(x > o.x ? 1 : -1) : 0)\n")
    group = 'objects = 2; integrator = "semi_implicit_euler"; spread = { x = [0, 0.9]; };'
    assert "object 0: the step is too long" in scene(model, [group], "-n", "100").stderr.replace("object 1", "object 0")
    done = scene(model, [group.replace("0, 0.9]", "0, 1.1]; v = [1, -1]")], "-n", "16", "--check")
    assert "too long for equal objects side by side" in done.stderr         # nobody is near at the start: the row of the stress is
    assert re.search(r"^unstable +object [01]: the step is too long", done.stdout, re.M)


def test_groups_are_checked_one_by_one(scene):
    """The second group starts at object 2, and is born late."""
    alone = 'objects = 3; born = [0, 8]; integrator = "euler"; set = { h = 0.125; };'
    done = scene(SPRING.replace("links s\n", "").replace("sum(o in s: k*(o.x - x))", "-k*x"), ["objects = 2; set = { x = 1; };", alone], "-n", "16", "-c", "shared_full", "-e", "isa", "--check")
    found = estimates(done)
    assert len(re.findall(r"^check ", done.stdout, re.M)) == 2
    for number, age in ((2, 2), (3, 1.5), (4, 1)):
        value, error, _ = found["x", number]
        assert error / 2 < abs(value - math.exp(-age)) < 2 * error
    refused = scene("state x = 1\nx' = -x\nstep 0.125\n", ["objects = 3; born = [0, 7];"], "-n", "16", "-c", "many_full", "-e", "isa", "--check", code=2)
    assert "births of 3 objects from step 0 to 7 are rounded to whole steps" in refused.stderr


def test_invariants_are_told(run):
    done = run("kepler.ode", "-n", "200", "--set=h=2^-4", "--check")
    first, change = re.search(r"^invariant +object 0, energy: was (\S+), changed by (\S+)$", done.stdout, re.M).groups()
    end = {name: value for (name, _), (value, _, _) in estimates(done).items()}
    energy = (end["v_x"]**2 + end["v_y"]**2)/2 - 1/math.hypot(end["r_x"], end["r_y"])
    assert float(first) == -0.5 and float(change) == pytest.approx(energy + 0.5, rel=0.05)

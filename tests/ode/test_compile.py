"""The compiler: the ship as a person wrote it, passes that keep the bits, errors, time."""
import concurrent.futures
import math
import os
import pathlib
import random
import re
import struct
import subprocess

import pytest

import random_models

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
BUILD = os.environ["FP3_BUILD"]
FP3 = os.path.join(BUILD, "fp3")
PROGRAMS = os.path.join(ROOT, "programs")
KEEPING = ["common", "identity", "dead", "carry", "scale", "chain", "fuse", "ahead", "share", "zero"]
CHANGING = ["fold-step", "fold-product", "own-weights", "small-angles", "exact-division"]


def fp3(*arguments, check=True):
    done = subprocess.run([FP3, *map(str, arguments)], capture_output=True, text=True)
    if check:
        assert done.returncode == 0, done.stderr
    return done


def model(name):
    return os.path.join(PROGRAMS, name + ".ode")


def report(*arguments):
    """The numbers of --report by their names."""
    text = fp3("compile", *arguments, "--report").stdout
    return {m[1].strip(): float(m[2]) for m in re.finditer(r"^(.+?)  +(?:saves )?([0-9.e+-]+)", text, re.M)}


def final(image, params, steps, config, *settings):
    """The bits that a run ends with, by name."""
    done = fp3("run", image, "-c", config, "--engine", "isa", "--steps", steps, "--params", params, "--allow-failures",
               *[word for setting in settings for word in ("--set", setting)])
    found = {(name, int(number)): bits for name, bits, number
             in re.findall(r"^(\w+) +\S+ +(0x[0-9a-f]{8}) +object (\d+)$", done.stdout, re.M)}
    assert found, done.stdout
    return found


def compiled(tmp_path, name, *options):
    image, params = tmp_path / "c.fp3", tmp_path / "c.cfg"
    fp3("compile", model(name), *options, "--image", image, "--params", params)
    return image, params


@pytest.mark.parametrize("name, integrator, status, said", [("cloth", "dopri5", 0, ""), ("cloth", "rk6", 2, "needs 65 object registers"),
                                                            ("balls", "tsit5", 2, "needs 70 object registers")])
def test_neighbours_with_many_stages(name, integrator, status, said):
    """Making what neighbours see at a late stage adds what they see at the stages before it."""
    done = fp3("compile", model(f"world/{name}"), "-i", integrator, "-c", "world", check=False)
    assert done.returncode == status and said in done.stderr, done.stderr


def level(segments, names):
    """A ball above segments, each with six numbers; half of these are params, or none."""
    choose, params, lines, forces = random.Random(5), [], [], []
    for i in range(segments):
        numbers = [repr(round(low + width*choose.random(), 5)) for low, width in ((i, 0.3), (0, 1), (0.01, 0.1), (0.4, 0.6), (0.5, 0.5), (50, 900))]
        for k in range(3, 6) if names else ():
            params.append(f"param p{i}_{k} = {numbers[k]}")
            numbers[k] = f"p{i}_{k}"
        at, above, slope, long, share, stiff = numbers
        lines.append(f"d{i} = max(0, {above} + {slope}*(x - {at}) - y*{share})*(x > {at} and x < {at} + {long})")
        forces.append(f"{stiff}*d{i}")
    starts = ["state x = 0.3", "state y = 2", "state vx = 1", "state vy = 0", "step 0.00390625"]
    ends = ["x' = vx", "y' = vy", "vx' = -0.1*vx", "vy' = -9.81 + " + " + ".join(forces)]
    return "\n".join([*params, *starts, *lines, *ends, ""])


@pytest.mark.parametrize("config", ["many_full", "single_full"])
def test_numbers_beyond_the_constants_are_params(tmp_path, config):
    """69 constants and more: the same bits as with params in their place, on hardware, too, and the text is the image."""
    ends = set()
    for names in (0, 1):
        (tmp_path / "m.ode").write_text(level(11, names))
        for engine in ("isa", "fast", "rtl"):
            out = fp3("run", tmp_path / "m.ode", "-c", config, "-e", engine, "-N", 1, "-n", 40).stdout
            ends.add(tuple(re.findall(r"^(\w+) +\S+ +(0x\w+) +object 0$", out, re.M)))
        fp3("compile", tmp_path / "m.ode", "-c", config, "-o", tmp_path / "m.s", "--image", tmp_path / "a.fp3")
        fp3("asm", tmp_path / "m.s", "-o", tmp_path / "b.fp3")
        assert (tmp_path / "a.fp3").read_bytes() == (tmp_path / "b.fp3").read_bytes()
    assert len(ends) == 1 and len(ends.pop()) == 4
    (tmp_path / "m.ode").write_text(level(20, 0))
    refused = fp3("compile", tmp_path / "m.ode", "-c", "many_full", check=False)
    assert refused.returncode == 2 and "the program needs 70 object registers, configuration 'many_full' has 64; none has enough" in refused.stderr


def test_a_step_that_keeps_too_much_is_refused(root):
    refused = fp3("compile", root / "programs/world/net.ode", "-i", "rkc12", "--double-single", "-c", "world", check=False)
    assert refused.returncode == 2 and "a step keeps more than 128 values from one part to another" in refused.stderr


def combinations(seed, every, part="0/1"):
    paths = sorted(str(path) for path in pathlib.Path(PROGRAMS).rglob("*.ode"))
    done = subprocess.run([os.path.join(BUILD, "tests/combinations"), str(seed), str(every), part, *paths], capture_output=True, text=True)
    assert done.returncode == 0, (seed, done.stdout.splitlines()[-1:], done.stderr)
    return {word: int(number) for number, word in re.findall(r"(\d+) (\w+)", done.stdout.splitlines()[-1])}


def test_each_model_by_each_integrator_is_a_program_or_is_refused(long):
    seed = random.randrange(1 << 32)
    print("seed", seed)
    if long:
        with concurrent.futures.ThreadPoolExecutor() as pool:
            found = list(pool.map(lambda k: combinations(seed, 1, f"{k}/16"), range(16)))
    else:
        found = [combinations(seed, 400)]
    assert sum(counts["made"] for counts in found) and sum(counts["refused"] for counts in found)


@pytest.mark.smoke
@pytest.mark.parametrize("options", [("ship", "-c", "dual", "-i", "rk4_paper", "--with", "fold-step", "--with", "fold-product"),
                                     ("kepler", "-k", "-c", "many_full"), ("duffing", "--double-single", "-c", "many_full"),
                                     ("double_spring", "-c", "single_full", "--tolerance", "1e-5"), ("robertson", "-i", "ros3p", "-c", "many_full")],
                         ids=lambda options: options[0])
def test_the_text_assembles_to_the_image(tmp_path, options):
    """The compiler makes both from one schedule; nothing reads the text but people and the assembler."""
    text, image, assembled = (tmp_path / name for name in ("p.s", "p.fp3", "again.fp3"))
    fp3("compile", model(options[0]), *options[1:], "-o", text, "--image", image)
    fp3("asm", text, "-o", assembled)
    assert image.read_bytes() == assembled.read_bytes()


# ---- the paper's ship ----

SHIP = ["--set", "m=8.7e5", "--set", "T=2.9e5", "--set", "C=4.1e4", "--set", "h=0.0078125", "--set", "v=0", "--set", "s=0"]


@pytest.mark.smoke
@pytest.mark.parametrize("config", ["single", "many", "uncut", "paper", "shared", "single_full", "many_full"])
def test_the_ship_has_the_bits_of_the_handwritten_program(tmp_path, config):
    by_hand = tmp_path / "hand.fp3"
    fp3("asm", os.path.join(PROGRAMS, "ship.s"), "-o", by_hand)
    image, params = compiled(tmp_path, "ship", "-i", "rk4_paper", "-c", config, *SHIP)
    for steps in (1, 2, 1000):
        assert final(image, params, steps, config) == final(by_hand, os.path.join(PROGRAMS, "ship.cfg"), steps, config)


@pytest.mark.smoke
def test_the_ship_takes_no_more_cycles_than_by_hand():
    assert report(model("ship"), "-i", "rk4_paper", "-c", "single")["cycles per object-step"] <= 48
    assert report(model("ship"), "-i", "rk4_paper", "-c", "uncut")["cycles per object-step"] <= 26
    assert report(model("ship"), "-i", "rk4_paper", "-c", "many")["cycles per object-step"] <= 20


@pytest.mark.smoke
def test_folding_is_off_unless_asked_for_and_changes_bits(tmp_path):
    """... where h is no power of two, with which products are exact."""
    ship = [*SHIP, "--set", "h=0.01", "-i", "rk4_paper"]
    fewer = ["--with", "fold-step", "--with", "fold-product"]
    assert report(model("ship"), *fewer)["operations"] < report(model("ship"))["operations"]
    steps = (10, 30, 100, 300, 1000)
    bits = [[final(*compiled(tmp_path, "ship", *ship, *options), n, "single_full") for n in steps] for options in ([], fewer)]
    assert bits[0] != bits[1]


# ---- passes ----

@pytest.mark.parametrize("config", ["single_full", "many_full"])
@pytest.mark.parametrize("name", ["ship", "kepler", "rigid_body", "pendulum", "double_spring"])
def test_passes_keep_the_bits(tmp_path, name, config):
    for integrator in ("rk4", "heun"):
        want = final(*compiled(tmp_path, name, "-i", integrator, "-c", config), 20, config)
        for passes in [[p] for p in KEEPING] + [["all"]]:
            off = [word for p in passes for word in ("--without", p)]
            got = final(*compiled(tmp_path, name, "-i", integrator, "-c", config, *off), 20, config)
            assert got == want, (integrator, passes)


def test_every_pass_saves_something_somewhere():
    saved = dict.fromkeys(KEEPING + CHANGING, 0)
    for name, options in [("kepler", ["-i", "verlet"]), ("ship", ["-i", "rk4", "-c", "shared_full"]),
                          ("ship", ["-i", "rk4", "--observe", "v"]), ("lorenz", ["-i", "rk38"]),
                          ("ship", ["-i", "rk4_paper", "-c", "single"]),
                          ("ship", ["-i", "rk4", "--with", "fold-step", "--with", "fold-product"]),
                          ("ship", ["-i", "rk4_paper", "--with", "fold-step", "--with", "fold-product", "--with", "own-weights"]),
                          ("kepler", ["-i", "euler", "-c", "fused_full", "--double-single"]),
                          ("pendulum", ["-i", "rk4", "--with", "small-angles"])]:
        numbers = report(model(name), *options)
        for p in saved:
            saved[p] += numbers.get(f"pass {p}", 0)
    saved.pop("exact-division")  # which is for accuracy
    assert all(saved.values()), saved


def rounded(value):
    """To a float, ties to even; right for a sum or a product of two floats."""
    return struct.unpack("f", struct.pack("f", value))[0]


@pytest.mark.smoke
@pytest.mark.parametrize("config", ["single", "many", "dual"])
def test_with_own_weights_each_slope_goes_to_the_state_by_itself(tmp_path, config):
    """x + k1/6 + k2/3 + k3/3 + k4/6, from the left: for x' = -x by rk4, in FP32 as Python has it."""
    path, x, h, steps = written(tmp_path, "state x = 1", "x' = -x"), 1.0, 0.125, 20
    # From 16 steps on, another order has other bits.
    def stage(c, k):
        return rounded(h * rounded(x - c * k))
    for _ in range(steps):
        k = [h * x]                     # of the opposite sign
        k.append(stage(0.5, k[0]))
        k.append(stage(0.5, k[1]))
        k.append(stage(1, k[2]))
        for weight, slope in zip((1 / 6, 1 / 3, 1 / 3, 1 / 6), k):
            x = rounded(x - rounded(rounded(weight) * slope))
    options = ["-i", "rk4", "-c", config]
    bits = struct.unpack("I", struct.pack("f", x))[0]
    assert final(*compiled(tmp_path, str(path)[:-4], *options, "--with", "own-weights"), steps, config)["x", 0] == f"0x{bits:08x}"
    assert final(*compiled(tmp_path, str(path)[:-4], *options), steps, config)["x", 0] != f"0x{bits:08x}"


@pytest.mark.smoke
def test_the_folded_ship_with_own_weights_has_no_product_too_many():
    """24 operations: each of the four slopes has a product and a sum for T - C v, one for the state; s has one; and 3 stages."""
    ship = [model("ship"), "-i", "rk4_paper", "--with", "fold-step", "--with", "fold-product", "--with", "own-weights"]
    took = {config: report(*ship, "-c", config) for config in ("single", "many", "lanes", "dual")}
    assert [took[config]["cycles per object-step"] for config in took] == [32, 12, 1.5, 3]
    assert all(row["operations"] == 24 for row in took.values())


def test_own_weights_are_not_for_steps_that_are_chosen(tmp_path):
    texts = [fp3("compile", model("kepler"), *tolerance, *own).stdout.replace(" own-weights", "")
             for tolerance in (["--tolerance", "1e-4"], []) for own in ([], ["--with", "own-weights"])]
    assert texts[0] == texts[1] and texts[2] != texts[3]


def test_what_nobody_observes_costs_nothing():
    all_of_it, speed = (report(model("ship"), "-i", "rk4", *o)["operations"] for o in ([], ["--observe", "v"]))
    assert speed < all_of_it


def written(tmp_path, *lines, name="model.ode"):
    path = tmp_path / name
    path.write_text("\n".join([*lines, "step 0.125", "span 1", ""]))
    return path


def ends(path, *options, steps=3, config="single_full", settings=()):
    """The bits of every state after a run of the model itself, as compiled with these options."""
    image, params = path.with_suffix(".fp3"), path.with_suffix(".cfg")
    fp3("compile", path, "-c", config, *options, "--image", image, "--params", params,
        *[word for setting in settings for word in ("--set", setting)])
    return final(image, params, steps, config)


@pytest.mark.smoke
@pytest.mark.parametrize("seed, count, rtl", [("software", 600, 0.0), ("hardware", 150, 1.0)])
def test_random_models_have_the_bits_of_their_equations(tmp_path, seed, count, rtl):
    """Odd models, integrators, sets of passes and observed states, starts, visits."""
    cases = random_models.cases(seed, count, tmp_path, rtl)
    done = subprocess.run([os.path.join(BUILD, "tests", "random_models")], input="\n".join(cases) + "\n",
                          capture_output=True, text=True)
    answers = done.stdout.splitlines()
    bad = [(case, answer) for case, answer in zip(cases, answers) if answer.startswith("bad")]
    assert done.returncode == 0 and not bad and len(answers) == count, (bad[:3], cases[len(answers):][:1], done.stderr)
    assert answers.count("same") > 0.8 * count


def test_a_product_that_goes_the_chains_way_keeps_the_sign_of_zero(tmp_path):
    """Linear equations that start at -0 stay there; a product plus +0 would not."""
    names = "abcdef"
    path = tmp_path / "ring.ode"
    path.write_text("step 0.125\nspan 1\nparam p = 0.5\nparam q = 0.25\n" + "".join(f"state {x} = -0\n" for x in names) + "".join(
        f"{x}' = p*{y} + q*{z}\n" for x, y, z in zip(names, names[1:] + names[:1], names[2:] + names[:2])))
    image, params, source = (tmp_path / name for name in ("ring.fp3", "ring.cfg", "ring.s"))
    fp3("compile", path, "-c", "single_full", "--image", image, "--params", params, "-o", source)
    assert re.search(r"madd .*, -0\.0 ", source.read_text()), "no product goes the chain's way: take another model"
    assert set(final(image, params, 3, "single_full").values()) == {"0x80000000"}


def test_a_coefficient_0_has_no_term_whatever_the_slope(tmp_path):
    """The first slope of midpoint has the weight 0; here it is infinite."""
    path = written(tmp_path, "state v = 1e30", "v' = -v*v")
    assert ends(path, "-i", "midpoint", steps=1) == ends(path, "-i", "midpoint", "--without", "identity", steps=1)


@pytest.mark.parametrize("config", ["single_full", "many_full"])
def test_zeros_keep_their_signs(tmp_path, config):
    """a = -0 + h f is -0 where f is -0 and nowhere else; b is -0."""
    minus = ["b + (-0)", "(-0) + b", "b - 0", "b*1", "1*b", "b*0", "(-0) - (-b)", "-(-b)", "b/2", "min(0, b)", "max(0, b)"]
    plus = ["b + 0", "0 + b", "b - (-0)", "0 - b", "(-0) - b", "-b", "b*(-0)", "b*b", "abs(b)", "-(b + b)", "min(b, 0)", "max(b, 0)"]
    states = [f"a{i}" for i in range(len(minus + plus))]
    path = written(tmp_path, "state b = 0", *[f"state {a} = 0" for a in states],
                   "b' = -0", *[f"{a}' = {f}" for a, f in zip(states, minus + plus)])
    for passes in ([], ["--without", "all"]):
        got = ends(path, "-i", "euler", *passes, steps=1, config=config, settings=["b=-0.0", *[f"{a}=-0.0" for a in states]])
        for a, f in zip(states, minus + plus):
            assert got[a, 0] == ("0x80000000" if f in minus else "0x00000000"), f


def test_a_position_that_is_a_velocity_costs_a_splitting_its_order(tmp_path):
    chain = written(tmp_path, "state x = 1", "state v = 0", "state a = 0", "x' = v", "v' = a", "a' = -x")
    pair = written(tmp_path, "state x = 1", "state v = 0", "x' = v", "v' = -x", name="pair.ode")
    assert [report(path, "-i", "verlet")["order"] for path in (chain, pair)] == [1, 2]


def test_stoermer_keeps_the_position_that_an_observed_velocity_is_found_by(tmp_path):
    """... though its acceleration does not depend on it."""
    path = written(tmp_path, "state x = 1", "state v = 1", "state y = 1", "state w = 0",
                   "x' = v", "v' = -y", "y' = w", "w' = -y")
    whole = ends(path, "-i", "stoermer_verlet")
    part = ends(path, "-i", "stoermer_verlet", "--observe", "v")
    assert {("v", 0), ("x", 0)} <= part.keys() and part.items() <= whole.items()


def test_compensated_stoermer_keeps_what_rounding_takes_off_the_position_before(tmp_path):
    """Half a unit of x at -h is half a unit over h of v: 3e-4 of x and v here."""
    path = written(tmp_path, "state x = 1", "state v = 0.5", "x' = v", "v' = -x")
    for engine in ("isa", "fast"):
        done = fp3("run", path, "-i", "stoermer_verlet", "-k", "-c", "many_full", "-e", engine, "--steps", 8192, "--set", "h=0.0001220703125")
        found = {m[1]: float(m[2]) for m in re.finditer(r"^(x|v) +(\S+)", done.stdout, re.M)}
        assert abs(found["x"] - math.cos(1) - 0.5*math.sin(1)) < 3e-7 and abs(found["v"] + math.sin(1) - 0.5*math.cos(1)) < 3e-7, found


def test_what_nobody_observes_need_not_fit_the_integrator(tmp_path):
    path = written(tmp_path, "state x = 1", "state v = 1", "state e = 0", "x' = v", "v' = -x", "e' = v*v")
    assert "e" in fp3("compile", path, "-i", "stoermer_verlet", check=False).stderr
    assert {name for name, _ in ends(path, "-i", "stoermer_verlet", "--observe", "x")} == {"x", "v", "x_before"}


def test_a_power_of_0_is_1_below_a_line_too(tmp_path):
    path = written(tmp_path, "state x = 3", "x' = 1/x^0")
    assert "rcp" not in fp3("compile", path).stdout and ends(path, "-i", "euler", steps=8) == {("x", 0): "0x40800000"}


def test_a_scene_finds_its_integrator_beside_it(tmp_path):
    (tmp_path / "own.cfg").write_text(open(os.path.join(PROGRAMS, "integrators", "rk38.cfg")).read())
    scene = ('config = "many_full"; engine = "isa"; steps = 5;\n'
             'groups = ({ program = "%s"; integrator = "%s"; objects = 2; });\n')
    texts = []
    for name in ("own.cfg", "rk38"):
        (tmp_path / "x.scene").write_text(scene % (model("kepler"), name))
        texts.append(re.findall(r"0x\w{8}   object .", fp3("run", "--scene", tmp_path / "x.scene").stdout))
    assert len(texts[0]) == 8 and texts[0] == texts[1]


# ---- what a person reads ----

def test_comments_say_what_is_computed(tmp_path):
    text = fp3("compile", written(tmp_path, "state x = 1", "state y = 1", "y' = 0",
                                  "x' = (x < y or y < 2) and (x < 3) + (y + x) == (x < 4)"), "-i", "euler").stdout
    assert "x' = (x < y or y < 2) and (x < 3) + (y + x) == (x < 4)" in text
    long = written(tmp_path, "state x = 1", "x' = " + " + ".join(["x*x*x"] * 60))
    lines = fp3("compile", long, "-i", "euler", "--without", "common").stdout.splitlines()
    assert max(map(len, lines)) < 140 and not any("+  +" in line for line in lines)


@pytest.mark.smoke
def test_what_is_made_of_params_alike_is_kept_once(tmp_path):
    """However often the equations say it; and what is computed with it is computed once."""
    path = written(tmp_path, "param m = 4", "param k = 2", "state x = 1", "state y = 1", "state z = 1",
                   "x' = k*y + y*(k/m)", "y' = k*y - z*(k/m)", "z' = (2*k)*y - y*(k*2)")
    text = fp3("compile", path, "-i", "euler").stdout
    assert len(re.findall(r"^\.param", text, re.M)) == 4, text  # k, k/m, 2*k and k*2
    twice = written(tmp_path, "param k = 2", "state x = 1", "state y = 1", "x' = k*x + k*y", "y' = k*x - k*y")
    assert report(twice, "-i", "euler", "--without", "chain")["operations"] == 2 + 2 + 4  # products, sums, updates


def test_names_that_the_program_could_use_itself(tmp_path):
    """Each is asked for by the compiler, too; registers are checked by the compiler itself."""
    long = "x" * 31
    path = written(tmp_path, "param over_m = 2", "param m = 4", "state t0 = 1", "state t1 = 1", "state kept5 = 1",
                   f"state {long} = 1", f"state {'x' * 26} = 1", "state x_lost = 1", "state x = 1",
                   "t0' = t1/m*over_m", "t1' = -t0", f"kept5' = {long}", f"{long}' = -kept5", f"{'x' * 26}' = {long}",
                   "x' = x_lost", "x_lost' = -x")
    for integrator in ("verlet", "rk4"):
        assert len(ends(path, "-i", integrator, "-k")) == 14


@pytest.mark.smoke
def test_words_are_counted_with_loads_and_stores(tmp_path):
    """What the compiler lets through, the engine takes."""
    seen = set()
    for terms in range(499, 512):
        path = written(tmp_path, "param p = 0.5", "state x = 1", "state y = 1", "y' = 0",
                       "x' = p" + " - y" * terms)
        image, params = tmp_path / "c.fp3", tmp_path / "c.cfg"
        fits = fp3("compile", path, "-i", "euler", "-c", "many", "--image", image, "--params", params, check=False)
        if fits.returncode:
            assert re.search("words of instruction memory( with its loads and stores)?, configuration 'many' has 512; "
                             "'many_full' has 2048\n", fits.stderr), fits.stderr
        else:
            final(image, params, 1, "many")
        seen.add(fits.returncode)
    assert seen == {0, 2}


# ---- units of the hardware ----

@pytest.mark.smoke
@pytest.mark.parametrize("name, config, unit", [
    ("kepler", "single", "reciprocal = estimate or mixed"), ("ship_drag", "many", "select"), ("projectile", "lanes", "reciprocal = estimate or mixed"),
    ("pendulum", "single", "round")])
def test_a_configuration_without_the_unit_is_refused(name, config, unit):
    done = fp3("compile", model(name), "-c", config, check=False)
    assert done.returncode == 2 and f"needs `{unit}`" in done.stderr and config in done.stderr


def test_accuracy_of_what_is_made_of_division_roots_and_sines():
    most = {"1/x": 1.08, "a/x": 1.73, "1/x:large": 1.08, "a/x:large": 2.4, "sqrt(x)": 1.36, "1/sqrt(x)": 0.99, "a/sqrt(x)": 1.55, "sin(x)": 1.3e-7,
            "cos(x)": 2.4e-7, "sin(x):far": 1.3e-7, "cos(x):far": 2.4e-7, "tan(x)": 2.6, "tan(x):far": 4, "atan(x)": 2.5,
            "atan(x):-": 2.5, "asin(x)": 3.1, "acos(x)": 1.9, "atan2(x,a)": 4, "atan2:wide": 4}
    text = subprocess.run([os.path.join(BUILD, "tests", "accuracy")], capture_output=True, text=True, check=True).stdout
    found = {line.split()[0]: float(line.split()[1]) for line in text.splitlines()}
    assert found.keys() == most.keys()
    for name, limit in most.items():
        assert 0 < found[name] <= limit, (name, found[name])


BOUNDS = {
    "many_full": {"1/x": 1.0728, "a/x": 1.7247, "sqrt(x)": 1.3571, "1/sqrt(x)": 0.9898, "a/sqrt(x)": 1.5438},
    "flush": {"1/x": 1.0728, "a/x": 1.7247, "sqrt(x)": 1.0655, "1/sqrt(x)": 1.4011, "a/sqrt(x)": 2.0154},
    "cell": {"1/x": 1.1105, "a/x": 2.9988, "sqrt(x)": 1.6411, "1/sqrt(x)": 1.4638, "a/sqrt(x)": 3.9276},
    "middle": {"1/x": 1.1449, "a/x": 1.8569, "sqrt(x)": 1.6741, "1/sqrt(x)": 1.2690, "a/sqrt(x)": 1.9305},
    "bfloat": {"1/x": 0.7050, "a/x": 1.5000, "sqrt(x)": 1.3184, "1/sqrt(x)": 0.8782, "a/sqrt(x)": 1.6850},
}


def division_bounds(*arguments):
    return subprocess.run([os.path.join(BUILD, "tests", "division_bounds"), *map(str, arguments)], capture_output=True, text=True)


@pytest.mark.parametrize("config", [pytest.param(name, marks=[pytest.mark.long] if name in ("many_full", "flush", "cell") else []) for name in BOUNDS])
def test_no_quotient_or_root_is_further_off_than_the_pages_say(config):
    """Of every divisor; of quotients by intervals over all numerators."""
    done = division_bounds(config)
    assert done.returncode == 0, done.stdout
    assert {line.split()[0]: float(line.split()[2]) for line in done.stdout.splitlines()} == BOUNDS[config]


@pytest.mark.parametrize("entry", [0, 511, 1023, 1024, 1535, 1536, 2047])
def test_a_changed_entry_of_the_estimates_is_seen(entry):
    done = division_bounds("bfloat", entry)
    assert done.returncode == 1 and f"entry {entry} " in done.stdout


# ---- exact division ----

@pytest.mark.parametrize("config", ["single_full", "pairs"])
def test_exact_quotients_and_roots_are_those_of_the_host(config):
    """Random ones, a part of all fractions, and those next to a number halfway between two floats."""
    done = subprocess.run([os.path.join(BUILD, "tests", "exact_division"), "211", config], capture_output=True, text=True)
    counts = re.findall(r": (\d+) checked, 0 wrong", done.stdout)
    assert done.returncode == 0 and len(counts) == 3 and min(map(int, counts)) > 80000, done.stdout


@pytest.mark.smoke
@pytest.mark.parametrize("engine, config", [("isa", "single_full"), ("rtl", "single_full"), ("rtl", "many_full")])
@pytest.mark.parametrize("expression, values", [
    ("1/x", {"3": 1 / 3, "0": math.nan, "1e-40": math.nan, "-3e37": -1 / 3e37, "inf": math.nan}),
    ("x/(0*x + 3)", {"1": 1 / 3, "-2e38": -2e38 / 3, "0": 0, "2e-38": None, "3e-40": 1e-40}),
    ("(0*x + 3)/x", {"3e38": 1e-38, "7": 3 / 7, "2e-38": 1.5e38, "5e-39": math.nan}),
    ("sqrt(x)", {"2": math.sqrt(2), "0": 0, "3e38": math.sqrt(3e38), "1.40129846e-45": 2 ** -74.5, "-1": math.nan}),
])
def test_exact_division_on_the_hardware(tmp_path, engine, config, expression, values):
    for x, wanted in values.items():
        path = written(tmp_path, "state x = 1", "state y = 0", "x' = 0",
                       f"y' = {expression if x != 'inf' else expression.replace('x', '(x*x)')}")
        value, flags = one_value(path, config, engine, x if x != "inf" else "3e38", "--with", "exact-division")
        if wanted is not None:
            assert float(value) == pytest.approx(wanted, rel=1e-6, abs=3e-45, nan_ok=True), (x, value)
        if wanted is not None and math.isnan(wanted) and x != "-1":
            assert "invalid" in flags, (x, flags)


# ---- sine and cosine ----

FULL = ["single_full", "many_full", "sixteen", "shared_full"]


@pytest.mark.smoke
@pytest.mark.parametrize("config", FULL)
@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_a_pendulum_that_turns_over_is_where_it_should_be(engine, config):
    """Four half turns; the truth by GSL is 12.8537."""
    text = fp3("run", model("pendulum"), "-i", "rk4", "-c", config, "--engine", engine, "--steps", 128,
               "--set", "omega=8", "--set", "theta=0").stdout
    assert float(re.search(r"^theta +(\S+)", text, re.M)[1]) == pytest.approx(12.8537, abs=5e-4)


def one_value(path, config, engine, x, *options):
    """What y' = f(x) is, by a step of Euler's method with h = 1 from y = -0, and the exceptions that it raised."""
    image, params = path.with_suffix(".fp3"), path.with_suffix(".cfg")
    fp3("compile", path, "-i", "euler", "-c", config, "--set", f"x={x}", "--set", "h=1", "--set", "y=-0", *options,
        "--image", image, "--params", params)
    text = fp3("run", image, "-c", config, "--engine", engine, "--steps", 1, "--params", params, check=False).stdout
    return re.search(r"^y +(\S+)", text, re.M)[1], re.search(r"^flags +(.*)", text, re.M)[1].split()


@pytest.mark.smoke
@pytest.mark.parametrize("engine, config", [("isa", "single_full"), ("rtl", "single_full"), ("rtl", "many_full")])
def test_beyond_its_range_a_sine_is_a_flag_and_no_number(tmp_path, engine, config):
    for function in (math.sin, math.cos):
        for expression, scale, options in [(f"{function.__name__}(x)", 1, ()), (f"{function.__name__}(3*x)/4 + 0", 3,
                                                                               ["--with", "fold-product"])]:
            path = written(tmp_path, "state x = 1", "state y = 0", "x' = 0", f"y' = {expression}")
            for x in (65535.99, -65535.99):
                value, flags = one_value(path, config, engine, x / scale, *options)
                x = struct.unpack("f", struct.pack("f", x / scale))[0]
                x = struct.unpack("f", struct.pack("f", x * scale))[0]
                assert float(value) * (4 if scale > 1 else 1) == pytest.approx(function(x), abs=1e-6)
                assert flags == ["inexact"]
            for x in (65536, -65536, 1e9, -3e37):
                value, flags = one_value(path, config, engine, x / scale, *options)
                assert value == "nan" and {"invalid", "overflow"} <= set(flags), (expression, x, value, flags)


@pytest.mark.smoke
@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_small_angles_need_no_reduction_and_larger_ones_are_no_number(tmp_path, engine):
    for function in (math.sin, math.cos):
        path = written(tmp_path, "state x = 1", "state y = 0", "x' = 0", f"y' = {function.__name__}(x)")
        for x in (1.5707963, -1.5707963, 0.5):
            value, flags = one_value(path, "single", engine, x, "--with", "small-angles")
            assert float(value) == pytest.approx(function(x), abs=3e-7) and "invalid" not in flags
        for x in (1.570797, -1.570797, 3, 1e30):
            value, flags = one_value(path, "single", engine, x, "--with", "small-angles")
            assert value == "nan" and {"invalid", "overflow"} <= set(flags), (x, value, flags)


NAN = (math.nan, "invalid")  # value, and of invalid and overflow what is raised
OVER = (math.nan, "invalid overflow")


@pytest.mark.smoke
@pytest.mark.parametrize("engine, config", [("isa", "single_full"), ("rtl", "many_full")])
@pytest.mark.parametrize("function, values", [
    ("tan(x)", {"0": 0, "65535.99": math.tan(65535.98828125), "65536": OVER, "-3e38": OVER, "inf": NAN}),
    ("atan(x)", {"-0": "-0", "1": math.pi / 4, "-3e38": -math.pi / 2, "1e-40": 1e-40, "inf": NAN}),
    ("asin(x)", {"-0": "-0", "1": math.pi / 2, "-1": -math.pi / 2, "1.0000002": OVER, "-1.0000002": OVER, "-2": OVER, "inf": NAN}),
    ("acos(x)", {"0": math.pi / 2, "1": 0, "-1": math.pi, "1.0000002": OVER, "-1.0000002": OVER, "3e38": OVER, "inf": NAN}),
    ("atan2(x, 0*x + 1)", {"0": 0, "-0": 0, "1": math.pi / 4, "-3e38": -math.pi / 2, "1e-40": 1e-40, "inf": NAN}),
    ("atan2(x, 0*x - 1)", {"0": math.pi, "-0": math.pi, "-1": -3 * math.pi / 4, "1e-30": math.pi, "-1e-30": -math.pi}),
    ("atan2(x, 0*x)", {"0": 0, "-0": 0, "1e-37": math.pi / 2, "-3e38": -math.pi / 2, "1e-40": NAN}),
    ("atan2(x, x)", {"3e38": math.pi / 4, "-3e38": -3 * math.pi / 4, "1e-36": math.pi / 4, "1e-38": NAN}),
    ("atan2(0*x, x)", {"1": 0, "-1": math.pi, "-3e38": math.pi}),
])
def test_special_values_of_tangents_and_arcs(tmp_path, engine, config, function, values):
    for x, wanted in values.items():
        expression = function if x != "inf" else function.replace("x", "(x*x - x)")
        path = written(tmp_path, "state x = 1", "state y = 0", "x' = 0", f"y' = {expression}")
        value, flags = one_value(path, config, engine, x if x != "inf" else "3e38")
        found, raised = wanted if isinstance(wanted, tuple) else (wanted, "")
        raised = set(raised.split()) | ({"overflow"} if x == "inf" else set())
        assert set(flags) & {"invalid", "overflow"} == raised, (x, value, flags)
        if isinstance(found, str):
            assert value == found, x
        else:
            assert float(value) == pytest.approx(found, rel=5e-7, nan_ok=True), x


def test_a_configuration_that_cannot_reduce_angles_is_told_what_it_can_do():
    done = fp3("compile", model("pendulum"), "-c", "single", check=False)
    assert done.returncode == 2 and "sin(theta): needs `round`" in done.stderr and "pass `small-angles`" in done.stderr


# ---- errors ----

@pytest.mark.smoke
@pytest.mark.parametrize("arguments, text", [
    (["nowhere.ode"], "nowhere.ode"),
    ([model("ship"), "-i", "rk5"], "rk5"),
    ([model("ship"), "-c", "none"], "no configuration 'none'"),
    ([model("ship"), "--with", "magic"], "expected a pass"),
    ([model("ship"), "--observe", "w"], "no state 'w'"),
    ([model("ship"), "--params", "/dev/null", "--set", "w=1"], "no 'w'"),
    ([model("ship"), "--params", "/dev/null", "--set", "m=0"], "finite"),
    ([model("ship"), "--params", "/dev/null", "--set", "m=x"], "m=x"),
    ([model("ship"), "-i", "stoermer_verlet"], ":17:15: error: integrator"),
    ([model("lorenz"), "-i", "verlet"], "no state whose derivative is another state"),
    ([model("lorenz"), "-i", "verlet"], "lorenz.ode: "),
    ([model("ship"), "--set", "m=2"], "--params"),
    ([os.path.join(HERE, "large", "twelve_masses.ode"), "-c", "lanes"], "16"),
    ([model("arenstorf"), "-i", "rk6", "-c", "many_full"], None),
    ([], "expected a model"),
])
def test_errors(arguments, text):
    done = fp3("compile", *arguments, check=False)
    if text is None:
        assert done.returncode == 0
    else:
        assert done.returncode == 2 and text in done.stderr and not done.stdout


@pytest.mark.parametrize("lines, integrator, bound, free, made, given", [
    (["param n = 0.25", "param k = 4", "state x = 1", "x' = -k*x^n"], "euler", "p", ["h=0.25", "k=3", "x=0.5"],
     "n = 0.25", "n=0.5"),
    (["param m = 2", "state x = 1", "state v = 0.5", "x' = v", "v' = -x/m"], "stoermer_verlet", "x_before", [],
     "h = 0.125, m = 2, x = 1, v = 0.5", "h=0.25")])
def test_what_no_formula_gives_is_bound_to_what_it_depends_on(tmp_path, lines, integrator, bound, free, made, given):
    path = written(tmp_path, *lines)
    image, params = tmp_path / "b.fp3", tmp_path / "b.cfg"
    compiling = ("compile", path, "-i", integrator, "-c", "single_full", "--image", image)
    fp3(*compiling, "--params", params)
    kept = [final(image, params, 3, "single_full", setting) for setting in free]
    done = fp3("run", image, "-c", "single_full", "-e", "isa", "--params", params, "--set", given, check=False)
    assert re.fullmatch(rf"fp3 run: {params}:\d+: '{bound}\d*' was computed for {made}: compile again\n", done.stderr)
    assert done.returncode == 2 and not done.stdout
    for setting, bits in zip(free, kept):
        fp3(*compiling, "--params", params, "--set", setting)
        assert final(image, params, 3, "single_full") == bits


@pytest.mark.smoke
def test_params_of_one_object_are_constants_where_registers_run_short(tmp_path):
    """With the bits that they have as params."""
    path, ends_of = os.path.join(HERE, "large", "three_in_space.ode"), {}
    for config, kind in (("single_full", "shared"), ("many_full", "param")):
        assert re.search(rf"^\.{kind} +m1$", fp3("compile", path, "-c", config).stdout, re.M)
        image, params = tmp_path / "c.fp3", tmp_path / "c.cfg"
        fp3("compile", path, "-c", config, "--image", image, "--params", params, "--set", "m1=1.5", "--set", "m3=0.5")
        ends_of[config] = {name: bits for (name, number), bits in final(image, params, 50, config).items() if not number}
    assert ends_of["single_full"] == ends_of["many_full"] and len(ends_of["many_full"]) == 18
    assert ".param  m1" in fp3("compile", model("three_body")).stdout


LARGE = os.path.join(HERE, "large", "twelve_masses.ode")


@pytest.mark.smoke
@pytest.mark.parametrize("path, config, text", [
    (LARGE, "uncut", r"the program needs \d+ object registers, configuration 'uncut' has 32; 'single_full' has 64\n"),
    (LARGE, "lanes", r"the program needs 27 object registers, configuration 'lanes' has 16; 'many' has 32\n"),
    (LARGE, "paper", r"the program needs 572 words of instruction memory, configuration 'paper' has 512; "
                     r"'single_full' has 2048\n"),
    (model("lorenz"), "dual", r"the program needs \d+ object registers, configuration 'dual' has 32; 'shared_full' has 64\n"),
    (model("three_body"), "single_full", r"the program needs \d+ object registers, configuration 'single_full' has 64; "
                                         r"none has enough\n"),
])
def test_what_does_not_fit_names_the_nearest_configuration_that_it_fits(path, config, text):
    done = fp3("compile", path, "-i", "rk4" if path == LARGE else "rk6", "-k" if "lorenz" in path else "--without=dead",
               "-c", config, check=False)
    assert done.returncode == 2 and re.search(text, done.stderr) and not done.stdout, done.stderr


@pytest.mark.smoke
def test_constants_and_words_of_an_image_are_counted_against_the_configuration(tmp_path):
    """The nearest configuration with room must have the program's instructions, too."""
    numbers = written(tmp_path, "state x = 1", "x' = " + " + ".join(f"{i}.5*x" for i in range(70)))
    done = fp3("compile", numbers, "-c", "uncut", "-i", "euler", check=False)
    assert re.search(r"needs 4\d object registers, configuration 'uncut' has 32; 'single_full' has 64\n", done.stderr)
    done = fp3("compile", numbers, "-c", "dual", "-i", "euler", check=False)
    assert re.search(r"needs 7\d shared constants, configuration 'dual' has 32; none has enough\n", done.stderr), done.stderr
    source, image = tmp_path / "p.s", tmp_path / "p.fp3"
    source.write_text(".state x\nstep:\n" + "    addh x, x, x\n" * 600)
    fp3("asm", source, "-o", image)
    done = fp3("run", image, "-c", "many", "--set", "x=1", "--steps", 1, check=False)
    assert done.returncode == 2 and "needs 600 words of instruction memory, configuration 'many' has 512; " \
        "'shared_full' has 2048" in done.stderr, done.stderr
    source.write_text(".state x\nstep:\n    add r40, x, x\n    add x, x, r40\n")
    done = fp3("run", source, "-c", "paper", "--set", "x=1", "--steps", 1, check=False)
    assert done.returncode == 2 and "needs 41 object registers, configuration 'paper' has 32; 'single_full' has 64" in done.stderr


def test_a_number_beyond_fp32_is_told_with_its_equation(tmp_path):
    done = fp3("compile", written(tmp_path, "state x = 1", "x' = x*1e39"), check=False)
    assert done.returncode == 2 and "x' = x*1e+39: found 1e+39, expected a number below 3.4028236e38, the end of FP32" in done.stderr


@pytest.mark.smoke
@pytest.mark.parametrize("option, value", [("--most-steps", "-5"), ("--most-steps", "7"), ("--most-steps", "1e3"),
                                           ("--span", "inf"), ("--span", "nan"), ("--span", "0")])
def test_comparisons_refuse(option, value):
    done = fp3("compare", model("ship"), "--quick", "-i", "euler", f"{option}={value}", check=False)
    assert done.returncode == 2 and f"'{value}'" in done.stderr and not done.stdout


def test_nothing_is_written_after_an_error(tmp_path):
    bad = tmp_path / "bad.ode"
    bad.write_text("state v = 0\nv' = w\nstep 1\nspan 1\n")
    done = fp3("compile", bad, "-o", tmp_path / "x.s", "--image", tmp_path / "x.fp3", check=False)
    assert done.returncode == 2 and "bad.ode:2:6" in done.stderr and list(tmp_path.iterdir()) == [bad]

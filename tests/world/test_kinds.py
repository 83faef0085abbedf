"""Groups of a scene that see each other: physics in double, the same words on every engine, links across, what is refused."""

import re

import numpy as np
import pytest

K, STEP, PLAYERS, BALLS = 9000, 2 ** -8, 20, 200


def numbers(said):
    return np.array([int(bits, 16) for _, bits, _ in said], dtype=np.uint32).view(np.float32).astype(float)


def field(said):
    """Positions and speeds of all discs."""
    column = {name: numbers([one for one in said if one[0] == name]) for name in ("x_x", "x_y", "v_x", "v_y")}
    return np.stack([column["x_x"], column["x_y"]], 1), np.stack([column["v_x"], column["v_y"]], 1)


def discs_in_double(x, v, steps):
    """The law of players.ode and kicked.ode: leapfrog, by numpy."""
    R, m = (np.repeat(pair, (PLAYERS, BALLS)) for pair in ((0.4, 0.1), (62.5, 0.5)))
    for _ in range(steps):
        x = x + STEP / 2 * v
        way = x[None] - x[:, None]
        far = np.hypot(way[..., 0], way[..., 1]) + np.eye(len(x))
        push = K * np.minimum(far - (R[None] + R[:, None]) * (1 - np.eye(len(x))), 0) / far
        v = v + STEP * (push[..., None] * way).sum(1) / m[:, None]
        x = x + STEP / 2 * v
    return x, v


def test_players_in_double(words):
    begin = field(words("players.scene", "fast", "world", 1, "--steps", 0))
    for steps, worst in ((64, 2e-5), (128, 3e-4)):
        x, v = field(words("players.scene", "fast", "world", 1, "--steps", steps))
        expected_x, expected_v = discs_in_double(*begin, steps)
        assert np.abs(x - expected_x).max() < worst and np.abs(v - expected_v).max() < 100 * worst
    assert np.abs(expected_v[PLAYERS:]).max() > 3, "no ball was kicked"


def test_momentum_is_kept(words):
    """What a disc of one kind does to one of another, that one does to it."""
    m = np.repeat((62.5, 0.5), (PLAYERS, BALLS))[:, None]
    before, after = ((m * field(words("players.scene", "fast", "world", 1, "--steps", steps))[1]).sum(0) for steps in (0, 1024))
    assert np.abs(after - before).max() < 2e-6 * 20 * 62.5 * 3


def train_in_double(steps):
    """The law of train.ode and couplings.ode, by numpy: semi-implicit Euler, the force from the end of the step before."""
    m, k, kd, c, rest, h = 32768, 1048576, 2097152, 104857.6, 12, 2 ** -10
    x, v, q, F = -12.0 * np.arange(5), np.eye(5)[0], np.zeros(4), np.zeros(4)
    for _ in range(steps):
        pull = np.concatenate([[0], F]) - np.concatenate([F, [0]])
        way = x[:-1] - x[1:] - rest
        v = v + h * pull / m
        q = q + h * kd * (way - q) / c
        x = x + h * v
        way = x[:-1] - x[1:] - rest
        F = k * way + kd * (way - q)
    return {"x": x, "v": v, "q": q, "F": F}


@pytest.mark.parametrize("engine, steps", [("isa", 1024), ("fast", 4096), ("rtl", 32)])
def test_joints_that_are_objects(words, engine, steps):
    """Each has two ends and a state of its own, and the integrator moves positions, of which it has none."""
    said, expected = words("train.scene", engine, "world", 1, "--steps", steps), train_in_double(steps)
    for name, worst in (("x", 2e-4), ("v", 5e-4), ("q", 5e-5), ("F", 150)):
        assert np.abs(numbers([one for one in said if one[0] == name]) - expected[name]).max() < worst, name
    assert abs(numbers([one for one in said if one[0] == "v"]).sum() - 1) < 1e-5
    assert np.abs(expected["F"]).max() > 5e3 and np.abs(expected["q"]).max() > 5e-3


# Two kinds by every relation, and a third that stands still and is only read.
RODS = """\
model rods
kind pins(x [m], k [N/m])
kind nuts(x [m])
shared reach = 0.3 [m]
shared push  = 4 [N/m]
shared pull  = 0.01 [N/m]
param m = 0.5 [kg]
state x = 0 [m]
state v = 0 [m/s]
links held(pins, rest = 0.1 [m])
links own(k = 3 [N/m])
near  touch(x, nuts.x, reach)
all   every(nuts)
step  0.0078125 [s]
f = sum(o in held: o.k*(o.x - x - o.rest)) + sum(o in own: o.k*(o.x - x)) + sum(o in touch: push*(x - o.x)) + sum(o in every: pull*(o.x - x))
x' = v
v' = f/m
"""
NUTS = """\
model nuts
kind rods(x [m], m [kg])
shared reach = 0.3 [m]
shared push  = 4 [N/m]
shared pull  = 0.02 [N/kg/m]
param m = 0.25 [kg]
state x = 0 [m]
state v = 0 [m/s]
near  touch(x, rods.x, reach)
all   every(rods)
step  0.0078125 [s]
x' = v
v' = (sum(o in touch: push*(x - o.x)) + sum(o in every: pull*o.m*(o.x - x)))/m
"""
PINS = """\
model pins
param k = 20 [N/m]
state x = 0 [m]
step 0.0078125 [s]
x' = 0
"""
SCENE = """\
steps = 24;
groups = (
    {{ program = "rods.ode"; integrator = "{integrator}"; {how} grid = {{ position = "x"; count = 12; spacing = 0.11; }};
       links = ( {{ relation = "held"; file = "held.csv"; }}, {{ relation = "own"; grid = "structural"; }} ); {skin} }},
    {{ name = "pins"; program = "pins.ode"; integrator = "euler"; objects = 5; spread = {{ x = [0.0, 1.3]; k = [10.0, 30.0]; }}; }},
    {{ program = "nuts.ode"; integrator = "{integrator}"; {how} objects = 7; spread = {{ x = [-0.2, 1.5]; v = [0.5, -0.5]; }}; {skin} }}
);
"""
ENGINES = [("isa", "world", 1), ("fast", "world", 1), ("fast", "world", 2), ("rtl", "world", 1), ("rtl", "fabric", 1)]


@pytest.fixture
def rods(folder):
    def make(integrator="leapfrog", how="", skin=""):
        for name, text in (("rods", RODS), ("nuts", NUTS), ("pins", PINS)):
            (folder / f"{name}.ode").write_text(text)
        (folder / "held.csv").write_text("a,b,rest\n" + "".join(f"{i},{i * 7 % 5},{0.01 * i!r}\n" for i in range(12)))
        return put(folder, SCENE.format(integrator=integrator, how=how, skin=skin))
    return make


def put(folder, text):
    (folder / "x.scene").write_text(text)
    return folder / "x.scene"


@pytest.fixture
def words(start):
    def words(path, engine, config, threads, *options):
        done = start("--scene", path, "--engine", engine, "--config", config, "--all", *(["--threads", threads] if engine == "fast" else []), *options)
        assert done.returncode == 0, done.stderr
        return re.findall(r"^(\w+) +\S+ +0x([0-9a-f]{8})   object (\d+)$", done.stdout, re.M)
    return words


@pytest.mark.parametrize("integrator", ["euler", "leapfrog", "rk4", *[pytest.param(name, marks=pytest.mark.long) for name in ("semi_implicit_euler", "verlet", "heun", "yoshida6")]])
def test_words_are_the_same_everywhere(words, rods, integrator, long):
    found = [words(rods(integrator, skin=skin if engine == "fast" else ""), engine, config, threads)
             for engine, config, threads in ENGINES if long or (integrator, config) != ("rk4", "fabric") for skin in ("", "skin = 0.0;", "skin = 2.0;")[:3 if engine == "fast" else 1]]
    assert len(found[0]) == 2 * 12 + 5 + 2 * 7 and all(one == found[0] for one in found)


def test_compensated(words, rods):
    plain = words(rods(), "isa", "world", 1)
    found = [words(rods(how="compensated = true;"), *engine) for engine in ENGINES]
    assert all(one == found[0] for one in found) and found[0] != plain


def test_order_of_the_coupling(words, rods, folder):
    """Stages of one kind meet the same stages of the other: half the step, a sixteenth of the error by rk4, a quarter by leapfrog."""
    for integrator, order, h in (("rk4", 4, 0.125), ("leapfrog", 2, 0.03125)):
        path = rods(integrator)
        for name, text in (("rods", RODS), ("nuts", NUTS)):
            (folder / f"{name}.ode").write_text(text.replace("reach = 0.3", "reach = 100").replace("push  = 4", "push  = 0.1"))
        text = path.read_text()  # nothing switches, so all terms are smooth

        def run(divided, text=text, h=h):
            said = words(put(folder, text.replace("steps = 24;", f"steps = {4 * divided}; h = {h / divided!r};")), "isa", "world", 1)
            return numbers(said)
        truth = run(16)
        one, two = (np.abs(run(divided) - truth).max() for divided in (1, 2))
        assert 0.6 * 2 ** order < one / two < 1.8 * 2 ** order, (integrator, one, two)


def test_checkpoints(words, rods, folder):
    path = rods("leapfrog")
    whole = words(path, "isa", "world", 1)
    for engine, config, threads in ENGINES:
        file = folder / "half.checkpoint"
        file.unlink(missing_ok=True)
        words(path, engine, config, threads, "--steps", 11, "--checkpoint", file)
        assert words(path, engine, config, threads, "--steps", 24, "--restart", file) == whole


def test_links_the_other_way_round(words, rods, folder):
    path = rods()
    found = words(path, "isa", "world", 1)
    (folder / "held.csv").write_text("a,b,rest\n" + "".join(f"{i * 7 % 5},{i},{0.01 * i!r}\n" for i in range(12)))
    text = path.read_text().replace('file = "held.csv";', 'file = "held.csv"; swap = true;')
    assert words(put(folder, text), "isa", "world", 1) == found


@pytest.mark.parametrize("old, new, said", [
    ('name = "pins"; ', 'name = "needles"; ', "pins"),
    ("pins.ode", "nuts.ode", "has no state or param 'k'"),
    ('"own"; grid = "structural"', '"held"; grid = "structural"', "lead to objects of another group"),
    ('relation = "own"; grid = "structural";', 'relation = "own"; file = "held.csv"; swap = true;', "swap: the two ends of 'own' are objects of one group"),
    ('integrator = "leapfrog";  objects = 7', 'integrator = "verlet";  objects = 7', "one method"),
])
def test_refused(rods, refused, old, new, said):
    text = rods().read_text()
    assert old in text
    assert said in refused(text.replace(old, new, 1), "--engine", "isa")


def test_links_of_nobody(rods, refused, folder):
    path = rods()
    (folder / "held.csv").write_text("a,b,rest\n0,5,0.1\n")
    assert "joins object 0 with 5 of the other group" in refused(path.read_text(), "--engine", "isa")
    (folder / "held.csv").write_text("a,b,rest\n12,0,0.1\n")
    assert "found object 12, expected a whole number from 0 to 11" in refused(path.read_text(), "--engine", "isa")
    (folder / "held.csv").write_text("a,b,rest\n3,1,0.1\n3,1,0.2\n")
    assert "are joined twice" in refused(path.read_text(), "--engine", "isa")


def test_groups_that_do_not_see_each_other(refused, folder):
    (folder / "pins.ode").write_text(PINS)
    said = refused('groups = ( { program = "pins.ode"; objects = 1; }, { program = "pins.ode"; objects = 1; } );\nconfig = "world";\n')
    assert "found 2 groups that do not see each other" in said


def test_more_objects_than_an_order_takes(words, folder):
    """Engine fast puts more than 256 objects in order, cell by cell; guests stay behind them."""
    text = (folder / "players.scene").read_text().replace("objects = 200;", "objects = 450;").replace("objects = 20;", "objects = 60;").replace("14.0, 12.0", "24.0, 12.0")
    path = put(folder, text.replace("4.0, 12.0", "8.0, 12.0", 1).replace("[5.0, 0.0]", "[9.0, 0.0]"))
    found = [words(path, engine, "world", threads, "--steps", 200) for engine, threads in (("isa", 1), ("fast", 1), ("fast", 2))]
    assert len(found[0]) == 4 * 510 and found[0] == found[1] == found[2]


GRAIN = """model grain
kind ground(x)
state x = 0
state v = 0
near on(x, ground.x, 0.3, s = 0)
step 0.0078125
x' = v
v' = sum(o in on: 60*(x - o.x) + o.s)
project x = x + 0.01*sum(o in on: x - o.x)
when any(o in on: o.x > x): v = 0.99*v
remember o in on: o.s = o.s + h*v
"""


@pytest.mark.parametrize("integrator", ["semi_implicit_euler", "rk4"])
def test_near_ground_that_never_moves(words, folder, integrator):
    """Lists are made when a phase begins. So a grain that has moved since, in a step or by a projection, needs another one to look for the ground."""
    (folder / "grain.ode").write_text(GRAIN)
    (folder / "ground.ode").write_text("model ground\nstate x = 0\nstate v = 0\nstep 0.0078125\nx' = v\nv' = 0*v\n")
    found = [words(put(folder, f"""steps = 60; groups = (
        {{ program = "grain.ode"; integrator = "{integrator}"; objects = 9; spread = {{ x = [-3, 4]; v = [60, -40]; }}; skin = {skin}; }},
        {{ program = "ground.ode"; integrator = "{integrator}"; objects = 8; spread = {{ x = [-5, 5]; }}; }} );"""), engine, "world", 1)
             for engine, skin in (("isa", 30.0), ("isa", 0.3), ("fast", 0.0), ("rtl", 0.3))]
    assert found[0] == found[1] == found[2] == found[3]


def test_who_is_not_born_is_not_seen(words, rods, folder):
    """A run in which one pin and one nut live has the words of a scene that has no others."""
    text = rods().read_text().replace("steps = 24;", "steps = 9;")
    born = text.replace("k = [10.0, 30.0]; };", "k = [10.0, 30.0]; }; born = [0, 100];").replace("v = [0.5, -0.5]; };", "v = [0.5, -0.5]; }; born = [0, 100];")
    assert born.count("born") == 2
    found = [words(put(folder, born), *engine) for engine in ENGINES]
    assert all(one == found[0] for one in found)
    lonely = text.replace("objects = 5;", "objects = 1;").replace("objects = 7;", "objects = 1;")
    (folder / "held.csv").write_text("a,b,rest\n" + "".join(f"{i},{i * 7 % 5},{0.01 * i!r}\n" for i in range(12) if i * 7 % 5 == 0))
    alone = words(put(folder, lonely), "isa", "world", 1)
    assert [one[1] for one in alone[:24]] == [one[1] for one in found[0][:24]]


def test_who_is_gone_stays_where_it_was(words, rods, folder):
    text = rods().read_text()
    gone = text.replace("v = [0.5, -0.5]; };", "v = [0.5, -0.5]; }; gone = [4, 100];")
    found = [words(put(folder, gone), *engine) for engine in ENGINES]
    assert all(one == found[0] for one in found)
    early = words(put(folder, text.replace("steps = 24;", "steps = 4;")), "isa", "world", 1)
    first_nut = [i for i, one in enumerate(early) if one[2] == "17"]
    assert [found[0][i] for i in first_nut] == [early[i] for i in first_nut] and found[0][:24] != words(put(folder, text), "isa", "world", 1)[:24]


def test_recordings_have_one_group(words, start, folder):
    """Snapshots of either group, in its own order; the file is verified by the same command."""
    for group, first, count in (("players", 0, 20), ("balls", 20, 200)):
        done = start("--scene", "players.scene", "--steps", 40, "--output", "x.csv", "--every", 20, "--group", group, "--observe", "x_x,v_y")
        assert done.returncode == 0, done.stderr
        head, *rows = [line.split(",") for line in (folder / "x.csv").read_text().splitlines()]
        assert [row[0] for row in rows] == ["0"] * count + ["20"] * count + ["40"] * count and [row[2] for row in rows[:count]] == [str(i) for i in range(count)]
        for step, part in ((20, rows[count:2 * count]), (40, rows[2 * count:])):
            said = words("players.scene", "isa", "world", 1, "--steps", step)
            for column, name in ((3, "x_x"), (4, "v_y")):
                wanted = numbers([one for one in said if one[0] == name])[first:first + count]
                assert [np.float32(row[column]) for row in part] == list(wanted.astype(np.float32))


@pytest.mark.parametrize("options, said", [
    (("--output", "y.csv"), "--group says which"), (("--output", "y.csv", "--group", "cats"), "--group cats: 0 groups have this name, expected one"),
    (("--group", "balls"), "--group balls: nothing is recorded")])
def test_recordings_refused(start, folder, options, said):
    done = start("--scene", "players.scene", *options)
    assert done.returncode == 2 and said in done.stderr and not (folder / "y.csv").exists()

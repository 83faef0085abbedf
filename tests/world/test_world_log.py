"""Objects that see each other in logarithmic arithmetic (`world_log`), and with few bits (`world_bfloat`): the same words on every engine, whatever the skin, and who is near whom."""

import re
import subprocess

import numpy
import pytest
from test_living import LIVING, Scene
from test_remember import BREAKING, COUNTED, GRAINS, PLASTIC, fallen, plastic
from test_world import PILE, balls, fliers, row, script  # noqa: F401, pylint: disable=unused-import

ENGINES = [("isa", 1), ("fast", 1), ("fast", 3), ("interpreter", 1), ("rtl", 1)]


def words(line):
    return numpy.array([int(word, 16) for word in line.split()], dtype=numpy.uint32)


def numbers(line):
    """Of logarithms."""
    found = words(line)
    size = (found & 0x7fffffff).astype(float)
    return numpy.where(size, numpy.copysign(2.0 ** (size / 2**23 - 127), found.view(numpy.int32).astype(float)), 0)


def skins(lines):
    """Lists as short as can be, as they are, and with everybody in them."""
    return [[re.sub(r"^(near \S+ \S+) \S+", rf"\1 {skin}", line) for line in lines] for skin in ("0", "0.02", "3")]


@pytest.mark.parametrize("name, config, integrator", [
    pytest.param(name, config, integrator, marks=[pytest.mark.long] * (integrator == "rk4" and name in ("cloth", "stars", "balls")))
    for name in LIVING for config, integrator in (("world_log", "leapfrog"), ("world_log", "rk4"), ("world_bfloat", "leapfrog"))])
def test_engines_and_skins_have_the_same_words(script, name, config, integrator):  # noqa: F811
    """Links, near and all, one by one and together, with projections and every function."""
    model, lines, states = LIVING[name]
    found = {}
    for given in skins(lines):
        for engine, threads in ENGINES if given == skins(lines)[1] else ENGINES[:3]:
            told = script(model, [*given, "run 3", "run 8", f"print {states}", "failure"], f"{engine}@{config}", integrator, threads=threads)
            found[tuple(told)] = engine, threads
    assert len(found) == 1, found
    told = next(iter(found))
    assert len(set(told[0].split())) > 2 and told[-1] == "none"
    if config != "world_log":
        return
    ieee = script(model, [*lines, "run 11", f"print {states}"], "isa", integrator)
    for line, other in zip(told, ieee):
        ways = numpy.abs(numbers(line) - words(other).view(numpy.float32))
        assert numpy.median(ways) < 1e-4 and (name == "pile" or ways.max() < 2e-3), (line, other)  # a pile is chaotic


@pytest.mark.parametrize("config", ["world_log", "world_bfloat"])
@pytest.mark.parametrize("name", ["chain", "cloth", "balls", "kinds 17"])
def test_objects_that_come_and_go(script, name, config):  # noqa: F811
    scene = Scene(LIVING[name], 5, 19)
    found = {tuple(script(scene.model, scene.whole(3, skin), f"{engine}@{config}", "leapfrog", threads=threads))
             for engine, threads in ENGINES for skin in ((0.1, 0, 3) if engine != "rtl" else (0.1,))}
    assert len(found) == 1 and len(set(found.pop()[0].split())) > 2


def test_who_never_lives_is_in_nobodys_list(script):  # noqa: F811
    """The words of a scene without the last three."""
    scene = Scene(LIVING["kinds 17"], 5, 19)
    scene.born, scene.gone = numpy.where(numpy.arange(17) < 14, 0, 99), numpy.zeros(17, int)
    few = script(scene.model, [*scene.lines(list(range(14)), scene.columns), "run 19", "print " + " ".join(scene.states)], "isa@world_log")
    for engine, threads in ENGINES:
        assert [line.split()[:14] for line in script(scene.model, scene.whole(1), f"{engine}@world_log", threads=threads)] == [line.split() for line in few]


@pytest.mark.parametrize("config", ["world_log", "world_bfloat"])
@pytest.mark.parametrize("model, lines, states", [
    (GRAINS, fallen(24), "x_x x_y x_z v_x v_y v_z"), (PLASTIC, plastic(23)[-1], "x_x x_y v_x v_y"),
    (COUNTED, ["objects 12", row("state", "x", [3 * i for i in range(12)]), row("state", "v", [(-1) ** i for i in range(12)]), "near touch 4 1 x"], "x v s seen"),
    (BREAKING, ["objects 3", row("state", "x", [0, 3, 12]), row("state", "v", [0, -1, 1]), *(f"links ties {a} {b} 1 1" for a, b in ((0, 1), (1, 0), (1, 2), (2, 1)))], "x v")],
    ids=["grains", "plastic", "counted", "breaking"])
def test_pairs_remember(script, model, lines, states, config):  # noqa: F811
    found = {tuple(script(model, [*given, "run 5", "run 12", f"print {states}", "failure"], f"{engine}@{config}", "euler", threads=threads))
             for given in skins(lines)[1:] for engine, threads in ENGINES}
    assert len(found) == 1
    told = found.pop()
    assert told[-1] == "none" and len(set(told[0].split())) > 2


def test_many_in_an_order_of_their_own(script):  # noqa: F811
    """Engine fast sorts rows by where they are: by the numbers, not by their logarithms. Lists of everybody are made once: few steps."""
    for model, lines in ((PILE, balls(450)), (PILE, fliers(125))):
        *short, whole = skins(lines)
        for steps, kinds in ((40, short), (3, [short[0], whole])):
            found = {tuple(script(model, [*given, f"run {steps}", "print x_x v_z"], f"{engine}@world_log", threads=threads)) for given in kinds for engine, threads in ENGINES[:4]}
            assert len(found) == 1


COUNT = """
state x[2] = (0, 0)
state v[2] = (0, 0)
state n = 0
near touch(x, 0.01)
step 1
x' = v
v' = (0, 0)
n' = 0
project n = count(o in touch)
"""


@pytest.mark.parametrize("where", [(1000, 0), (0.3, -1000), (-3e4, 0.01)])
@pytest.mark.parametrize("speed", [0, 3e-5])
def test_far_from_the_origin_nobody_is_missed(script, where, speed):  # noqa: F811
    """A word stands for another number than the float next to it, by more than lists may be wrong. Pairs are as far apart as the reach, but for some last places."""
    random = numpy.random.default_rng(11)
    pairs = 20
    x = numpy.array([(where[0] + i * (0.08 + abs(where[0]) * 1e-5), where[1]) for i in range(pairs)])
    y = x + (numpy.array([[0.01, 0.0]]) + [[1, 0]] * random.uniform(-2e-4, 2e-4, (pairs, 1)))
    at = numpy.concatenate([x, y])[random.permutation(2 * pairs)]
    move = speed * random.standard_normal((2 * pairs, 2))
    head = [f"objects {2 * pairs}", *(row("state", f"{q}_{'xy'[k]}", of[:, k]) for q, of in (("x", at), ("v", move)) for k in range(2))]
    found = set()
    for skin in (0, 1e-4, 1):
        for engine, threads in ENGINES if speed == 0 or skin == 1e-4 else ENGINES[:3]:
            lines = [*head, f"near touch 0.01 {skin} x_x x_y", *["run 1", "print x_x x_y n"] * 4]
            found.add(tuple(script(COUNT, lines, f"{engine}@world_log", "euler", threads=threads)))
    assert len(found) == 1
    told, counts = found.pop(), 0
    for a, b, n in zip(told[::3], told[1::3], told[2::3]):
        now = numpy.stack([numbers(a), numbers(b)], 1)
        apart = numpy.sqrt(((now[:, None] - now[None]) ** 2).sum(2)) + 9 * numpy.eye(2 * pairs)
        least, most = ((apart < 0.01 * (1 + sign * 1e-6)).sum(1) for sign in (-1, 1))
        assert (least <= numbers(n) + 0.01).all() and (numbers(n) - 0.01 <= most).all()
        counts += most.sum()
    assert 0 < counts < 4 * 2 * pairs or where[0] == -3e4


@pytest.mark.parametrize("scene, steps", [("eight", 50), ("pair", 1000), ("players", 8), ("train", 8)])
def test_scenes(root, fp3, scene, steps):
    """Kinds, too."""
    said = {}
    for engine in ("isa", "fast", "rtl"):
        done = subprocess.run([fp3, "run", "--scene", root / f"programs/world/{scene}.scene", "-c", "world_log", "-e", engine, "-n", str(steps), "--all"],
                              capture_output=True, text=True, timeout=200)
        said.setdefault((done.returncode, done.stderr if done.returncode else tuple(re.findall(r" (0x\w+) +object (\d+)$", done.stdout, re.M))), []).append(engine)
    assert len(said) == 1 and next(iter(said))[0] == 0, said


def test_a_reach_that_is_a_small_difference(start, folder):
    """Of two shared params: the host computes it for the list as for the program, of the numbers that were given and not of their words, which are others."""
    (folder / "m.ode").write_text("shared A = 1000\nshared B = 999.99\nstate x = 0\nstate n = 0\nnear touch(x, A - B)\nstep 1\nx' = 0\nn' = 0\nproject n = count(o in touch)\n")
    (folder / "x.csv").write_text("x\n" + "".join(f"{i % 2 * (0.0099 + i * 2e-6) + i // 2}\n" for i in range(100)))
    said = set()
    for skin in (0, 3):
        for options in (("-e", "isa"), ("-e", "fast"), ("-e", "rtl")):
            (folder / "m.scene").write_text(f'steps = 1;\ngroups = ( {{ program = "m.ode"; integrator = "euler"; points = "x.csv"; skin = {skin:.1f}; }} );\n')
            done = start("--scene", "m.scene", "-c", "world_log", *options, "--all")
            assert done.returncode == 0, done.stderr
            said.add(tuple(re.findall(r"^n +(\S+) ", done.stdout, re.M)))
    assert len(said) == 1 and {"0", "1"} == set(said.pop()), said


def test_with_few_bits_a_list_reaches_farther(script):  # noqa: F811
    """A distance in bfloat16 may be wrong by more than a hundredth: objects beyond the reach are near for the program, so lists have them, too."""
    random = numpy.random.default_rng(4)
    at = random.uniform(0, 0.1, (250, 3))
    reach = (235.55 * 2**-18)**0.5  # whose square is rounded up
    model = COUNT.replace("[2]", "[3]").replace("(0, 0)", "(0, 0, 0)").replace("0.01", f"{reach:.9f}")
    head = ["objects 250", *(row("state", f"x_{'xyz'[k]}", at[:, k]) for k in range(3))]
    found = {tuple(script(model, [*head, f"near touch {reach} {skin} x_x x_y x_z", "run 1", "print x_x x_y x_z n"], f"{engine}@world_bfloat", "euler"))
             for engine in ("isa", "fast") for skin in (0, 1)}
    assert len(found) == 1
    x, y, z, n = (words(line).view(numpy.float32) for line in found.pop())
    now = numpy.stack([x, y, z], 1).astype(float)
    apart = numpy.sqrt(((now[:, None] - now[None]) ** 2).sum(2)) + 9 * numpy.eye(250)
    assert ((apart < 0.029).sum(1) <= n).all() and (n <= (apart < 0.031).sum(1)).all()

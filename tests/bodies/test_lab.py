"""make bodies: what theory says of its truths, against integrations that share nothing with the formulas; and the form of its file, without peers."""

import importlib
import json
import math
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

G = 10.0


@pytest.fixture(scope="module")
def part(root):
    """A module of tools/fp3bodies."""
    sys.path.insert(0, str(root / "tools"))
    yield lambda name: importlib.import_module(f"fp3bodies.{name}")
    sys.path.remove(str(root / "tools"))


@pytest.fixture(scope="module")
def formulas(part):
    return part("formulas")


def runge_kutta(slopes, y, h, count):
    """Each state from the first one on."""
    y = np.array(y, dtype=float)
    yield y
    for _ in range(count):
        a = slopes(y)
        b = slopes(y + h / 2 * a)
        c = slopes(y + h / 2 * b)
        y = y + h / 6 * (a + 2 * b + 2 * c + slopes(y + h * c))
        yield y


def rubbed(weight, pull, share, t, v=0.0, w=0.0, friction=0.2, slope=0.0, steep=1e4, h=5e-5):
    """Place and speed of a body of 1 kg on a line, whose surface turns with w: friction that is steep in the slip. pull: of its place."""
    x = 0.0
    for _ in range(round(t / h)):
        rub = -weight * friction * max(-1.0, min(1.0, steep * (v - w)))
        v += h * (rub + slope + pull(x))
        w -= h * rub / share if share else 0.0
        x += h * v
    return x, v


def test_sliding_and_rolling(formulas):
    """By steps of 50 us."""
    def free(_):
        return 0.0
    angle = math.pi / 6
    level = math.cos(angle) * G
    assert rubbed(level, free, 0, 1.0, friction=0.3, slope=G * math.sin(angle))[0] == pytest.approx(formulas.slid(angle, 0.3, G, 1.0), rel=1e-3)
    assert formulas.slid(angle, 0.6, G, 1.0) == 0 == pytest.approx(rubbed(level, free, 0, 0.2, friction=0.6, slope=G * math.sin(angle))[0], abs=1e-4)
    assert rubbed(G, free, 0, 0.5, v=2.0, friction=0.5)[0] == pytest.approx(formulas.braked(2.0, 0.5, G), rel=1e-3)
    for share in (0.5, 0.4):
        x, v = rubbed(G, free, share, 1.0, v=3.0)
        assert (v, x) == pytest.approx(formulas.rolled(3.0, 0.2, G, share, 1.0), rel=1e-3)
        assert rubbed(level, free, share, 0.5, friction=0.5, slope=G * math.sin(angle))[1] / 0.5 == pytest.approx(formulas.rolling(angle, G, share), rel=1e-3)


def test_what_bounces_and_what_stops(formulas):
    """By steps of 0.1 ms, each impact at the end of a step."""
    y, v, h = 5.0, 0.0, 1e-4
    for k in range(40000):
        assert y == pytest.approx(formulas.bounced(5.0, 0.8, G, k * h), abs=0.02)
        y, v = y + h * v - h * h * G / 2, v - h * G
        if y < 0 and v < 0:
            y, v = 0.0, -0.8 * v
    assert formulas.bounced(5.0, 0.8, G, 1000.0) == 0
    assert formulas.braked(5.0, 0.5, G, 0.5) == pytest.approx(rubbed(G, lambda _: 0.0, 0, 0.5, v=5.0, friction=0.5)[0], rel=1e-3)
    assert formulas.braked(5.0, 0.5, G, 1.0) == formulas.braked(5.0, 0.5, G, 9.0) == formulas.braked(5.0, 0.5, G) == 2.5


def test_a_block_on_a_belt(formulas):
    """In the belt's frame, in which the spring's end moves."""
    most, x, v, h = 0.0, 0.0, 0.5, 2e-5
    for _ in range(75000):
        v += h * (-0.4 * G * max(-1.0, min(1.0, 1e4 * (v - 0.5))) - 20.0 * x)
        x += h * v
        most = max(most, x)
    assert most == pytest.approx(formulas.swing(0.4, G, 20.0, 1.0, 0.5), rel=1e-3)


def test_pendulums(formulas):
    length, about = 1.0, 1.02
    states = np.array(list(runge_kutta(lambda y: np.array([y[1], -G * length / about * math.sin(y[0])]), (1.0, 0.0), 2e-3, 1250)))
    down = [k + a / (a - b) for k, (a, b) in enumerate(zip(states[:, 0], states[1:, 0])) if a * b < 0]
    assert 2 * (down[1] - down[0]) * 2e-3 == pytest.approx(formulas.period(about, 1.0, length, G, 1.0), rel=1e-6)

    def slopes(y):
        """Rods of 1 kg and 1 m as free bodies (x, y, angle from the x axis), and the forces of their pins."""
        p, u = y.reshape(2, -1, 3)
        count = len(p)
        arms = np.stack([-np.sin(p[:, 2]), np.cos(p[:, 2])], 1) / 2  # how the end of a rod moves if it turns
        jacobian, turning = np.zeros((2 * count, 3 * count)), np.zeros(2 * count)
        for k in range(count):
            at = slice(2 * k, 2 * k + 2)
            jacobian[at, 3 * k:3 * k + 3] = [[-1, 0, arms[k, 0]], [0, -1, arms[k, 1]]]
            turning[at] += [-arms[k, 1] * u[k, 2] ** 2, arms[k, 0] * u[k, 2] ** 2]
            if k:
                jacobian[at, 3 * k - 3:3 * k] = [[1, 0, arms[k - 1, 0]], [0, 1, arms[k - 1, 1]]]
                turning[at] += [-arms[k - 1, 1] * u[k - 1, 2] ** 2, arms[k - 1, 0] * u[k - 1, 2] ** 2]
        inverse, free = np.diag([1, 1, 12.0] * count), np.array([0, -G, 0] * count)
        pins = np.linalg.solve(jacobian @ inverse @ jacobian.T, -turning - jacobian @ free)
        return np.concatenate([u.ravel(), free + inverse @ jacobian.T @ pins])
    for count in (2, 4):
        start = [number for k in range(count) for number in (k + 0.5, 0, 0)]
        *_, last = runge_kutta(slopes, start + [0] * (3 * count), 2e-3, 500)
        expected = formulas.rods((math.pi / 2,) * count, 1.0, 1 / 12, 1.0, G, 1.0, steps=1000)[-1]
        assert last[2:3 * count:3] == pytest.approx(expected - math.pi / 2, abs=1e-5)


def test_what_hangs_and_what_stands(formulas, part):
    slopes, along = formulas.hung(2, 1.0, 3.0, 1.2)
    assert slopes == pytest.approx([-0.8 / 0.6, 0.8 / 0.6]) and along == pytest.approx(1.5 * 0.6 / 0.8)  # each carries half its weight across to the middle
    slopes, _ = formulas.hung(4000, 5 / 4000, 1.0, 3.0)
    sag = -(5 / 4000 * np.sin(np.arctan(slopes)))[:2000].sum()
    low, high = 0.1, 10.0  # y = a cosh(x/a)
    for _ in range(100):
        a = (low + high) / 2
        low, high = (a, high) if 2 * a * math.sinh(1.5 / a) > 5.0 else (low, a)
    assert sag == pytest.approx(a * (math.cosh(1.5 / a) - 1), rel=1e-5)
    assert formulas.thinnest() == pytest.approx(0.1075, abs=3e-4)
    for share, stands in ((0.98, False), (1.02, True)):
        assert thrust_is_inside(part("truths").voussoirs(12, 1.0, share * formulas.thinnest(12)), share * formulas.thinnest(12), part("scene")) is stands
    assert formulas.tension(19, 20, 1.0, 1000.0, G) == 10010.0


def thrust_is_inside(arch, thick, scene):
    """Forces from stone to stone, from the crown down, for many pulls and places at the crown."""
    stones = [(stone.at[0], scene.mass(stone, 2)[0]) for stone in arch.bodies[1:7][::-1]]
    joints = [(math.cos(a), math.sin(a)) for a in (math.pi / 2 - (k + 1) * math.pi / 12 for k in range(6))]

    def stays(high, along):
        x, y, down = 0.0, high, 0.0
        for (at, weight), (c, s) in zip(stones, joints):
            y -= down * (at - x) / along  # along the line of the force to above the stone, where its weight joins
            x, down = at, down + weight
            t = (y * c - x * s) / (along * s + down * c)  # and on to the joint
            if abs((x + t * along) * c + (y - t * down) * s - 1) > thick / 2 + 1e-9:
                return False
        return True
    return any(stays(high, along * thick) for high in np.linspace(1 - thick / 2, 1 + thick / 2, 21).tolist() for along in np.linspace(0.3, 0.8, 300).tolist())


def test_tops(formulas):
    for moments, spin in (((0.1, 0.2, 0.3), (0.05, 5.0, 0.05)), ((1.0, 2.0, 3.5), (0.1, 1.0, 0.02))):
        a, b, c = moments
        rate = spin[1]
        h = 0.02 / rate
        shares = np.array([(b - c) / a, (c - a) / b, (a - b) / c])
        w = np.array(list(runge_kutta(lambda y: shares * y[[1, 2, 0]] * y[[2, 0, 1]], spin, h, 4000)))[:, 1]  # pylint: disable=cell-var-from-loop
        zeros = [k + p / (p - q) for k, (p, q) in enumerate(zip(w, w[1:])) if p * q < 0]
        assert len(zeros) > 2 and (zeros[-1] - zeros[0]) / (len(zeros) - 1) * h == pytest.approx(formulas.flips(moments, spin), rel=1e-5)
    across, along, spin, torque, tilt = 0.06, 0.04, 20.0, 2.0, math.pi / 3
    rate = formulas.precession(across, along, spin, torque, math.cos(tilt))

    def slopes(y):
        """The axis and the angular momentum about the pivot, z up: the axis moves with the part of the momentum across it."""
        axis, momentum = y[:3], y[3:]
        return np.concatenate([np.cross(momentum / across, axis), np.cross(axis, [0, 0, -torque])])
    axis = np.array([math.sin(tilt), 0, math.cos(tilt)])
    w = np.array([0, 0, rate]) + (spin - rate * math.cos(tilt)) * axis
    momentum = across * (w - (w @ axis) * axis) + along * (w @ axis) * axis
    *_, last = runge_kutta(slopes, [*axis, *momentum], 4e-3, 250)
    assert last[2] == pytest.approx(math.cos(tilt), abs=1e-6) and math.atan2(last[1], last[0]) == pytest.approx(rate, rel=1e-6)


def test_dominoes(formulas):
    """Contacts as stiff springs that only dampers unload, by steps of 0.2 ms."""
    h, d, s, count, step = 1.0, 0.15, 0.35, 24, 2e-4
    angle, w, begins = np.zeros(count), np.zeros(count), np.full(count, np.nan)
    w[0] = 1.0
    about = d * h * (h * h + d * d) / 3
    for k in range(20000):
        sine, cosine = np.sin(angle), np.cos(angle)
        # the tip of each in the axes of the next one, whose back is d from its pivot
        x, y = h * sine[:-1] - (s + d), h * cosine[:-1]
        deep = x * cosine[1:] - y * sine[1:] + d
        lever = h * np.cos(angle[:-1] - angle[1:])
        up = x * sine[1:] + y * cosine[1:]
        press = np.where(deep > 0, np.maximum(0.0, 1e5 * deep + 150.0 * (lever * w[:-1] - up * w[1:])), 0.0)
        torque = G * d * h / 2 * (h * sine - d * cosine)
        torque[:-1] -= press * lever
        torque[1:] += press * up
        w += step * torque / about
        angle += step * w
        w, angle = np.where((angle < 0) & (w < 0), 0.0, w), np.maximum(angle, 0.0)
        begins = np.where(np.isnan(begins) & (angle > 0.05), k, begins)
        if angle[22] > 0.05:
            break
    assert 10 * (s + d) / ((begins[22] - begins[12]) * step) == pytest.approx(formulas.wave(h, d, s, G), rel=0.02)


def test_moments(part):
    """Against sums over a fine grid."""
    scene = part("scene")
    x, y = np.meshgrid(*[(np.arange(800) + 0.5) / 400 - 1] * 2)
    corners = ((-0.5, -0.3), (0.6, -0.2), (0.4, 0.5), (-0.4, 0.4))
    area, centre, _ = scene.polygon(corners)
    corners = tuple((a - centre[0], b - centre[1]) for a, b in corners)
    inside = np.ones_like(x, bool)
    for (a, b), (c, e) in zip(corners, corners[1:] + corners[:1]):
        inside &= (c - a) * (y - b) - (e - b) * (x - a) > 0
    capsule = np.hypot(np.maximum(abs(x) - 0.3, 0), y) < 0.2
    for shape, size, within in (("polygon", corners, inside), ("capsule", (0.3, 0.2), capsule), ("box", (0.5, 0.25), (abs(x) < 0.5) & (abs(y) < 0.25)),
                                ("disc", (0.4,), np.hypot(x, y) < 0.4)):
        found = scene.moments(scene.Body(shape, size, (0.0, 0.0)), 2)
        assert (found[0], found[1][0]) == pytest.approx((within.sum() / 400 ** 2, ((x * x + y * y) * within).sum() / 400 ** 2), rel=3e-3), shape
    assert area == pytest.approx(inside.sum() / 400 ** 2, rel=3e-3)


def test_overlaps(part):
    """A box that turns into another, and one that is held; the scene's own start has none."""
    scene, standing = part("scene"), part("standing")
    boxes = scene.Scene("three", [scene.ground(5.0)] + [scene.Body("box", (0.5, 0.5), at) for at in ((0.0, 0.5), (1.1, 0.5), (0.0, 1.5))])
    x, angle = np.array([body.at for body in boxes.bodies]), np.zeros(4)
    assert standing.deepest(boxes, x, angle) == pytest.approx(0, abs=1e-12)
    angle[2] = math.pi / 4
    assert standing.deepest(boxes, x, angle) == pytest.approx(math.sqrt(0.5) - 0.5)  # its corner in the ground
    x[2] += (0.0, 1.0)
    assert standing.deepest(boxes, x, angle) == pytest.approx(math.sqrt(0.5) - 0.6)  # and in the box beside it
    pyramid = scene.pyramid(20)
    assert standing.deepest(pyramid, np.array([body.at for body in pyramid.bodies]), np.zeros(len(pyramid.bodies))) == pytest.approx(0, abs=1e-9)


@pytest.fixture(scope="module")
def lab(root, tmp_path_factory):
    """make bodies with engines of its own, by a Python that is only pretended."""
    python = tmp_path_factory.mktemp("python") / "python"
    python.write_text(f'#!/bin/sh\nshift\nexec {sys.executable} {root}/tests/bodies/lab_engine.py "$@"\n')
    python.chmod(0o755)

    def lab(*options, cut=None):
        """cut: it is ended as soon as this is true of its file."""
        path = tmp_path_factory.mktemp("lab") / "bodies.json"
        command = [sys.executable, root / "tools/bodies.py", "--quick", "--peers", python, "--output", path, *options]
        if cut:
            with subprocess.Popen(command, stderr=subprocess.DEVNULL, start_new_session=True) as process:
                end = time.monotonic() + 100
                while not (path.exists() and cut(json.loads(path.read_text()))) and time.monotonic() < end and process.poll() is None:
                    time.sleep(0.05)
                is_cut = process.poll() is None and time.monotonic() < end
                os.killpg(process.pid, signal.SIGKILL)
            assert is_cut
            return None
        done = subprocess.run(command, capture_output=True, text=True, timeout=100)
        return done, json.loads(path.read_text()) if path.exists() else None
    return lab


def test_the_form_of_its_file(lab, part):
    done, found = lab("--engines", "falls")
    assert done.returncode == 0, done.stderr
    rows = {row["what"]: row for row in found["truths"]}
    assert {tuple(sorted(row)) for row in found["truths"]} == {tuple(sorted(("test", "what", "expected", "found", "within", "holds", "source", "peer")))}
    assert {what: row["holds"] for what, row in rows.items()} == {what: what.startswith("its amplitude") for what in rows}  # it falls past everything
    assert rows["period of a pendulum of 1 m from 1 rad, s"]["found"] is None
    of, = [row for row in found["standing"] if row["scene"] == "pyramid 10"]
    assert of["engine"] == "falls" and of["sag"] == pytest.approx(G * 2 * 2 / 2, rel=0.02)
    assert of["floor_force"] == pytest.approx(0, abs=1e-9) and of["drift"] == 0
    row, = found["speed"]
    assert row["ns_per_body_step"] > 0 and (row["scene"], row["engine"], row["threads"], row["bodies"], row["substeps"]) == ("pyramid 10", "falls", 1, 55, 4)
    page = "\n".join(part("report").page(found))
    assert "| pyramid 10 | falls | 55 | 20 |" in page and "**none**" in page
    errors = {(row["scene"], row["substeps"]): row for row in found["error"]}
    assert set(errors) == {(run, substeps) for run in ("sliding block", "bounces") for substeps in (1, 4)}
    t = np.arange(1, 91) / 60  # what falls past its floor goes on at 5 m/s
    past = np.stack([5 * t - np.where(t < 1, 5 * t - 2.5 * t * t, 2.5), G / 2 * t * (t + 1 / 60)])
    assert errors["sliding block", 4]["error"] == pytest.approx(math.sqrt((past ** 2).sum(0).mean()), rel=1e-9) and errors["bounces", 1]["ns_per_body_step"] > 0


def test_who_is_beaten(part):
    """In error, for as much time; by whom, in words."""
    report = part("report")
    rows = [{"engine": engine, "substeps": substeps, "error": error, "ns_per_body_step": ns} for engine, substeps, error, ns in
            (("fp3", 1, 0.1, 100), ("fp3", 4, 0.01, 200), ("quick", 1, 0.05, 90), ("exact", 1, 1e-6, 900), ("lost", 1, None, 10))]
    assert [row["engine"] for row in report.beats(rows)] == ["fp3", "quick", "exact"]
    assert list(report.worse(rows)) == ["With 1 substep FP3 is beaten by *quick*.", "A smaller error than FP3 ever reaches has *exact*."]
    assert list(report.worse(rows[:1] + rows[2:])) == ["With 1 substep FP3 is beaten by *quick*.",
                                                       "A smaller error than FP3 ever reaches have *quick* and *exact*."]
    assert list(report.worse(rows[:2])) == list(report.worse(rows[2:])) == []
    head, lines = report.error(rows)
    assert head == ["substeps", "1", "4"]
    assert list(lines) == [["fp3", "0.1, 100", "**0.01**, 200"], ["quick", "**0.05**, 90", ""], ["exact", "**1e-06**, 900", ""], ["lost", "none, 10", ""]]


def test_an_engine_that_fails_is_named(lab):
    done, found = lab("--engines", "falls", "fails", "--parts", "speed")
    assert done.returncode == 1 and "fails: ValueError: it fails" in done.stderr
    assert [row["engine"] for row in found["speed"]] == ["falls"]


def test_an_engine_that_does_not_answer_is_slower(lab):
    done, found = lab("--engines", "hangs", "--parts", "truths", "--limit", "1")
    assert done.returncode == 0, done.stderr
    assert found["truths"] == [] and found["truths_refused"] == [{"test": test, "why": "slower than 1 s", "peer": "hangs"} for test in ("slope", "pendulum")]


def test_rows_are_kept_of_a_part_that_is_cut(lab):
    lab("--engines", "falls", "hangs", "--parts", "standing", cut=lambda found: found["standing"][0]["engine"] == "falls")


def test_one_hash_a_scene(part, build, monkeypatch):
    """By laws that are built in and by all engines; a row with another hash is told."""
    monkeypatch.setenv("FP3_HOME", str(build))
    hashes, said = part("hashes"), []
    rows = hashes.measure(True, said.append)
    assert {row["engine"] for row in rows} == {"built in", "isa", "fast", "rtl"} and len(said) == len(rows)
    assert len(rows) == 28 + 3 * len(list(hashes.kinds()))  # three scenes by each kind of vectors that this processor has
    assert {row["variant"] for row in rows if "why" in row} <= {"2 ranks"}
    assert hashes.differing(rows) == [] and len({row["hash"] for row in rows if "hash" in row}) == 6
    report = part("report")
    assert list(report.not_run([{"scene": "car", "variant": "2 ranks", "why": "no MPI"}])) == ["", "Not run: *2 ranks* of car (no MPI)."]
    rows[3]["hash"] = rows[-3]["hash"]
    assert hashes.differing(rows) == [rows[3]]
    page = list(report.runs(rows))
    assert page[1][3] == 1 and len(page) == 7 and sum(line[3] for line in page) == sum("hash" in row for row in rows)


def test_errors_of_fp3_fall_with_substeps(part, build, monkeypatch):
    """Where joints and friction are, by more than half the order; bounces are right with the first one."""
    monkeypatch.setenv("FP3_HOME", str(build))
    error, make = part("error"), part("by_fp3").Made
    found = {run: [error.error(run, make(error.scene(run, substeps))) for substeps in (4, 16)] for run in ("double pendulum", "bounces", "sliding block")}
    for run, most in (("double pendulum", 0.02), ("sliding block", 0.01)):
        assert found[run][1] < found[run][0] / 2 < most / 2, found
    assert max(found["bounces"]) < 1e-3, found


def test_cycles_are_those_foreseen(part, build, monkeypatch):
    """Of each law that dominoes have, in a step on the hardware."""
    monkeypatch.setenv("FP3_HOME", str(build))
    chip = part("chip")
    rows = chip.measure(True, str)
    assert {"contact2", "gap2", "warm2", "pin2"} == {row["law"] for row in rows} and chip.wrong(rows) == []
    rows[0]["foreseen"] += 1
    assert chip.wrong(rows) == rows[:1] and len(list(part("report").cycles(rows))) == 4


def test_fp3_holds_what_it_held(part, build, monkeypatch):
    """Truths of friction, impacts and joints, by bodies of FP3; not so with another friction than theory takes it for."""
    monkeypatch.setenv("FP3_HOME", str(build))
    truths, make = part("truths"), part("by_fp3").Made
    for truth in (truths.slope, truths.braking, truths.slide_and_roll, truths.roll_down, truths.belt, truths.pendulum, truths.double_pendulum,
                  truths.bounces, truths.cradle, truths.wall):
        rows, _ = truths.measure(truth, make)
        assert rows and all(row["holds"] for row in rows), rows

    def rougher(scene):
        for body in scene.bodies:
            body.friction *= 1.01
        return make(scene)
    assert not any(row["holds"] for row in truths.measure(truths.braking, rougher)[0])

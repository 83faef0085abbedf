"""programs/world beside theory: frequencies of normal modes, momentum, energy, Kepler's third law, weight on the floor; and the same bits."""

import math

import pytest

SCENES = {"chain": 2560, "cloth": 8192, "balls": 4096, "planets": 2048}


@pytest.mark.parametrize("name", SCENES)
def test_engines_give_the_same_bits(record, name):
    runs = [record(f"{name}.scene", "--steps", 40, "-e", engine) for engine in ("fast", "isa")]
    assert runs[0] == runs[1]
    assert runs[0][0] != runs[0][-1]


def test_each_scene_runs_as_it_stands(record):
    for name, steps in SCENES.items():
        assert record(f"{name}.scene")[-1][0]["step"] == steps


MASSES, K = 12, 100.0
CHAIN = """steps = {steps};
groups = ( {{ program = "chain.ode"; integrator = "rk4"; grid = {{ count = 14; }}; points = "mode.csv";
  links = {{ relation = "springs"; grid = "structural"; }}; only = {{ objects = [0, 13]; set = {{ w = 0.0; }}; }}; }} );
"""


@pytest.mark.parametrize("mode", [1, 2, 5, 12])
def test_a_normal_mode_swings_with_its_frequency(record, folder, mode):
    """u_i = sin(mode pi i/(N+1)) cos(w t), w = 2 sqrt(k/m) sin(mode pi/(2(N+1))): over several periods, and no other mode grows."""
    shape = [math.sin(mode * math.pi * i / (MASSES + 1)) for i in range(MASSES + 2)]
    (folder / "mode.csv").write_text("u\n" + "".join(f"{value:.9g}\n" for value in shape))
    omega = 2 * math.sqrt(K) * math.sin(mode * math.pi / (2 * (MASSES + 1)))
    end = 3 * 2 * math.pi / omega
    steps = round(end * 128)
    for snapshot in record(CHAIN.format(steps=steps), "--every", max(1, steps // 20)):
        cosine = math.cos(omega * snapshot[0]["time"])
        for value, one in zip(shape, snapshot):
            assert one["u"] == pytest.approx(value * cosine, abs=2e-4)
        assert snapshot[0]["u"] == 0 and abs(snapshot[-1]["u"]) < 1e-6  # held


FREE = """steps = 2000;
groups = ( { program = "balls.ode"; integrator = "semi_implicit_euler"; points = "free.csv"; set = { g_y = 0.0; side = 100.0; }; } );
"""


def test_free_balls_keep_their_momentum(record, folder):
    """A crowd that flies apart, far from walls: each push has its opposite, so the sum stays but for rounding."""
    rows = [(50 + 0.08 * (i % 4), 50 + 0.08 * (i // 4 % 4), 50 + 0.08 * (i // 16), 0.1 * ((i * 37) % 11 - 5)) for i in range(64)]
    (folder / "free.csv").write_text("x_x,x_y,x_z,v_x\n" + "".join(",".join(f"{v:.9g}" for v in row) + "\n" for row in rows))
    first, last = record(FREE)
    size = sum(abs(one["v_x"]) for one in last)
    assert size > 10 and max(one["x_x"] for one in last) > max(one["x_x"] for one in first) + 0.5
    for axis in "xyz":
        before, after = (sum(one["v_" + axis] for one in snapshot) for snapshot in (first, last))
        assert abs(after - before) < 2e-5 * size


SETTLE = """steps = 12288;
groups = ( { program = "balls.ode"; integrator = "semi_implicit_euler"; objects = 60; set = { side = 0.5; };
  random = { position = "x"; from = [0.05, 0.1, 0.05]; to = [0.45, 1.5, 0.45]; apart = 0.1; seed = 3; }; } );
"""


def test_balls_at_rest_press_the_floor_with_their_weight(record):
    last = record(SETTLE)[-1]
    assert max(abs(one["v_y"]) for one in last) < 2e-3
    floor = sum(100 * max(0, 0.05 - one["x_y"]) for one in last)
    assert floor == pytest.approx(60 * 0.01 * 9.81, rel=2e-3)
    walls = sum(100 * (max(0, 0.05 - one["x_x"]) - max(0, one["x_x"] - 0.45)) for one in last)
    assert abs(walls) < 1e-2 and min(one["x_y"] for one in last) > 0


def energy(bodies, m, G=39.478418):
    place = [tuple(one["x_" + axis] for axis in "xyz") for one in bodies]
    motion = sum(m[i] * sum(one["v_" + axis] ** 2 for axis in "xyz") / 2 for i, one in enumerate(bodies))
    return motion - sum(G * m[i] * m[j] / math.dist(place[i], place[j]) for i in range(len(m)) for j in range(i))


def test_planets_keep_energy_and_momentum_and_their_periods(record, folder):
    m = [float(line.split(",")[0]) for line in (folder / "planets.csv").read_text().splitlines()[3:]]
    snapshots = record("planets.scene", "--every", 512)
    assert len(m) == 9 and len(snapshots) == 5
    energies = [energy(bodies, m) for bodies in snapshots]
    assert all(value == pytest.approx(energies[0], rel=2e-5) for value in energies) and energies[0] < 0
    size = sum(m[i] * abs(one["v_x"]) for i, one in enumerate(snapshots[0]))
    for axis in "xyz":
        for bodies in snapshots:
            assert abs(sum(m[i] * one["v_" + axis] for i, one in enumerate(bodies))) < 1e-5 * size
    for body, axis in ((3, 1.0), (4, 1.523679), (5, 5.2044)):  # earth, mars, jupiter: an angle of 2 pi t/a^1.5 around the sun
        angle = [math.atan2(bodies[body]["x_y"] - bodies[0]["x_y"], bodies[body]["x_x"] - bodies[0]["x_x"]) for bodies in snapshots]
        turned = sum((b - a) % (2 * math.pi) for a, b in zip(angle, angle[1:]))
        period = axis ** 1.5 / math.sqrt(1 + m[body])
        assert turned == pytest.approx(2 * math.pi / period, rel=2e-3)


def test_a_cloth_hangs_from_its_corners(record):
    last = record("cloth.scene")[-1]
    assert (last[0]["x_y"], last[19]["x_y"]) == (2, 2)
    assert all(one["x_y"] < 2 for i, one in enumerate(last) if i not in (0, 19))
    assert max(abs(one["v_y"]) for one in last) < 0.3
    force = 0.0  # what the two corners carry: by all springs of theirs, whose lengths the scene says
    for corner in (0, 19):
        for other in range(400):
            dx, dz = abs(other % 20 - corner % 20), other // 20 - corner // 20
            if (dx, dz) not in ((1, 0), (0, 1), (1, 1), (2, 0), (0, 2)):
                continue
            a, b = last[corner], last[other]
            length, rest = math.dist(*[[one["x_" + axis] for axis in "xyz"] for one in (a, b)]), 0.05 * math.hypot(dx, dz)
            force += (10 if max(dx, dz) == 2 else 100) * (1 - rest / length) * (a["x_y"] - b["x_y"])
    assert force == pytest.approx(398 * 0.001 * 9.81, rel=0.05)

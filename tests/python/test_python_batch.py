"""fp3.Batch: columns without a copy, the bits of the command, and objects that come and go."""

import gc

import numpy as np
import pytest

import fp3

DECAY = "param k = 1\nparam unused = 0\nstate x = 1\nstate y = 0\nstep 0.0625\nx' = -k*x + unused\ny' = x\n"


@pytest.fixture
def kepler(root):
    return fp3.Model(root / "programs/kepler.ode")


def test_bits_are_those_of_the_command(kepler, ran):
    with fp3.Batch(kepler, 9) as batch:
        batch["v_y"] = np.linspace(1.6, 1.8, 9)
        for _ in range(10):
            batch.run(7)
        expected = ran("kepler", "-e", "isa", "-c", "many_full", "-N", 9, "-n", 70, "--spread", "v_y=1.6:1.8")[-1]
        for name in kepler.states:
            assert batch[name].dtype == np.float32 and np.array_equal(batch[name], np.array(expected[name], np.float32)), name
        assert batch.time == 70 / 64


@pytest.mark.parametrize("options", [{"engine": "isa"}, {"arithmetic": "double-single", "method": "rk4"}, {"arithmetic": "compensated"}, {"engine": "rtl"}])
def test_engines_and_arithmetics(options):
    with fp3.Batch(DECAY, 5, **options) as batch, fp3.Batch(DECAY, 5, arithmetic=options.get("arithmetic", "plain")) as fast:
        for of in (batch, fast):
            of["k"] = np.arange(1, 6) / 7
            of.run(3)
        assert np.array_equal(batch["x"], fast["x"]) and batch["x"].dtype == (np.float64 if "double-single" in options.values() else np.float32)


def test_a_column_is_the_engines_own_memory():
    batch = fp3.Batch(DECAY, 1000)
    x = batch["x"]
    address = x.ctypes.data
    assert isinstance(x, fp3.Column) and not x.flags.owndata and not x.flags.writeable and (x == 1).all()
    batch["k"] = np.linspace(0, 1, 1000)
    batch.run(5)
    assert x[0] == 1 and x[-1] < 0.8 and batch["x"].ctypes.data == address and np.array_equal(x, batch.read("x"))
    batch["x"] = 3
    assert (batch["x"] == 3).all() and (x == 3).all()
    with pytest.raises(ValueError):
        x[0] = 1
    assert type(batch.read("x")) is np.ndarray and batch.read("x").flags.writeable


def test_dlpack():
    batch = fp3.Batch(DECAY, 100)
    x = batch["x"]
    taken = np.from_dlpack(x)
    batch.run(3)
    assert np.array_equal(taken, x) and taken[0] < 1 and taken.ctypes.data == x.ctypes.data and x.__dlpack_device__() == (1, 0)
    del x, batch
    gc.collect()
    assert taken[0] < 1
    with pytest.raises(BufferError):
        fp3.Batch(DECAY, 100)["x"][::2].__dlpack__()


def test_a_column_outlives_its_batch():
    batch = fp3.Batch(DECAY, 100_000)
    x = batch["x"]
    batch.run(1)
    expected = x.copy()
    batch.close()
    del batch
    gc.collect()
    other = [fp3.Batch(DECAY, 100_000) for _ in range(3)]
    for of in other:
        of.run(7)
    assert np.array_equal(x, expected)


def test_writing_takes_arrays_of_any_kind():
    with fp3.Batch(DECAY, 6) as batch:
        for array in (np.arange(6, dtype=np.float32), np.arange(6), list(range(6)), np.arange(6.0)[::-1][::-1], np.arange(6, dtype=">f4"),
                      np.arange(12, dtype=np.float32)[::2] / 2, np.arange(6, dtype=np.float16)):
            batch["x"] = 9
            batch["x"] = array
            assert batch.read("x").tolist() == list(range(6))
        batch.write("x", [7, 8], 2)
        assert batch["x"].tolist() == [0, 1, 7, 8, 4, 5] and batch.read("x", 2, 2).tolist() == [7, 8]
        out = np.empty(6)
        assert batch.read("x", out=out) is out and out[3] == 8
        batch["h"] = 0.125
        batch.run()
        assert batch.time == 0.125


def test_float64_is_rounded_as_the_command_rounds(ran, tmp_path):
    (tmp_path / "decay.ode").write_text(DECAY)
    expected = ran(tmp_path / "decay.ode", "-e", "fast", "-c", "many_full", "-N", 1, "-n", 9, "--set", "k=0.1234567890123")[-1]
    with fp3.Batch(DECAY) as batch:
        batch["k"] = np.array([0.1234567890123])
        batch.run(9)
        assert batch["x"][0] == np.float32(expected["x"][0])


def test_many_steps_at_once_are_the_same_steps(kepler, ran):
    """They are made in parts, the first of 64 steps."""
    with fp3.Batch(kepler, 3) as batch:
        batch.run(5000)
        expected = ran("kepler", "-e", "fast", "-c", "many_full", "-N", 3, "-n", 5000)[-1]
        assert batch.time == 5000 / 64 and np.array_equal(batch["r_x"], np.array(expected["r_x"], np.float32))
    with fp3.Batch(kepler, 3, tolerance=1e-6, until=125) as batch:
        batch.run(10**6)
        assert (batch["t"] == 125).all() and (batch["accepted"] > 300).all()
    with fp3.Batch("param a = 1\nstate x = 1\nstep 0.125\nx' = a*x*x\n", 3, params={"a": [0.01, 0.02, 0.03]}) as batch, \
            pytest.raises(fp3.FailedError, match="at least [123] of 3 objects failed, first object 2 in step"):
        batch.run(4000)


def test_remove_and_restart():
    with fp3.Batch(DECAY, 4) as batch:
        batch.run(2)
        batch.remove(batch.handles[2:])
        assert batch.living == 2 and len(batch) == 4
        before = batch.read("x")
        batch.run(2)
        assert (batch["x"][:2] < before[:2]).all() and np.array_equal(batch["x"][2:], before[2:])
        batch.remove(batch.handles[:2])
        batch.run(1)
        batch.add(4)
        batch.restart()
        assert (batch["x"] == 1).all() and batch.time == 0


def test_columns_show_who_is_born():
    with fp3.Batch(DECAY, 4, empty=True) as batch:
        handles = batch.add(2, x=[5, 6])
        x = batch["x"]
        assert x[:2].tolist() == [5, 6] and batch.read("x", 0, 2).tolist() == [5, 6]
        batch.run()
        batch.remove(handles[:1])
        batch.add(1)
        assert x[0] == 1 and 5 < x[1] < 6
        batch.write("x", [7], 0)
        assert x[0] == 7


def test_starts_follow_params():
    model = fp3.Model("param x0 = 1\nstate x = 2*x0\nstate y = x0\nstep 0.0625\nx' = 0*x\ny' = x\n")
    with fp3.Batch(model, 2, params={"x0": 3}) as batch:
        x = batch["x"]
        assert batch.read("x").tolist() == x.tolist() == [6, 6]
        batch["x0"], batch["y"] = [5, 6], 0.5
        batch.run()
        assert x.tolist() == [10, 12] and batch["y"].tolist() == [1.125, 1.25]
        batch["x0"] = 7
        batch.run()
        assert x.tolist() == [10, 12], "objects that have moved go on from where they are"
        batch.restart()
        assert batch.read("x").tolist() == [14, 14] and batch.read("y").tolist() == [0.5, 0.5]


def test_failures_are_told():
    with fp3.Batch("param a = 0\nstate x = 1\nstep 0.125\nx' = a*x*x\n", 3) as batch:
        batch["a"] = [0.0, 0.0, 1e30]
        with pytest.raises(fp3.FailedError, match="1 of 3 objects failed, first object 2 in step 1: overflow"):
            batch.run(2)
        failure = batch.failure()
        assert (failure.failed, failure.object, failure.step) == (1, 2, 1) and batch.status()["failed"].tolist() == [0, 0, 1]
        assert batch["x"][:2].tolist() == [1, 1]
        batch["x"], batch["a"] = 1, 0
        batch.run()
        assert batch.failure() is None
        batch["a"] = [0.0, 0.0, 1e30]
        batch.run(check_failures=False)


def test_chosen_steps_to_each_frame(kepler, ran):
    with fp3.Batch(kepler, 5, tolerance=1e-5) as batch:
        batch["v_y"] = np.linspace(1.6, 1.8, 5)
        for frame in (1.0, 2.0, 3.5):
            batch["until"] = frame
            batch.run(1000)
            assert (batch["t"] == frame).all()
        expected = ran("kepler", "-e", "fast", "-c", "many_full", "-N", 5, "--tolerance", "1e-5", "--spread", "v_y=1.6:1.8", "--times", "1,2,3.5")[-1]
        assert np.array_equal(batch["r_x"], np.array(expected["r_x"], np.float32))
        batch["until"] = 9
        while (batch["t"] < 9).any():
            batch.run(2)  # who may go on has not failed
            assert batch.failure() is None


def test_links(root):
    cloth = fp3.Model(root / "programs/world/cloth.ode")
    relation = cloth.relations[0]
    with fp3.Batch(cloth, 4) as batch:
        batch["x_x"] = [0.0, 0.05, 0.1, 0.15]
        with pytest.raises(fp3.ArgumentError, match="links"):
            batch.run()
        batch.link(relation, [0, 1, 2], [1, 2, 3], rest=0.05)
        batch.run(3)
        moved = batch["x_x"]
        with pytest.raises(ValueError):
            moved[0] = 1
        with pytest.raises(fp3.ArgumentError, match="4 objects|object 9|9"):
            batch.link(relation, [0], [9])
        with pytest.raises(fp3.ArgumentError, match="nothing"):
            batch.link(relation, [0], [1], nothing=1)
        with pytest.raises(fp3.ArgumentError):
            batch.link("no_such", [0], [1])
        moved = moved.copy()
        batch.run()
        batch.link(relation, [], [])
        batch.run()
    with fp3.Batch(cloth, 4, links={relation: ([0, 1, 2], [1, 2, 3], {"rest": 0.05})}) as again:
        again["x_x"] = [0.0, 0.05, 0.1, 0.15]
        again.run(3)
        assert np.array_equal(again["x_x"], moved)


@pytest.mark.parametrize("sees", ["links ties", "near ties(x, 2)", "all ties"])
def test_columns_of_objects_that_see_each_other_follow_them(sees):
    """Though each step leaves their words in another place."""
    model = fp3.Model(f"state x = 0\n{sees}\nstep 0.0625\nx' = sum(o in ties: o.x - x)\n")
    with fp3.Batch(model, 4, method="euler", links={"ties": ([0, 1, 2], [1, 2, 3])} if "links" in sees else None) as batch:
        batch["x"] = [0, 1, 2, 4]
        x = batch["x"]
        for _ in range(3):
            before = x.copy()
            batch.run()
            assert np.array_equal(x, batch.read("x")) and not np.array_equal(x, before)


def test_near(root):
    with fp3.Batch(root / "programs/world/balls.ode", 500) as batch:
        batch["x_x"] = np.linspace(0.1, 3, 500)
        batch["x_y"] = np.linspace(0.1, 3, 500) % 0.7
        before = batch.read("x_x")
        batch.run(3, check_failures=False)
        assert not np.array_equal(before, batch["x_x"])


def test_two_at_one_place_and_one_far_away():
    """Objects failed: it is no mistake of the program, and the others go on."""
    with fp3.Batch(CONTACT, 4, method="semi_implicit_euler") as batch:
        batch["x_x"] = [3.0, 3.0, 9.0, 12.0]
        with pytest.raises(fp3.FailedError, match="2 of 4 objects failed, first object 0 in step 1: invalid.* at the same place as object 1"):
            batch.run()
        batch["x_x"], batch["v"] = [3.0, 6.0, 9.0, 12.0], [0, 0, 0, 3e38]
        batch["F"] = [0, 0, 0, 3e38]
        with pytest.raises(fp3.FailedError, match="1 of 4 objects failed, first object 3"):
            batch.run(64)
        assert batch["x_x"].tolist()[:3] == [3, 6, 9] and batch.status()["failed"].tolist()[:3] == [0, 0, 0]


CONTACT = """
param F = 0
shared R = 0.5
state v = 0
state x[2] = (0, 1)
near touch(x, 2*R)
step 0.0625
push = sum(o in touch: max(0, 2*R - norm(o.x - x))/norm(o.x - x)*(x.x - o.x.x))
v' = F - v + push
x.x' = v
x.y' = 0
"""


ALONE = CONTACT.replace("near touch(x, 2*R)\n", "").replace("max(0, 2*R - norm(o.x - x))/norm(o.x - x)*(x.x - o.x.x)", "0").replace("sum(o in touch: 0)", "0")


@pytest.mark.parametrize("text, options", [(ALONE, {}), (CONTACT, {}), (CONTACT, {"engine": "isa"}), (ALONE, {"arithmetic": "double-single"})],
                         ids=["alone", "near", "isa", "wide"])
def test_columns_taken_before_the_loop(text, options):
    """A loop that pulls to a place by columns that were taken once does what a loop does that reads in each turn."""
    ends = []
    for is_hoisted in (True, False):
        with fp3.Batch(text, 3, method="semi_implicit_euler", **options) as batch:
            batch["x_x"] = [0.0, 0.75, 3.0]
            x, part, force = batch["x_x"], np.asarray(batch["x_x"])[1:], batch["F"]
            for frame in range(9):
                batch["F"] = 1 - (x if is_hoisted else batch.read("x_x"))
                batch.run(2)
                assert np.array_equal(x, batch.read("x_x")) and np.array_equal(part, x[1:]) and np.array_equal(force, batch.read("F"))
            batch["x_x"] = 7
            assert (x == 7).all()
            batch.restart()
            assert np.array_equal(batch["x_x"], np.array([0, 0.75, 3], x.dtype)) and np.array_equal(x, batch.read("x_x"))
            batch.run(3)
            ends.append(x.copy())
        assert np.array_equal(x, ends[-1]), "it outlives its batch"
    assert np.array_equal(*ends)


def test_a_column_of_a_step_that_failed():
    """It shows what can be read, and costs nothing when nobody has it any more."""
    with fp3.Batch("param a = 1e30\nstate x = 1\nstep 0.125\nx' = a*x*x\n", 2, engine="isa") as batch:
        x = batch["x"]
        with pytest.raises(fp3.FailedError):
            batch.run(2)
        assert np.array_equal(x, batch.read("x"), equal_nan=True) and x[0] != 1
        del x
        gc.collect()
        assert not batch._copies


@pytest.mark.parametrize("options", [{"engine": "isa"}, {"arithmetic": "double-single", "method": "rk4"}, {"engine": "fast"}, {"engine": "rtl"}])
def test_several_names_are_one_array(options):
    """Also in part of a buffer of vertices, whose other numbers stay."""
    with fp3.Batch(DECAY, 5, **options) as batch:
        batch.write(("y", "k"), np.arange(10.0).reshape(5, 2))
        batch.run(3)
        names = ("x", "y", "k")
        expected = np.stack([batch.read(name) for name in names], axis=1)
        assert np.array_equal(batch.read(names), expected) and batch.read(names).dtype == expected.dtype and expected[1, 2] == 3
        for kind in (np.float32, np.float64):
            vertices = np.full((4, 8), -7, kind)
            assert batch.read(names, 1, 4, vertices[:, 2:5]).base is vertices
            assert np.array_equal(vertices[:, 2:5], expected[1:].astype(kind)) and (vertices[:, [0, 1, 5, 6, 7]] == -7).all()
        flipped = np.empty((3, 5), np.float32)
        batch.read(names, out=flipped.T)
        assert np.array_equal(flipped.T, expected.astype(np.float32))
        for wrong in (np.empty((5, 2), np.float32), np.empty((5, 3), np.int32), [0] * 15):
            with pytest.raises(fp3.ArgumentError):
                batch.read(names, out=wrong)
        x = batch["x"]
        for kind in (np.float32, np.float64):  # columns of a larger array, and a part of the objects; what shows them, too
            table = np.arange(40, dtype=kind).reshape(4, 10) + (kind == np.float32)
            batch.write(names, table[:, 1:10:4], first=1)
            assert np.array_equal(batch.read(names, 1), table[:, 1:10:4]) and np.array_equal(x[1:], table[:, 1])
        with pytest.raises(fp3.ArgumentError, match=r"expected one for each of 3 objects"):
            batch.write(names, np.zeros((2, 3), np.float32), 1, 3)
        with pytest.raises(fp3.ArgumentError):
            batch.write(names, np.zeros((5, 2)))
        with pytest.raises(fp3.ArgumentError):
            batch.read(("x", "nothing"))

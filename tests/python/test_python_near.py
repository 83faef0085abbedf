"""Who is near a point or a ray, which pairs are near each other, and contacts that begin and end: against NumPy, on every engine."""

import fp3
import numpy as np
import pytest

ENGINES = ["isa", "fast", "rtl"]
MODEL = {1: "state x = 0\nstate v = 0\n", 2: "state x[2] = (0, 0)\nstate v[2] = (0, 0)\n", 3: "state x[3] = (0, 0, 0)\nstate v[3] = (0, 0, 0)\n"}
REST = "shared R = 0.5\nparam r = 0.25\nnear touch(x, 2*R, n = 0)\nstep 0.0625\nx' = v\nv' = {v}*sum(o in touch: o.n)\nremember o in touch: o.n = o.n + 1\n"


def model(dimensions):
    return fp3.Model(MODEL[dimensions] + REST.format(v="0*v"))


def names(dimensions, of="x"):
    return [of] if dimensions == 1 else [f"{of}_{'xyz'[k]}" for k in range(dimensions)]


def where(batch, dimensions):
    """Positions in double of those that live, and their numbers."""
    living = np.flatnonzero(batch.handles)
    return living, np.stack([batch.read(name)[living].astype(float) for name in names(dimensions)], 1)


def squares(at, point):
    """Summed as the library does."""
    total = np.zeros(len(at))
    for k in range(at.shape[1]):
        total += (at[:, k] - point[k])**2
    return total


def near(living, at, distance):
    return [(int(living[i]), int(living[j])) for i in range(len(at)) for j in np.flatnonzero(squares(at, at[i]) < distance*distance) if i < j]


def filled(batch, dimensions, random, count):
    values = {name: random.normal(0, 1, count).astype(np.float32) for name in names(dimensions)}
    return batch.add(count, **values, **{name: random.normal(0, 1, count) for name in names(dimensions, "v")}, r=random.uniform(0, 0.5, count))


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("dimensions", [1, 2, 3])
def test_questions_are_answered_as_in_numpy(dimensions, engine):
    random = np.random.default_rng(dimensions)
    with fp3.Batch(model(dimensions), 40, method="euler", engine=engine, empty=True) as batch:
        objects, distances = batch.nearest("x", np.zeros((2, dimensions)))
        assert objects.tolist() == [fp3.NOBODY]*2 and np.isinf(distances).all() and not len(batch.pairs("touch")[0])
        filled(batch, dimensions, random, 36)
        for turn in range(4):
            living, at = where(batch, dimensions)
            for distance in (0, 1, 0.3):
                assert list(zip(*(end.tolist() for end in batch.pairs("touch", distance)))) == near(living, at, distance or 1), distance
            assert [end.tolist() for end in batch.pairs("x", 0.3)] == [end.tolist() for end in batch.pairs("touch", 0.3)]
            points, radii = random.normal(0, 1, (5, dimensions)), random.uniform(0, 2, 5)
            radii[0] = 0
            which, found = batch.within("touch", points, radii)
            assert [(int(n), int(i)) for n, i in zip(which, found)] == [(n, int(i)) for n in range(5) for i in living[squares(at, points[n]) < radii[n]**2]]
            objects, distances = batch.nearest("x", points)
            assert objects.tolist() == [living[np.argmin(squares(at, p))] for p in points] and distances.tolist() == [np.sqrt(squares(at, p).min()) for p in points]
            ways, r = random.normal(0, 1, (5, dimensions)), batch.read("r")[living].astype(float)
            for radius, length in (("r", 0), (0.2, 0), ("r", 1.0)):
                objects, distances = batch.ray("x", points, ways, radius, length)
                for n in range(5):
                    way = ways[n]/np.linalg.norm(ways[n])
                    to, size = at - points[n], r if radius == "r" else np.full(len(r), radius)
                    along = to @ way
                    miss = ((to - along[:, None]*way)**2).sum(1)
                    with np.errstate(invalid="ignore"):
                        hit = np.where((to**2).sum(1) <= size**2, 0, np.where((along >= 0) & (miss <= size**2), along - np.sqrt(size**2 - miss), np.inf))
                    hit[hit > length] = np.inf if length else hit[hit > length]
                    assert (objects[n] == fp3.NOBODY) == np.isinf(hit.min())
                    assert np.isinf(hit.min()) or (objects[n] == living[np.argmin(hit)] and abs(distances[n] - hit.min()) < 1e-12)
            batch.run(1 + turn)
            batch.remove(batch.handles[living[::3]])
            filled(batch, dimensions, random, 3)


@pytest.mark.parametrize("engine", ENGINES)
def test_whom_an_event_has_removed_is_not_found(engine):
    with fp3.Batch(fp3.Model(MODEL[1] + REST.format(v="0*v") + "when x > 1: remove\n"), 3, method="euler", engine=engine, empty=True) as batch:
        batch.add(3, x=[0, 0.5, 1.25])
        assert [end.tolist() for end in batch.pairs("touch")] == [[0, 1], [1, 2]]
        batch.run(1)
        assert [end.tolist() for end in batch.pairs("touch")] == [[0], [1]] and batch.nearest("x", [[9]])[0].tolist() == [1]
        batch.remove(batch.handles[2])
        batch.add(1, x=[0.75])
        assert [end.tolist() for end in batch.pairs("touch")] == [[0, 0, 1], [1, 2, 2]]


@pytest.mark.parametrize("engine, seeds", [("isa", 2), ("fast", 4), ("rtl", 1)])
def test_contacts_begin_and_end(engine, seeds):
    """Also of who is removed, and of who gets the number of one who was; each name has contacts of its own."""
    for seed in range(seeds):
        random = np.random.default_rng(seed)
        with fp3.Batch(model(2), 20, method="euler", engine=engine, empty=True) as batch:
            filled(batch, 2, random, 12)
            before, close = set(), set()
            for _ in range(8):
                batch.run(int(random.integers(0, 5)))
                living, at = where(batch, 2)
                handles = batch.handles
                for of, distance, seen in (("touch", 0, before), ("x", 0.5, close)):
                    now = {(int(handles[a]), int(handles[b])) for a, b in near(living, at, distance or 1)}
                    contacts = batch.contacts(of, distance)
                    began, ended = ([(int(a), int(b)) for a, b in zip(*ends)] for ends in (contacts[:2], contacts[2:]))
                    def order(pair):
                        return [handle & (2**32 - 1) for handle in pair] + list(pair)
                    assert began == sorted(now - seen, key=order) and ended == sorted(seen - now, key=order)
                    seen.clear()
                    seen.update(now)
                batch.remove(handles[random.permutation(living)[:4]])
                filled(batch, 2, random, int(random.integers(2, 7)))


@pytest.mark.parametrize("engine", ENGINES)
def test_what_pairs_remember(engine):
    with fp3.Batch(model(1), 6, method="euler", engine=engine) as batch:
        batch["x"] = [0, 0.5, 10, 20, 20.5, 21]
        assert batch.remembered("touch", "n", [0], [1]).tolist() == [0]
        batch.run(3)
        assert batch.remembered("touch", "n", [0, 1, 0, 3, 4], [1, 0, 2, 5, 5]).tolist() == [3, 3, 0, 0, 3]
        batch.remove(batch.handles[:1])
        batch.add(1, x=0.25)
        assert batch.remembered("touch", "n", [0, 1], [1, 0]).tolist() == [0, 0]
        batch.run(2)
        assert batch.remembered("touch", "n", [0, 1, 4], [1, 0, 5]).tolist() == [2, 2, 5]
        for relation, field, a, b, told in (("touch", "m", [0], [1], "remembers 'm'"), ("tuch", "n", [0], [1], "'tuch'"), ("touch", "n", [0], [6], "there are 6"), ("touch", "n", [0, 1], [1], "shape")):
            with pytest.raises(fp3.ArgumentError, match=told):
                batch.remembered(relation, field, a, b)


def test_who_has_no_position_is_nowhere():
    text = "state x = 1\nparam k = 0\nstep 1\nx' = k*x*x\n"
    with fp3.Batch(text, 3, method="euler") as batch:
        batch["x"], batch["k"] = [1, 2, 3], [0, 1e30, 0]
        batch.run(9, check_failures=False)
        assert not np.isfinite(batch["x"][1])
        assert batch.nearest("x", [2.25])[0].tolist() == [2] and batch.within("x", [2], 100)[1].tolist() == [0, 2]
        assert [end.tolist() for end in batch.pairs("x", 100)] == [[0], [2]] and batch.ray("x", [[1.5]], [[1]])[0].tolist() == [2]


@pytest.mark.parametrize("ask, told", [
    (lambda b: b.pairs("y", 1), "no relation of near objects, and no state"), (lambda b: b.pairs("x"), "expected a distance"), (lambda b: b.pairs("touch", -1), "2\\^-50"),
    (lambda b: b.pairs("touch", np.nan), "2\\^-50"), (lambda b: b.pairs("touch", 1e30), "2\\^63"), (lambda b: b.within("x", [0, 0], -1), "radius is -1"),
    (lambda b: b.within("x", [0, np.inf], 1), "point 0: found inf"), (lambda b: b.nearest("x", [0, 1e200]), "2\\^500"), (lambda b: b.within("x", [0, 0], 1e-200), "2\\^-500"),
    (lambda b: b.ray("x", [0, -1e200], [1, 0], 1), "2\\^500"), (lambda b: b.within("x", [[0, 0], [0, np.nan]], 1), "point 1"), (lambda b: b.within("x", [0, 0, 0], 1), "2 numbers"),
    (lambda b: b.within("x", [0, 0], np.nan), "radius"), (lambda b: b.within("x", [0, 0], [1, 2]), "shape"), (lambda b: b.nearest("touch", [0]), "2 numbers"),
    (lambda b: b.nearest("x", [np.nan, 0]), "found nan, expected a number from"), (lambda b: b.ray("x", [0, 0], [0, 0]), "ray 0: its direction"), (lambda b: b.ray("x", [0, 0], [1, np.inf]), "found inf, expected a number from"),
    (lambda b: b.ray("x", [0, 0], [1, 0], -0.5), "radius"), (lambda b: b.ray("x", [0, 0], [1, 0], "q"), "no 'q'"), (lambda b: b.ray("x", [0, 0], [1, 0], "v_x"), "object 2: the radius is -3"),
    (lambda b: b.ray("x", [0, 0], [1, 0], length=-1), "length"), (lambda b: b.ray("x", [[0, 0]], [[1, 0], [0, 1]]), "one for each"), (lambda b: b.contacts("y"), "no state"),
    (lambda b: b.contacts("touch", np.inf), "2\\^63")])
def test_what_is_refused(ask, told):
    with fp3.Batch(model(2), 4) as batch:
        batch["v_x"] = [1, 2, -3, 4]
        with pytest.raises(fp3.ArgumentError, match=told):
            ask(batch)

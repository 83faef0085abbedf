"""Objects of a batch are born and removed: handles, defaults, and what others see, against a world in NumPy, on every engine."""

import fp3
import numpy as np
import pytest

ENGINES = ["isa", "fast", "rtl"]
ALONE = "param x0 = 1\nparam m = 2\nstate x = 2*x0\nstate v = 0.5\nstate w = 0\nstep 0.0625\nx' = v\nv' = -x/m\nw' = t\n"
# All numbers are multiples of a power of 2, so that NumPy has the same bits in any order.
WORLD = """
param m = 2
state x = 0
state v = 0
state s = 0
state w = 0
links ties(k = 1, n = 0)
near touch(x, 2, n = 0)
all others
step 0.25
x' = v
v' = 0
s' = sum(o in touch: o.n) + 8*sum(o in ties: o.k + o.n) + count(o in others) + m
w' = t
remember o in touch: o.n = o.n + 1
remember o in ties: o.n = o.n + 1
"""


class Numbers:
    """Who has which number: the lowest that is free."""

    def __init__(self, most, empty=False):
        self.most, self.who, self.all = most, ([] if empty else list(range(most))), {}
        self.who = dict(enumerate(self.who))  # number: object

    def add(self, objects):
        free = [i for i in range(self.most) if i not in self.who][:len(objects)]
        assert len(free) == len(objects)
        self.who.update(zip(free, objects))
        return free

    def number(self, object_):
        return next((i for i, o in self.who.items() if o == object_), fp3.NOBODY)


def single(array):
    return np.asarray(array, np.float32).view(np.uint32).tolist()


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("method, arithmetic", [("rk4", "plain"), ("euler", "compensated"), ("rk4", "double-single"), ("stoermer_verlet", "plain")])
def test_who_is_born_late_moves_as_who_was_there_at_first(method, arithmetic, engine):
    """The same bits as an object of a new batch with the same values; states and t begin anew, whoever had the number before."""
    random = np.random.default_rng(len(method) + len(arithmetic))
    text = ALONE.replace("w' = t\n", "w' = 0\n").replace("x' = v\nv' = -x/m", "x' = v\nv' = -x/m") if method == "stoermer_verlet" else ALONE
    if method == "stoermer_verlet":
        text = text.replace("state w = 0\n", "").replace("w' = 0\n", "")
    states = ["x", "v"] if method == "stoermer_verlet" else ["x", "v", "w"]
    model, lived = fp3.Model(text), []  # of each object: handle, values, steps

    def begin(batch, count):
        kind = int(random.integers(4))
        values = [{}, {"x0": random.normal(size=count)}, {"x": random.normal(size=count), "m": 3.0}, {"v": np.float32(random.normal(size=count)), "m": random.uniform(1, 2, count)}][kind]
        for i, handle in enumerate(batch.add(count, **values)):
            lived.append([handle, {name: float(np.broadcast_to(value, count)[i]) for name, value in values.items()}, 0])

    with fp3.Batch(model, 12, method=method, arithmetic=arithmetic, engine=engine, empty=True) as batch:
        for turn in range(7):
            begin(batch, int(random.integers(0, 5)))
            if turn == 3 and lived:  # before its first step a start is a start, and so is what follows from a param
                begin(batch, 1)
                batch.write_of("x0", [lived[-1][0]], -2)
                lived[-1][1] = {**lived[-1][1], "x0": -2.0}
            assert batch.living == len(lived)
            steps = int(random.integers(0, 6))
            batch.run(steps)
            for each in lived:
                each[2] += steps
            now = {name: batch.read(name) for name in [*states, "m"]}
            for handle, values, steps in lived:
                with fp3.Batch(model, 1, method=method, arithmetic=arithmetic, engine="isa", params=values) as own:
                    own.run(steps)
                    number = int(batch.numbers([handle])[0])
                    assert [now[name][number] for name in states] == [own.read(name)[0] for name in states], (turn, values, steps)
            gone = random.permutation(len(lived))[:int(random.integers(0, len(lived)//2 + 1))]
            batch.remove([lived[i][0] for i in gone])
            lived = [each for i, each in enumerate(lived) if i not in gone]


class World:
    """What a batch of WORLD does, object by object."""

    def __init__(self, batch, most, random):
        self.batch, self.most, self.random, self.steps = batch, most, random, 0
        self.who, self.gone = {}, []  # of each number that lives: a dict; the handles of those that do not
        self.touch, self.ties = {}, {}  # of pairs of objects: what they remember; and k

    def add(self, count):
        random, free = self.random, [i for i in range(self.most) if i not in self.who][:count]
        values = {"x": random.integers(-8, 9, count)/2, "v": random.integers(-2, 3, count).astype(np.float32)}
        if random.random() < 0.5:
            values["m"] = random.integers(1, 4, count)
        handles = self.batch.add(count, **values)
        assert self.batch.numbers(handles).tolist() == free and len(set(handles.tolist())) == count
        for i, number in enumerate(free):
            self.who[number] = {"m": 2, "s": 0, "w": 0, "steps": 0, "handle": int(handles[i]), **{name: float(column[i]) for name, column in values.items()}}

    def remove(self, numbers):
        self.batch.remove([self.who[i]["handle"] for i in numbers])
        for i in numbers:
            self.gone.append(self.who.pop(i)["handle"])
        for memory in (self.touch, self.ties):
            for pair in [pair for pair in memory if set(pair) & set(numbers)]:
                del memory[pair]

    def link(self):
        living = sorted(self.who)
        pairs = sorted({tuple(sorted(map(int, self.random.permutation(living)[:2]))) for _ in range(4)}) if len(living) > 1 else []
        k = self.random.integers(1, 4, len(pairs))
        self.batch.link("ties", [a for a, _ in pairs], [b for _, b in pairs], k=k)
        self.ties = {pair: [float(stiff), 0.0] for pair, stiff in zip(pairs, k)}

    def write(self):
        number = int(self.random.permutation(sorted(self.who))[0])
        self.who[number]["x"] = float(self.random.integers(-8, 9))
        self.batch.write_of("x", [self.who[number]["handle"]], self.who[number]["x"])

    def near(self):
        living = sorted(self.who)
        return [(a, b) for a in living for b in living if a < b and abs(self.who[a]["x"] - self.who[b]["x"]) < 2]

    def run(self, steps):
        self.batch.run(steps)
        for _ in range(steps):
            near, h = set(self.near()), 0.25
            change = {i: len(self.who) - 1 + of["m"] for i, of in self.who.items()}
            for a, b in near:
                for i in (a, b):
                    change[i] += self.touch.get((a, b), 0)
            for (a, b), (k, n) in self.ties.items():
                for i in (a, b):
                    change[i] += 8*(k + n)
            for i, of in self.who.items():
                of["w"] += h*h*of["steps"]
                of["steps"] += 1
                of["s"] += h*change[i]
                of["x"] += h*of["v"]
            self.touch = {pair: self.touch.get(pair, 0) + 1 for pair in self.near()}
            self.ties = {pair: [k, n + 1] for pair, (k, n) in self.ties.items()}

    def compare(self):
        living = sorted(self.who)
        assert self.batch.living == len(living) and np.flatnonzero(self.batch.handles).tolist() == living
        assert self.batch.handles[living].tolist() == [self.who[i]["handle"] for i in living]
        assert (self.batch.numbers(self.gone) == fp3.NOBODY).all() if self.gone else True
        for name in ("x", "v", "m", "s", "w", "steps"):
            assert self.batch.read(name)[living].tolist() == [self.who[i][name] for i in living], name


@pytest.mark.parametrize("engine, threads, seeds", [("isa", 0, 3), ("fast", 1, 6), ("fast", 2, 2), ("rtl", 0, 1)])
def test_seeds_of_random_calls(engine, threads, seeds):
    """Births, ends, links and writes at random: nobody sees who is gone, and who gets its number inherits nothing of it."""
    for seed in range(seeds):
        random = np.random.default_rng(seed + 17)
        most = int(random.integers(2, 14))
        with fp3.Batch(WORLD, most, method="euler", engine=engine, threads=threads, empty=True) as batch:
            world = World(batch, most, random)
            batch.link("ties", [], [])
            for turn in range(12):
                world.add(int(random.integers(0, most - len(world.who) + 1)))
                if turn % 3 == 0:
                    world.link()
                if world.who and random.random() < 0.3:
                    world.write()
                world.run(int(random.integers(0, 4)))
                world.compare()
                if world.who:
                    world.remove([int(i) for i in random.permutation(sorted(world.who))[:int(random.integers(0, len(world.who) + 1))]])
                world.compare()


def test_many_objects_in_another_order():
    """Enough for the order in which engine `fast` keeps them; those that live are the same to the bit as on engine `isa`."""
    model = fp3.Model(WORLD.replace("links ties(k = 1, n = 0)\n", "").replace(" + 8*sum(o in ties: o.k + o.n) + count(o in others)", "").replace("all others\n", "")
                      .replace("remember o in ties: o.n = o.n + 1\n", ""))
    told = []
    for engine in ("isa", "fast"):
        random = np.random.default_rng(3)
        with fp3.Batch(model, 500, method="euler", engine=engine, empty=True) as batch:
            handles, rows = batch.add(400, x=random.integers(-200, 200, 400), v=random.integers(-3, 4, 400)), []
            for _ in range(6):
                batch.run(7)
                gone = random.random(len(handles)) < 0.3
                batch.remove(handles[gone])
                handles = np.concatenate([handles[~gone], batch.add(90, x=random.integers(-200, 200, 90))])
                batch.run(2)
                rows.append([batch.read_of(name, handles).tolist() for name in ("x", "s", "w")])
            told.append(rows)
    assert told[0] == told[1] and len({tuple(row[1]) for row in told[0]}) == 6


@pytest.mark.parametrize("engine", ENGINES)
def test_stale_handles_and_a_full_batch(engine):
    with fp3.Batch(WORLD, 4, method="euler", engine=engine) as batch:
        first = batch.handles
        assert batch.numbers(first).tolist() == [0, 1, 2, 3] and batch.living == len(batch) == 4
        with pytest.raises(fp3.LimitError, match="1 more objects: 4 of 4 live, and there is room for 0"):
            batch.add(1)
        batch.remove(first[[2, 0]])
        with pytest.raises(fp3.LimitError, match="3 more objects: 2 of 4 live, and there is room for 2"):
            batch.add(3)
        for call in (lambda h: batch.remove(h), lambda h: batch.write_of("x", h, 1), lambda h: batch.read_of("x", h)):
            with pytest.raises(fp3.ArgumentError, match="handle 1, 0x1[0]*2: its object, number 2, was removed$"):
                call([first[1], first[2]])
            with pytest.raises(fp3.ArgumentError, match="handle 0, 0x0: no object ever had it"):
                call([0])
            with pytest.raises(fp3.ArgumentError, match="no object ever had it"):
                call([int(first[3]) + (1 << 32)])
            with pytest.raises(fp3.ArgumentError, match="no object ever had it"):
                call([2**64 - 1])
        assert batch.living == 2
        with pytest.raises(fp3.ArgumentError, match="occurs twice"):
            batch.remove([first[1], first[3], first[1]])
        new = batch.add(2, x=[7, 8])
        assert batch.numbers(new).tolist() == [0, 2] and batch.numbers(first).tolist() == [fp3.NOBODY, 1, fp3.NOBODY, 3]
        with pytest.raises(fp3.ArgumentError, match="number 2, was removed, and another object has its number"):
            batch.remove([first[1], first[2]])
        assert batch.living == 4 and batch.read_of("x", new).tolist() == [7, 8] and batch.add(0).tolist() == []
        batch.remove(batch.handles)
        assert batch.living == 0
        batch.link("ties", [], [])
        batch.run(3)
        assert batch.failure() is None


def test_an_add_that_is_refused_bears_nobody():
    with fp3.Batch(WORLD, 4, method="euler", empty=True) as batch:
        for values, told in (({"y": 1}, "no 'y'"), ({"x": [1, 2]}, "shape"), ({"x": [1, 2, np.nan]}, "object 2"), ({"h": [1, 2, 3]}, "one number for all"), ({"x": "a"}, "number")):
            with pytest.raises(fp3.ArgumentError, match=told):
                batch.add(3, **values)
            assert batch.living == 0 and not batch.handles.any()
        for count in (-1, 1.5, "2", True):
            with pytest.raises(fp3.ArgumentError, match="count"):
                batch.add(count)
        for handles in ([1.5], [-1], "a", [[1]]):
            with pytest.raises(fp3.ArgumentError, match="handles"):
                batch.remove(handles)
        handles = batch.add(4)
        with pytest.raises(fp3.ArgumentError, match="link 0 joins object 3, which does not live"):
            batch.remove(handles[3:])
            batch.link("ties", [0], [3])


def test_who_fails_and_is_removed_has_not_failed():
    model = "param k = 0.01\nstate x = 1\nstep 1\nx' = k*x*x\n"
    for engine in ENGINES:
        with fp3.Batch(model, 4, engine=engine, method="euler") as batch:
            batch.write("k", [1e30, 1e30], 1)
            with pytest.raises(fp3.FailedError, match="2 of 4 objects failed, first object 1"):
                batch.run(9)
            batch.remove(batch.handles[1:3])
            batch.run(2)
            new = batch.add(1)
            assert batch.status()["failed"][1] == batch.status()["flags"][1] == 0
            batch.run(2)
            assert batch.read_of("x", new)[0] < 1.1 and batch.failure() is None


def test_a_restart_keeps_who_lives():
    with fp3.Batch(WORLD, 4, method="euler") as batch:
        first = batch.handles
        batch["x"] = [0, 1, 10, 11]
        batch.link("ties", [0, 1], [1, 2])
        batch.run(3)
        batch.remove(first[[0, 3]])
        new = batch.add(1, x=9.5)
        batch.run(2)
        before = batch.read("s")
        batch.restart()
        assert batch.living == 3 and batch.numbers(new).tolist() == [0] and batch.read("x").tolist()[:3] == [9.5, 1, 10]
        batch.run(2)  # one tie is left, and three that live; 0 and 2 are near
        assert batch.read("s")[:3].tolist() == [2 + 0.25, 2 + 8*0.5 + 8*0.25, 2 + 8*0.5 + 8*0.25 + 0.25] and before[1] != batch.read("s")[1]


def test_adaptive_objects_are_born_late():
    model = "state x = 1\nstate v = 0\nstep 0.125\nx' = v\nv' = -x\n"
    for engine in ("isa", "fast"):
        with fp3.Batch(model, 3, tolerance=1e-4, engine=engine, empty=True) as batch, fp3.Batch(model, 2, tolerance=1e-4, engine="isa") as other:
            first = batch.add(2, until=1)
            batch.run(1000)
            batch.remove(first[:1])
            second = batch.add(1, until=2)
            batch.run(1000)
            other["until"] = [1, 2]
            other.run(1000)
            found = batch.read_of("x", [first[1], second[0]])
            assert found.tolist() == other.read("x").tolist() and batch.read_of("t", second).tolist() == [2]


def test_sleepers_wake_when_what_they_lean_on_is_removed():
    """Also where its number is another's at once; and pairs that do not sleep remember what they did, whoever sleeps beside them."""
    model = fp3.Model("state x = 0\nstate v = 0\nstate s = 0\nnear touch(x, 1, n = 0)\nrest when abs(v) < 0.01 for 0.25\nstep 0.125\n"
                      "x' = v\nv' = 0*v\ns' = sum(o in touch: o.n)\nremember o in touch: o.n = o.n + 1 + 2*abs(v)\n")
    for engine in ENGINES:
        with fp3.Batch(model, 6, method="euler", engine=engine) as batch:
            batch["x"], batch["v"] = [0, 0.5, 10, 10.5, 20, 20.5], [0, 0, 1, 1, 0, 0]
            handles = batch.handles
            batch.run(40)
            assert batch["at_rest"].tolist()[:2] == [-1, -1] and batch["s"][2:4].tolist() == [0.125*3*sum(range(40))]*2
            batch.remove(handles[:1])
            new = batch.add(1, x=-100, v=1)
            batch.run(4)
            assert batch["at_rest"].tolist()[1] >= 0 and batch["at_rest"].tolist()[4:] == [-1, -1]
            assert batch.read_of("s", new)[0] == 0 and batch["s"][2] == 0.125*3*sum(range(44))

"""Single links come and go, and what the others remember stays: against a count in Python, on every engine."""

import fp3
import numpy as np
import pytest

MODEL = """\
state s = 0
links ties(w = 1, n = 0)
step 1
s' = sum(o in ties: o.w*o.n)
remember o in ties: o.n = o.n + 1
{}
"""
OBJECTS = 9


class Counted:
    """What the model says, in whole numbers: of each pair its weight, and how many steps it has remembered."""

    def __init__(self):
        self.ties, self.s = {}, np.zeros(OBJECTS)

    def run(self, steps):
        for _ in range(steps):
            for (a, b), (w, n) in self.ties.items():
                self.s[[a, b]] += w*n
            self.ties = {pair: (w, n + 1) for pair, (w, n) in self.ties.items()}

    def link(self, pairs, w):
        self.ties.update({tuple(sorted(pair)): (w, 0) for pair in pairs})

    def unlink(self, pairs):
        for pair in pairs:
            del self.ties[tuple(sorted(pair))]

    def remove(self, number):
        self.ties = {pair: of for pair, of in self.ties.items() if number not in pair}


def ends(pairs):
    return [a for a, _ in pairs], [b for _, b in pairs]


def drawn(random, pairs, count):
    """Some of these, with the ends in either order."""
    pairs = sorted(pairs)
    return [pairs[i] if random.random() < 0.5 else pairs[i][::-1] for i in random.permutation(len(pairs))[:count]]


@pytest.mark.parametrize("more", ["", "rest when s < -1 for 8"])  # with `rest` objects are in engines of their own
@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_links_that_stay_remember(engine, more):
    random, is_, every = np.random.default_rng(5), Counted(), [(a, b) for a in range(OBJECTS) for b in range(a + 1, OBJECTS)]
    with fp3.Batch(fp3.Model(MODEL.format(more)), OBJECTS, method="euler", engine=engine, links={"ties": ([0], [1], {"w": 2})}) as batch:
        is_.link([(0, 1)], 2)
        for turn in range(12):
            new = drawn(random, set(every) - set(is_.ties), 3)
            batch.link_more("ties", *ends(new), **({"w": turn} if turn % 3 else {}))
            is_.link(new, turn if turn % 3 else 1)
            batch.run(turn % 3)
            is_.run(turn % 3)
            gone = drawn(random, is_.ties, 2)
            batch.unlink("ties", *ends(gone))
            is_.unlink(gone)
            if turn % 4 == 3:  # whoever gets the number has no link, and remembers nothing
                batch.remove(batch.handles[turn - 3:turn - 2])
                batch.add(1)
                is_.remove(turn - 3)
                is_.s[turn - 3] = 0
            batch.run(2)
            is_.run(2)
            assert batch.read("s").tolist() == is_.s.tolist(), turn
        batch.link("ties", *ends([*is_.ties]))  # all of them begin anew
        is_.link([*is_.ties], 1)
        batch.run(3)
        is_.run(3)
        assert batch.read("s").tolist() == is_.s.tolist() and len(set(is_.s)) > 5


@pytest.mark.parametrize("engine", ["isa", "fast", "rtl"])
def test_links_have_the_order_in_which_they_were_given(engine):
    """Sums go through them in that order: in every bit as if those that are left had been given at once."""
    model = fp3.Model("state x = 0\nlinks ties(k = 0.3)\nstep 0.01\nx' = sum(o in ties: o.k*(o.x - x))\n")
    random = np.random.default_rng(2)
    pairs = drawn(random, [(a, b) for a in range(OBJECTS) for b in range(a)], 30)
    k, x, gone = random.uniform(0, 1, 30).astype(np.float32), random.normal(size=OBJECTS), sorted(random.permutation(30)[:11])
    k[12:20] = np.float32(0.3)
    left = [i for i in range(30) if i not in gone]
    found = []
    for is_single in (False, True):
        with fp3.Batch(model, OBJECTS, method="euler", engine=engine) as batch:
            batch["x"] = x
            if is_single:
                for some in (slice(0, 1), slice(1, 12), slice(12, 20), slice(20, 30)):
                    batch.link_more("ties", *ends(pairs[some]), **({} if some.start == 12 else {"k": k[some]}))
                batch.unlink("ties", *ends([pairs[i][::-1] for i in gone]))
            else:
                batch.link("ties", *ends([pairs[i] for i in left]), k=k[left])
            batch.run(3)
            found.append(batch.read("x"))
    assert found[0].tobytes() == found[1].tobytes()


def test_what_is_refused_changes_nothing():
    model = fp3.Model(MODEL.format("near touch(s, 1)\nall rest_"))
    with fp3.Batch(model, 4, method="euler") as batch:
        with pytest.raises(fp3.ArgumentError, match="there are no links of 'ties'"):
            batch.unlink("ties", [0], [1])
        batch.link_more("ties", [0, 1], [1, 2])
        batch.run(2)
        gone = batch.handles[3:]
        batch.remove(gone)
        for name, a, b, expected in (
                ("ties", [3], [0], "link 2 joins object 3, which does not live"),
                ("ties", batch.numbers(gone), [0], "'a' has 4294967295, expected numbers of objects"),
                ("ties", [2], [1], "link 2 joins objects 2 and 1, as link 1 does"), ("ties", [2], [2], "link 2 joins object 2 with 2"),
                ("touch", [2], [0], "the model finds the objects of 'touch' by itself"), ("tie", [2], [0], "no relation 'tie'")):
            with pytest.raises(fp3.ArgumentError, match=expected):
                batch.link_more(name, np.asarray(a), b)
        with pytest.raises(fp3.ArgumentError, match="no field 'u' of theirs"):
            batch.link_more("ties", [2], [0], u=1)
        with pytest.raises(fp3.ArgumentError, match="has w = inf"):
            batch.link_more("ties", [2], [0], w=np.inf)
        for a, b, expected in (([0, 2], [1, 0], "objects 0 and 2 have none"), ([0, 1], [1, 0], "objects 0 and 1 are given twice"),
                               ([9], [9], "objects 9 and 9 have none")):
            with pytest.raises(fp3.ArgumentError, match=expected):
                batch.unlink("ties", a, b)
        batch.unlink("ties", [], [])
        batch.run(2)
        assert batch.read("s").tolist() == [6, 12, 6, 0]
        batch.unlink("ties", [2, 1], [1, 0])
        batch.run(1)
        assert batch.read("s").tolist() == [6, 12, 6, 0]

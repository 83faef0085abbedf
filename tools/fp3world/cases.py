"""The forms of the scenes whose speed is measured, and what a turn of each is."""

from fp3world import scene as ws


class Case:
    """A form of a scene; what a turn is, in the full form and in the quick one."""

    def __init__(self, label, scene, changes=(), loop=None, steps=20, before=1, quick=None, kinds=1):
        self.label, self.scene, self.changes, self.loop, self.steps, self.before, self.quick = label, scene, changes, loop, steps, before, quick
        self.kinds = kinds  # 2: kinds.py deals the balls to two

    def name(self, quick):
        return self.label + (", small" if quick else "")

    def text(self, quick):
        text = ws.text_of(self.scene)
        for change in self.quick if quick else self.changes:
            text = ws.replace(text, *change)
        return text


def stars(objects):
    return [(r"objects = 300", f"objects = {objects}"), (r"m = 0.00333", f'm = "1.0/{objects}"')]


CASES = [Case("net", "net", loop="net", quick=[(r"count = \[128, 128\]", "count = [40, 20]"), (r'"0\.\.127"', '"0..39"')]),
         Case("cloth 128 x 128", "cloth", [(r"count = \[20, 20\]", "count = [128, 128]"), (r"objects = \[0, 19\]", "objects = [0, 127]")]),
         Case("heap", "heap", loop="balls", before=16384, steps=50, quick=[(r"objects = 10000", "objects = 90"), (r"to = \[3.15, 2.2, 3.15\]", "to = [0.7, 0.5, 0.7]")]),
         Case("heap of two kinds", "heap", loop="balls", before=16384, steps=50, kinds=2,
              quick=[(r"objects = 10000", "objects = 600"), (r"to = \[3.15, 2.2, 3.15\]", "to = [1.5, 1.0, 1.5]")]),  # so many are put in order
         Case("heap, 100000", "heap", [("objects = 10000", "objects = 100000"), (r"to = \[3.15, 2.2, 3.15\]", "to = [9.95, 2.2, 9.95]"), (r"side = 3.2", "side = 10.0")],
              loop="balls", before=8192, steps=10),
         Case("stars, 1024", "stars", stars(1024), loop="stars", quick=stars(70)),
         Case("stars, 16384", "stars", stars(16384), loop="stars", steps=1)]


def find(label):
    return next(case for case in CASES if case.label == label)

"""One hash a scene: engines, processors, threads, skins, and objects in another order, word by word against the engine isa."""

import csv

import numpy as np
from fp3world import scene as ws

STEPS = {True: 64, False: 10000}
STEPS_LARGE = {True: 4, False: 1000}
STEPS_OF = {"plummer": 500, "net": 1000, "heap": 1000, "dam": 2000}  # in the full form: these take long
STEPS_RTL = {True: 4, False: 100}
QUICK = ["balls", "chain", "cloth", "planets", "train"]
SLOW = {"stars"}  # on engine isa
ALONE = "one object at a time"
NEAR = {"balls", "gas", "heap", "dam", "cradle"}
BIG = {"net", "heap", "dam"}  # as they are
SKINS = (0, 0.02, 1, 10)
# What is replaced in a scene, and by what. Small: it fits into the hardware. Large: several blocks of engine fast, one for a thread.
TIGHT = (r"apart = 0.1", "apart = 0.09")  # some balls touch at the start
SMALL = {"cloth": ("cloth 8 x 8", [(r"count = \[20, 20\]", "count = [8, 8]"), (r"objects = \[0, 19\]", "objects = [0, 7]")]),
         "balls": ("balls, 60", [(r"objects = 300", "objects = 60"), TIGHT]),
         "stars": ("stars, 60", [(r"objects = 300", "objects = 60")]),
         "net": ("net 10 x 10", [(r"count = \[128, 128\]", "count = [10, 10]"), (r'"0\.\.127"', '"0..9"')]),
         "dam": ("dam, 6 x 12", [(r"count = \[20, 40\]", "count = [6, 12]")]),
         "gas": ("gas, 60", [(r"objects = 300", "objects = 60"), (r'"0\.\.149"', '"0..29"'), TIGHT]),
         "heap": ("heap, 60", [(r"objects = 10000", "objects = 60"), (r"to = \[3.15, 2.2, 3.15\]", "to = [0.5, 0.5, 0.5]"), TIGHT])}
LARGE = {"cloth": ("cloth 50 x 50", [(r"count = \[20, 20\]", "count = [50, 50]"), (r"objects = \[0, 19\]", "objects = [0, 49]")]),
         "balls": ("balls, 2000", [(r"objects = 300", "objects = 2000"), (r"to = \[0.95, 2.0, 0.95\]", "to = [0.95, 12.0, 0.95]"), TIGHT]),
         "chain": ("chain, 2000", [(r"count = 34", "count = 2000"), (r"objects = \[0, 33\]", "objects = [0, 1999]")]),
         "stars": ("stars, 1200", [(r"objects = 300", "objects = 1200")])}


def form_of(name, forms):
    """Its name, and the scene's text."""
    label, changes = forms.get(name, (name, []))
    text = ws.text_of(name)
    for change in changes:
        text = ws.replace(text, *change)
    return label, text


# ---- objects in another order ----

def table(path, head, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([head, *rows])
    return path


def shuffled(folder, name, seed=1):
    """The scene with its objects in another order, and which object of it each one is: None where the order is part of the sum."""
    if name == "chain":
        count, spacing, integrator = (34,), 1, "rk4"
        start = {"u": [0.1 if i == 8 else 0.0 for i in range(34)], "w": [0.0 if i in (0, 33) else 1.0 for i in range(34)]}
        links = [(a, b, 100) for a, b, _ in ws.grid_links(count, spacing, ["structural"])]
        head = ["a", "b", "k"]
    elif name == "cloth":
        count, spacing, integrator = (20, 20), 0.05, "semi_implicit_euler"
        start = {"x_x": [spacing * (i % 20) for i in range(400)], "x_y": [2.0] * 400, "x_z": [spacing * (i // 20) for i in range(400)],
                 "w": [0.0 if i in (0, 19) else 1000.0 for i in range(400)]}
        links = [(a, b, k, length) for kinds, k in ((["structural", "shear"], 100), (["bending"], 10)) for a, b, length in ws.grid_links(count, spacing, kinds)]
        head = ["a", "b", "k", "rest"]
    else:
        return None
    order = np.random.default_rng(seed).permutation(int(np.prod(count)))  # the place of each object
    columns = {state: np.empty(len(order)) for state in start}
    for state, values in start.items():
        columns[state][order] = values
    points = table(folder / "shuffled.csv", list(columns), zip(*([repr(float(v)) for v in column] for column in columns.values())))
    file = table(folder / "shuffled_links.csv", head, [(order[a], order[b], *map(repr, map(float, fields))) for a, b, *fields in links])
    text = (f'groups = ( {{ program = "{ws.FOLDER}/{name}.ode"; integrator = "{integrator}"; points = "{points}"; '
            f'links = {{ relation = "springs"; file = "{file}"; }}; }} );\n')
    return text, order


# ---- one scene ----

class Scene:
    def __init__(self, fp3, folder, label, text, steps, say):
        self.fp3, self.folder, self.label, self.steps, self.say = fp3, folder, label, steps, say
        self.path = ws.put(folder, text)
        self.wanted, self.rows, self.refused = None, [], []

    def try_one(self, engine, variant, path=None, order=None, **how):
        """A row; the first one is what all others are compared with."""
        try:
            found = ws.words(self.fp3, path or self.path, engine, self.steps, **how)
        except ws.Failed as why:
            if not why.is_limit():
                raise
            self.refused.append({"scene": self.label, "engine": engine, "variant": variant, "why": str(why).split(": ", 2)[-1]})
            return
        if order is not None:
            found = found[order]
        if self.wanted is None:
            self.wanted = found
        self.rows.append({"scene": self.label, "engine": engine, "variant": variant, "steps": self.steps, "hash": ws.hash_of(found),
                          "words_differing": ws.differing(found, self.wanted)})
        self.say(f"{self.label}, {engine}, {variant}: {self.rows[-1]['hash']}")


def on_fast(scene, threads, is_large=False):
    """In large scenes one kind of native code: that of small scenes is the same."""
    scene.try_one("fast", "interpreter, 1 thread", fast="interpreter")
    kinds = ws.kinds()
    if threads > 1:
        scene.try_one("fast", f"interpreter, {threads} threads", threads=threads, fast="interpreter")
    for kind in [] if is_large else kinds[:-1]:
        scene.try_one("fast", f"native {kind}, 1 thread", fast=kind)
    for n in range(1, threads + 1):
        scene.try_one("fast", f"native {kinds[-1]}, {n} thread{'s' * (n > 1)}", threads=n, fast=kinds[-1])


def on_skins(scene, text, skins=SKINS):
    for skin in skins:
        path = ws.put(scene.folder, ws.add(text, f"skin = {float(skin)!r};"), "skin")
        scene.try_one("fast", f"skin {skin:g}, 2 threads", path=path, threads=2)


def measure(fp3, folder, quick, say, names=None):
    """The rows of all scenes, or of these, and what an engine has no room for."""
    rows, refused = [], []

    def make(name, forms, steps):
        return Scene(fp3, folder, *form_of(name, forms), steps, say)

    def keep(scene):
        rows.extend(scene.rows)
        refused.extend(scene.refused)
    for name in names or (QUICK if quick else ws.names()):
        scene = make(name, SMALL if quick or name in SLOW else {}, STEPS[quick] if quick else STEPS_OF.get(name, STEPS[quick]))
        scene.try_one("isa", ALONE)
        on_fast(scene, 4 if name in BIG else 1)
        if name in NEAR and not quick:
            on_skins(scene, ws.text_of(name), [skin for skin in SKINS if name not in BIG or skin < 10])  # a list of thousands takes minutes
        other = shuffled(folder, name) if not quick or name == "chain" else None
        if other:
            scene.try_one("fast", "objects in another order", path=ws.put(folder, other[0], "shuffled"), order=other[1])
        keep(scene)
        if name in LARGE:
            scene = make(name, LARGE, STEPS_LARGE[quick])
            on_fast(scene, 2 if quick else 4, is_large=quick)
            if name in NEAR:
                on_skins(scene, form_of(name, LARGE)[1])
            keep(scene)
        scene = make(name, SMALL, STEPS_RTL[quick])
        scene.try_one("isa", ALONE)
        for config in ws.worlds():
            scene.try_one("rtl", config, config=config)
        keep(scene)
    return rows, refused

"""What whole scenes need not do: sleep, shorter lists, kinds that do not move, outputs that nobody reads, lower precision; what each saves, and costs.

A case has sides: the first does all the work, each other one leaves something out. All make the same steps, and take turns.
"""

import dataclasses
import re
import resource
import sys
import time

from fp3scenes.page import skipped as pages                     # noqa: F401  (tools/scenes.py asks for it)
from fp3world import scene as ws

TURNS = 9
RTL = (2, 4)                        # steps of the simulated hardware; the difference counts


@dataclasses.dataclass
class Side:
    what: str
    text: str                       # of the scene
    config: str = None
    options: tuple = ()             # of fp3 run: then its whole run is timed
    most: float = 0                 # how far from the first side it may end, as a share; 0: it has the same bits
    small: str = None               # the scene for the hardware; None: no cycles


@dataclasses.dataclass
class Case:
    name: str
    scene: str
    sides: list
    objects: int                    # that move
    steps: int                      # of one turn
    before: int = 0                 # steps before any is timed
    objects_small: int = 0          # of the hardware
    before_small: int = 0
    size: float = 1.0               # of what the difference is a share


# ---- models and scenes that leave something out, and those that do not --------------------------------

def changed(folder, name, model, *changes):
    """A model of programs/world, changed; its path."""
    text = (ws.FOLDER / f"{model}.ode").read_text(encoding="utf-8")
    for old, new in changes:
        text = ws.replace(text, old, new)
    path = folder / f"{name}.ode"
    path.write_text(text, encoding="utf-8")
    return path


def by(text, path):
    """The scene, by another model."""
    return ws.replace(text, r'program = "[^"]*"', f'program = "{path}"')


def heap(is_small):
    """How many balls, and the scene."""
    objects, side = (48, 0.4) if is_small else (1000, 1.0)
    text = ws.text_of("heap")
    for change in ((r"objects = 10000", f"objects = {objects}"), (r"to = \[3.15, 2.2, 3.15\]", f"to = [{side - 0.05:g}, 2.2, {side - 0.05:g}]"), (r"side = 3.2", f"side = {side}")):
        text = ws.replace(text, *change)
    return objects, text


def settled(folder, is_small):
    """The heap as it lies after some seconds, as fp3 has it then."""
    balls, text = heap(is_small)
    words, names = ws.words_of(ws.call(folder / "fp3", ws.put(folder, text, "falling"), "--engine", "fast", "--steps", 12288, "--all"))
    path = write_points(folder / f"settled_{balls}.csv", ("x_x", "x_y", "x_z"), words[:, [names.index(f"x_{axis}") for axis in "xyz"]].view("f4").tolist())
    return ws.replace(ws.replace(text, r"objects = \d+;\n", ""), r"random  = \{.*\};", f'points = "{path}";')


def write_points(path, names, rows):
    path.write_text("\n".join([",".join(names), *(",".join(f"{value:.9g}" for value in row) for row in rows)]) + "\n", encoding="utf-8")
    return path


def sleep(folder, quick):
    """Who lies still."""
    path = changed(folder, "sleepy", "balls", ("(?m)^x' = v$", "rest when norm(v) < 0.05 for 0.125 [s]\n\nx' = v"))
    whole, small = settled(folder, quick), settled(folder, True)
    sides = [Side("all awake", whole, small=small), Side("all asleep (`rest`)", by(whole, path), most=2e-2, small=by(small, path))]
    return Case("sleep", "heap", sides, heap(quick)[0], 32 if quick else 1024, before=1024, objects_small=48, before_small=1024)


def skins(text, small):
    for skin in (1, 0.3, 0.1):
        yield Side(f"lists, skin {skin:g}{' (default)' if skin == 0.3 else ''}", ws.add(text, f"skin = {skin};"), small=ws.add(small, f"skin = {skin};"))


def lists(folder, quick):
    """Pairs that are too far apart to touch."""
    (balls, text), (_, small) = heap(quick), heap(True)
    every = changed(folder, "every", "balls", (r"near touch\(x, 2\*R\)", "all touch"),
                    (r"(?m)^F = .*$", "F = sum(o in touch: dot(o.x - x, o.x - x) < 4*R*R ? (stiff*(norm(o.x - x) - 2*R)/norm(o.x - x))*(o.x - x) + damp*(o.v - v) : 0*damp*v)"))
    sides = [Side("every pair (`all`)", by(text, every), small=by(small, every)), *skins(text, small)]
    return Case("lists", "heap", sides, balls, 32 if quick else 256, before=1024, objects_small=48, before_small=1024)


def water(_, quick):
    text, small = (ws.replace(ws.text_of("dam"), r"count = \[20, 40\]", f"count = {count}") for count in ("[10, 20]" if quick else "[20, 40]", "[6, 8]"))
    return Case("lists", "dam", list(skins(text, small)), 200 if quick else 800, 64, before=256, objects_small=48, before_small=64)


def bed(folder, name, balls, ground):
    """Balls on balls that do not move: all of one kind, and the latter as a kind of their own."""
    push = "(stiff*(norm(o.x - x) - 2*R)/norm(o.x - x))*(o.x - x)"
    held = changed(folder, f"{name}_held", "balls", ("(?m)^state v", "param loose = 1 [1]\nstate v"),
                   ("(?m)^v' = .*$", "v' = loose*(g + (F + stiff*(low - high) - wall)/m)"))
    seeing = changed(folder, f"{name}_seeing", "balls", (r"near touch\(x, 2\*R\)", "kind ground(x[3] [m])\nnear touch(x, 2*R)\nnear stand(x, ground.x, 2*R)"),
                     ("(?m)^F = .*$", f"F = sum(o in touch: {push} + damp*(o.v - v)) + sum(o in stand: {push} - damp*v)"))
    (folder / "ground.ode").write_text('model ground "balls that nothing moves"\nstate x[3] = (0, 0, 0) [m]\nstep 0.0009765625 [s]\nx\' = (0, 0, 0)\n', encoding="utf-8")

    def group(program, rows, *more, integrator="semi_implicit_euler"):
        path = write_points(folder / f"{name}_{program.stem}.csv", ("x_x", "x_y", "x_z", *more), rows)
        return f'{{ program = "{program}"; integrator = "{integrator}"; points = "{path}"; }}'
    yield f"steps = 4096;\ngroups = ( {group(held, [(*ball, 1) for ball in balls] + [(*ball, 0) for ball in ground], 'loose')} );\n"
    yield f"steps = 4096;\ngroups = ( {group(seeing, balls)}, {group(folder / 'ground.ode', ground, integrator='euler')} );\n"


def layer(wide, deep, apart, at):
    return [(0.05 + apart * (k % wide), at, 0.05 + apart * (k // wide)) for k in range(wide * deep)]


def still(folder, quick):
    """Who never moves."""
    balls = [ball for number in range(1 if quick else 4) for ball in layer(8, 8, 0.112 + 0.001 * number, 0.2 + 0.11 * number)]
    whole, small = bed(folder, "bed", balls, layer(18, 18, 0.05, 0.0)), bed(folder, "little", layer(4, 4, 0.112, 0.15), layer(6, 5, 0.06, 0.0))
    sides = [Side("as balls that are held", next(whole), small=next(small)), Side("as a kind that does not move", next(whole), most=1e-2, small=next(small))]
    return Case("kinds", "balls", sides, len(balls), 32 if quick else 256, before=512, objects_small=16, before_small=512)


def stars(count, more=""):
    text = ws.replace(ws.replace(ws.text_of("stars"), "objects = 300", f"objects = {count}"), "m = 0.00333", f"m = {1 / count!r}")
    return ws.add(text, more) if more else text


def precision(_, quick):
    """Digits."""
    count = 24 if quick else 100

    def side(what, more="", config=None, most=0.0):
        return Side(what, stars(count, more), config, most=most, small=stars(24, more))
    return Case("precision", "stars", [side("double-single, 48 bits", "double_single = true;"), side("FP32 with compensated sums", "compensated = true;", most=1e-5), side("FP32", most=1e-5),
                                       side("bfloat16 (`world_bfloat`)", config="world_bfloat", most=2)], count, 32 if quick else 64, objects_small=24)


def records(_, quick):
    """Digits of what is stored. No processor of objects that see each other has records of 16 bits, so these are alone."""
    text = re.sub('config = .*\n|engine = .*\n', "", ws.text_of("lorenz", ws.ROOT / "programs/gallery"))
    small = ws.replace(text, "objects = 2000", "objects = 64")
    return Case("precision", "lorenz", [Side("records of 32 bits (`many_full`)", text, "many_full", small=small), Side("records of 16 bits (`many_half`)", text, "many_half", most=2, small=small)],
                2000, 32 if quick else 512, objects_small=64, size=20)


def cloth(count):
    text = ws.replace(ws.text_of("cloth"), r"count = \[20, 20\]", f"count = [{count}, {count}]")
    return ws.replace(text, r"objects = \[0, 19\]", f"objects = [0, {count - 1}]")


def outputs(_, quick):
    """What is recorded and nobody reads."""
    count = 40 if quick else 100
    return Case("outputs", "cloth", [Side("all states, every 4 steps", cloth(count), options=("--output", "all.h5", "--every", 4)),
                                     Side("the height alone (`--observe x_y`)", cloth(count), options=("--output", "one.h5", "--every", 4, "--observe", "x_y")),
                                     Side("no recording", cloth(count), options=("--threads", 1))], count * count, 64 if quick else 512)


CASES = [sleep, lists, water, still, outputs, precision, records]
SCENES = ["heap", "dam", "balls", "cloth", "stars", "lorenz"]


# ---- measuring ---------------------------------------------------------------------------------------

class Runner:
    """A side on engine fast."""

    def __init__(self, case, side, options):
        self.case, self.side, self.options, self.seconds = case, side, options, float("inf")
        self.path = ws.put(options.folder, side.text, "skipped")
        self.scene = None if side.options else open_scene(self.path, side.config)
        if self.scene:
            self.scene.run(case.before, check_failures=False)

    def turn(self):
        self.seconds = min(self.seconds, self.of_command() if self.side.options else self.of_scene())

    def of_scene(self):
        begin = time.process_time()
        self.scene.run(self.case.steps, check_failures=False)
        return (time.process_time() - begin) / self.case.steps

    def of_command(self):
        """With its start, which all sides have."""
        def used():
            found = resource.getrusage(resource.RUSAGE_CHILDREN)
            return found.ru_utime + found.ru_stime
        begin = used()
        words = [str(self.options.folder / word) if str(word).endswith(".h5") else word for word in self.side.options]
        ws.call(self.options.fp3, ws.put(self.options.folder, self.side.text, "skipped"), "--engine", "fast", "--steps", self.case.steps, *words)
        return (used() - begin) / self.case.steps

    def states(self):
        """By name, of the objects of the first group."""
        if self.scene:
            group = self.scene.groups[0]
            return {name: group[name] for name in group.names}
        said = ws.call(self.options.fp3, self.path, "--engine", "fast", "--steps", self.case.steps, "--all")
        words, names = ws.words_of(said)
        return dict(zip(names, words.view("f4").T))


def open_scene(path, config):
    """The package loads the library of the build, which pages and help do without."""
    sys.path.insert(0, str(ws.ROOT / "python"))
    import fp3
    try:
        return fp3.Scene(path, engine="fast", threads=1, config=config)
    except fp3.errors.Error as why:
        raise ws.Failed(str(why)) from None


def words_differing(first, other):
    """None: the words are of another kind, or of other states."""
    if first.keys() != other.keys() or any(first[name].dtype != other[name].dtype or len(first[name]) != len(other[name]) for name in first):
        return None
    return sum(int((first[name].view("u4") != other[name].view("u4")).sum()) for name in first)


def apart(case, first, other):
    """Root mean square of the distance of an object on both sides, as a share of the size."""
    names = [name for name in first if re.fullmatch(r"x(_[xyz])?|[yz]", name)]
    square = sum((first[name][:len(other[name])].astype(float) - other[name]) ** 2 for name in names)
    return float(square.mean() ** 0.5 / case.size)


def cycles(case, side, options):
    """Of one step, by the simulated hardware."""
    path, kept = ws.put(options.folder, side.small, "little"), options.folder / "little.fp3c"
    config = ["--config", side.config] if side.config else []
    before = case.before_small
    if before:
        ws.call(options.fp3, path, "--engine", "fast", "--steps", before, "--checkpoint", kept, *config)
    counted = []
    for steps in RTL:
        said = ws.call(options.fp3, path, "--engine", "rtl", "--steps", before + steps, *(["--restart", kept] if before else []), "--allow-failures", *config)
        counted.append(int(re.search(r"^cycles +(\d+)$", said, re.M)[1]))
    return (counted[1] - counted[0]) / (RTL[1] - RTL[0])


def rows_of(case, options):
    runners = [Runner(case, side, options) for side in case.sides]
    for _ in range(2 if options.quick else TURNS):
        for runner in runners:
            runner.turn()
    first, ends = runners[0], [runner.states() for runner in runners]
    counted = [cycles(case, side, options) if side.small else None for side in case.sides]
    for runner, end, count in zip(runners, ends, counted):
        side, differing = runner.side, words_differing(ends[0], end)
        yield {"scene": case.scene, "what": side.what, "way": case.name, "beside": first.side.what, "is_first": runner is first, "ns_per_object_step": 1e9 * runner.seconds / case.objects,
               "share": runner.seconds / first.seconds, "cycles_per_object_step": None if count is None else count / case.objects_small,
               "share_of_cycles": None if count is None else count / counted[0], "words_differing": differing,
               "error": 0.0 if differing == 0 else apart(case, ends[0], end), "most": side.most}


def measure(options, say):
    rows, kept = [], options.folder / "fp3"
    if not kept.exists():               # where cases find it
        kept.symlink_to(options.fp3.resolve())
    for make in CASES:
        case = make(options.folder, options.quick)
        if options.scenes and case.scene not in options.scenes:
            continue
        found = list(rows_of(case, options))
        rows += found
        say(f"{case.name} of {case.scene}: " + ", ".join(f"{row['what']} {row['share']:.3g}" for row in found[1:]))
    return rows


def wrong(rows):
    for row in rows:
        name = f"{row['scene']}, {row['what']}"
        if not row["most"] and row["words_differing"]:
            yield f"{name}: {row['words_differing']} words differ from {row['beside']}"
        if not row["error"] <= row["most"]:
            yield f"{name}: it ends {row['error']:.3g} from {row['beside']}, expected {row['most']:g} at most"

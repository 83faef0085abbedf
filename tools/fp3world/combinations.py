"""What goes with what: each relation with each feature, on each engine. A cell works if it gives the same words on each of them, or fp3 says why not."""

import ctypes
import importlib
import os
import re
import shutil
import subprocess
import sys

import numpy as np
from fp3cluster.lab import environment
from fp3gen.text import between, markdown
from fp3world import scene as ws

ENGINES = ("isa", "fast", "rtl")
OBJECTS, STEPS, HALF, PEG_COUNT, RANKS = 12, 8, 4, 3, 2
MPI = {"OMPI_MCA_odls_base_sigkill_timeout": "0"}  # a rank that refuses ends the others at once
NO_MPI = "not tried: needs MPI (`make setup-cluster all`)"
# Of the model: the relation, and what an object feels of a neighbour. `several` has two relations, `kinds` sees a group of another model beside its own.
RELATIONS = {"links": ("links ties(k = 8)", "sum(o in ties: o.k*(o.x - x))"), "near": ("near ties(x, 0.35)", "sum(o in ties: 4*(x - o.x))"),
             "all": ("all ties", "sum(o in ties: (o.x - x)/(1 + (o.x - x)^2))"),
             "several": ("links bars(k = 8)\nnear ties(x, 0.35)", "sum(o in bars: o.k*(o.x - x)) + sum(o in ties: 4*(x - o.x))"),
             "kinds": ("kind pegs(x, v)\nnear bars(x, 0.35)\nnear ties(x, pegs.x, 0.35)", "sum(o in bars: 4*(x - o.x)) + sum(o in ties: 4*(x - o.x))")}
MODEL = """\
model cell
param m = 1
state x = 0
state v = 0
{relation}
step 0.0078125
span 0.0625
F = {pull}
x' = v
v' = F/m
{more}
"""
GROUP = """\
{{ program = "{model}"; integrator = "{integrator}"; grid = {{ position = "x"; count = {objects}; spacing = 0.25; }}; {links} {settings} }}"""
PEGS = """\
model pegs
kind cell(x)
state x = 0
state v = 0
near seen(x, cell.x, 0.35)
step 0.0078125
span 0.0625
x' = v
v' = sum(o in seen: 4*(x - o.x))
"""


class Cell:
    """One relation, one feature, one engine."""

    def __init__(self, fp3, folder, relation, feature, engine):
        self.fp3, self.folder, self.relation, self.feature, self.engine = fp3, folder, relation, feature, engine
        self.before = []  # of the command
        declared, pull = RELATIONS[relation]
        if feature.field:
            declared = re.sub(r"(ties\([^)]*)", rf"\1, {feature.field}", declared)
        self.model = folder / "cell.ode"
        self.model.write_text(MODEL.format(relation=declared, pull=pull, more=feature.more.format(pull=pull)))

    def scene(self):
        """Its scene, with what the feature sets."""
        declared, feature = RELATIONS[self.relation][0], self.feature
        linked = re.search(r"^links (\w+)", declared, re.M)
        links = f'links = {{ relation = "{linked[1]}"; grid = "structural"; }};' if linked else ""
        groups = [GROUP.format(model=self.model, integrator=feature.integrator, objects=OBJECTS, links=links,
                               settings=feature.settings + feature.both)]
        if self.relation == "kinds":
            (self.folder / "pegs.ode").write_text(PEGS)
            groups.append(f'{{ program = "{self.folder}/pegs.ode"; integrator = "{feature.integrator}"; objects = {PEG_COUNT}; '
                          f'spread = {{ x = [0.1, 2.1]; }}; {feature.both} }}')
        return ws.put(self.folder, f"steps = {STEPS};\ngroups = ( {', '.join(groups)} );\n", "cell")

    def call(self, *arguments):
        """What a command prints; Refused if it says why not."""
        try:
            done = subprocess.run([*self.before, self.fp3, *map(str, arguments)], capture_output=True, text=True, env=environment(RANKS) | MPI)
        except OSError as why:
            raise ws.Failed(f"{self.fp3}: {why.strerror}") from why
        if done.returncode == 2:
            raise Refused(reason(done.stderr, self.folder))
        if done.returncode:
            raise ws.Failed(f"{self.relation}, {self.feature.name}, {self.engine}: exit code {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def options(self):
        return ["--engine", self.engine, "--config", self.feature.config, *(["--threads", 1] if self.engine == "fast" else [])]

    def words(self, *options):
        said = self.call("run", "--scene", self.scene(), "--all", *self.options(), *self.feature.options, *options)
        if self.relation != "kinds":
            return ws.words_of(said)[0]
        found = ws.all_words(said)
        if len(found) < 2 * (OBJECTS + PEG_COUNT):
            raise ws.Failed("fp3 run --all prints no state of each object")
        return found


class Refused(Exception):
    """fp3 says that the two do not go together."""


def reason(said, folder):
    """The message, without the place."""
    lines = [line for line in said.splitlines() if line.strip() and not line.startswith("    ")]
    text = lines[0] if lines else "no message"
    text = re.sub(rf"{re.escape(str(folder))}/\w+\.\w+", "", text)
    text = re.sub(r"model 'cell' has '\w+' \(line \d+\): |^.*objects of model 'cell' see each other \('\w+', line \d+\), and ", "", text)
    text = re.sub(r" \(line \d+ of the model\)", "", text)
    text = re.sub(r"'(ties|bars)' needs", "the relation needs", re.sub(r"\bline \d+: ", "", text))
    return re.sub(r"^(fp3 \w+: |:(\d+:)* *|error: |group \d+: |engine '\w+': )+", "", text).strip()


def run(cell):
    return cell.words("--steps", STEPS)


def checkpoint(cell):
    """A run in two halves."""
    file = cell.folder / "half.checkpoint"
    file.unlink(missing_ok=True)
    cell.words("--steps", HALF, "--checkpoint", file)
    return cell.words("--steps", STEPS, "--restart", file)


def recording(cell):
    """It has all snapshots."""
    output, found = record(cell, "cell.csv")
    rows = [line for line in output.read_text().splitlines() if line][1:]
    if len(rows) != 3 * OBJECTS:
        raise ws.Failed(f"{cell.relation}: a recording has {len(rows)} rows, expected {3 * OBJECTS}")
    return found


def checked(cell):
    """With --check, an estimate of each state's error."""
    said = cell.call("run", "--scene", cell.scene(), "--all", *cell.options(), "--steps", STEPS, "--check")
    if "worst" not in said:
        raise ws.Failed(f"{cell.relation}: --check has no estimate: {said}")
    return run(cell)


def ranks(cell):
    """Several processes, which Open MPI starts even where there are fewer processors."""
    if not shutil.which("mpirun") or not (cell.fp3.absolute().parent / "lib/fp3/fp3_mpi.so").exists():
        raise Refused(NO_MPI)
    cell.before = ["mpirun", "--oversubscribe", "-n", str(RANKS)]
    return run(cell)


def package(cell):
    """The package of Python from the sources, over the library and the engines beside the command."""
    os.environ["FP3_HOME"] = str(cell.fp3.absolute().parent)
    if str(ws.ROOT / "python") not in sys.path:
        sys.path.insert(0, str(ws.ROOT / "python"))
    return importlib.import_module("fp3")


def in_python(use):
    """What `use` does with the package and the cell; the package says why not."""
    def trial(cell):
        fp3 = package(cell)
        try:
            return use(fp3, cell)
        except fp3.Error as why:
            raise Refused(reason(str(why), cell.folder)) from why
    return trial


def batch(fp3, cell):
    linked = re.search(r"^links (\w+)", RELATIONS[cell.relation][0], re.M)
    links = {linked[1]: (np.arange(OBJECTS - 1), np.arange(1, OBJECTS))} if linked else None
    return fp3.Batch(str(cell.model), OBJECTS, method=cell.feature.integrator, config=cell.feature.config, engine=cell.engine, threads=1, links=links)


def batch_words(fp3, cell):
    with batch(fp3, cell) as objects:
        objects["x"] = 0.25 * np.arange(OBJECTS)
        objects.run(STEPS)
        return np.ascontiguousarray(objects.read(("x", "v"))).view(np.uint32)


def column(fp3, cell):
    """What stands in the engine's own memory."""
    found, address = [], ctypes.c_void_p()
    with batch(fp3, cell) as objects, objects._c() as c:  # pylint: disable=protected-access
        objects["x"] = 0.25 * np.arange(OBJECTS)
        objects.run(STEPS)
        for name in (b"x", b"v"):
            if objects._lib.fp3_batch_column(c, name, address):  # pylint: disable=protected-access
                raise ws.Failed(f"{cell.relation}: fp3_batch_column finds no '{name.decode()}'")
            if address.value is None:
                raise Refused("`fp3_batch_column` is NULL; `fp3_batch_read` copies")
            found.append(np.copy(np.ctypeslib.as_array(ctypes.cast(address, ctypes.POINTER(ctypes.c_uint32)), (OBJECTS,))))
    return np.stack(found, -1)


def scene_words(fp3, cell):
    with fp3.Scene(str(cell.scene()), config=cell.feature.config, engine=cell.engine, threads=1) as scene:
        scene.run(STEPS)
        found = [np.stack([group["x"], group["v"]], -1) for group in scene.groups]
    words = np.concatenate(found).view(np.uint32)
    return words if len(found) == 1 else words.ravel()


def record(cell, name):
    """A recording of a run."""
    path = cell.folder / name
    path.unlink(missing_ok=True)
    return path, cell.words("--steps", STEPS, "--output", path, "--every", HALF, *(("--group", "cell") if cell.relation == "kinds" else ()))


def viewed(cell):
    """A page of a recording."""
    path, found = record(cell, "cell.csv")
    page = path.with_suffix(".html")
    cell.call("view", path, "--position", "time,x", "-o", page)
    if page.stat().st_size < 1000:
        raise ws.Failed(f"{cell.relation}: the page of fp3 view has {page.stat().st_size} bytes")
    return found


def verified_recording(cell):
    """Run again by fp3 verify, with one hash after the other."""
    path, found = record(cell, "cell.h5")
    cell.call("verify", path)
    return found


def verified_checkpoint(cell):
    file = cell.folder / "cell.checkpoint"
    file.unlink(missing_ok=True)
    found = cell.words("--steps", STEPS, "--checkpoint", file)
    cell.call("verify", file)
    return found


def told(*command):
    """A command that prints what it finds out: there are no words to compare."""
    def tell(cell):
        cell.call(*command, cell.scene())
        return np.zeros(0, dtype=np.uint32)
    return tell


class Feature:
    """more: lines of the model; field: of its relation; settings: of the group; both: of the other group, too; options: of fp3 run. engines: where it is tried.
    is_beside: its words are those of fp3 run alone."""

    def __init__(self, name, more="", field="", settings="", both="", options=(), integrator="leapfrog", config="world", trial=run, engines=ENGINES, is_beside=False):
        self.name, self.more, self.field, self.settings, self.both, self.options = name, more, field, settings, both, list(options)
        self.integrator, self.config, self.trial, self.engines, self.is_beside = integrator, config, trial, engines, is_beside


INTEGRATORS = ("euler", "semi_implicit_euler", "leapfrog", "verlet", "heun", "rk4", "rk8", "yoshida6", "rkc8", "stoermer_verlet", "ros2")
FEATURES = [
    *(Feature(f"integrator `{name}`", integrator=name) for name in INTEGRATORS),
    Feature("compensated", settings="compensated = true;"),
    Feature("double-single", both="double_single = true;"),
    Feature("adaptive steps", both="tolerance = 1e-4; until = 0.03125;", integrator="cash_karp"),
    Feature("projections with sums, `h`, `prev`", more="project v = (x - prev(x))/h + 0.01*({pull})"),
    Feature("projections that are repeated", more="repeat 3\nproject v = v + 0.001*({pull})\nend\nproject v = v + prev(v)/64"),
    Feature("pairs that remember", more="remember o in ties: o.s = o.s + h*(o.v - v)", field="s = 0"),
    Feature("events", more="when x > 1: v = -v"),
    Feature("events with sums", more="when {pull} > 0.1: v = 0.5*v"),
    Feature("events that stop an object", more="when x > 1: stop"),
    Feature("events that remove an object", more="when x > 1: remove"),
    Feature("fixed steps cut at events", more="when root(x - 1) rising: v = -v", both="until = 0.0625;", integrator="rk4"),
    Feature("lifetimes", settings="born = [0, 4]; gone = 7;"),
    Feature("lifetimes where pairs remember", more="remember o in ties: o.s = o.s + h*(o.v - v)", field="s = 0", settings="born = [0, 4]; gone = 7;"),
    Feature("objects at rest", more="rest when abs(v) < 0.01 for 0.125", settings="spread = { at_rest = [-1.0, 1.0]; };"),
    Feature("several lanes", config="fabric"),
    Feature("several schedulers", config="shared"),
    Feature("numbers of 16 bits", config="world_bfloat"),
    Feature("records of 16 bits", config="many_half"),
    Feature("pairs of lanes, `dual`", config="dual"),
    Feature("logarithmic arithmetic", config="world_log"),
    Feature("checkpoints", trial=checkpoint),
    Feature("recordings", trial=recording),
    Feature("`fp3 view` of a recording", trial=viewed, engines=("fast",)),
    Feature("`fp3 verify` of a recording", trial=verified_recording),
    Feature("`fp3 verify` of a checkpoint", trial=verified_checkpoint),
    Feature("two processes, `mpirun -n 2`", trial=ranks, engines=("fast",), is_beside=True),
    Feature("a batch in Python", trial=in_python(batch_words), is_beside=True),
    Feature("a column of a batch without a copy", trial=in_python(column), engines=("fast",), is_beside=True),
    Feature("a scene in Python", trial=in_python(scene_words), is_beside=True),
    Feature("`fp3 run --check`", trial=checked),
    Feature("`fp3 run --check` where pairs remember", trial=checked, more="remember o in ties: o.s = o.s + h*(o.v - v)", field="s = 0"),
    Feature("`fp3 run --check` with lifetimes", trial=checked, settings="born = 2; gone = 7;"),
    Feature("`fp3 bench` of a scene", trial=told("bench", "--steps", STEPS, "--quick"), engines=("fast",)),
    Feature("`fp3 stress` of a scene", trial=told("stress"), engines=("fast",)),
    # The force of these scenes jumps at the reach, so no two lengths of step agree closely.
    Feature("`fp3 tune` of a scene", trial=told("tune", "--tolerance", 0.9, "--within", 0.09, "--held-out", 1, "--around", 1e-6), engines=("fast",)),
    Feature("`fp3 compare` of a scene", trial=told("compare", "--steps", STEPS, "--halvings", 0, "--within", 1000), engines=("fast",)),
]


def sampled(number):
    """With which relations a feature is tried in the quick form: one after the other has each pair of neighbours in their list, in turn."""
    relations = list(RELATIONS)
    return {relations[number % len(relations)], relations[(number + 1) % len(relations)]}


def measure(fp3, folder, say, features=None, is_quick=False):
    """A row of each cell; is_quick: of each feature with two of the relations."""
    rows = []
    for relation in RELATIONS:
        for number, feature in enumerate(features or FEATURES):
            if is_quick and relation not in sampled(number):
                continue
            wanted = run(Cell(fp3, folder, relation, feature, feature.engines[0])) if feature.is_beside else None
            for engine in feature.engines:
                try:
                    found = feature.trial(Cell(fp3, folder, relation, feature, engine))
                    wanted = found if wanted is None else wanted
                    state = "works" if np.array_equal(found, wanted) else f"{ws.differing(found, wanted)} words differ"
                except Refused as why:
                    state = str(why)
                rows.append({"relation": relation, "feature": feature.name, "engine": engine, "state": state})
        say(f"{relation}: {sum(row['state'] == 'works' for row in rows if row['relation'] == relation)} cells work")
    return rows


def wrong(rows):
    """Cells that give other words on one engine than on another."""
    return [row for row in rows if row["state"].endswith("words differ")]


HEADS = {"links": "links", "near": "near", "all": "all", "several": "several relations", "kinds": "a second kind"}


def table(rows):
    """A line for each feature; a number is that of the reason below."""
    why, lines = {}, {}
    for row in rows:
        state = "yes" if row["state"] == "works" else f"[{why.setdefault(row['state'], len(why) + 1)}]"
        lines.setdefault(row["feature"], {}).setdefault(row["relation"], {})[row["engine"]] = state

    def cell(states):
        if len(set(states.values())) == 1:
            return next(iter(states.values()))
        return ", ".join(f"`{engine}` {state}" for engine, state in states.items())
    yield from markdown(["", *HEADS.values()], ([feature, *(cell(found[relation]) for relation in HEADS)] for feature, found in lines.items()))
    works = sum(row["state"] == "works" for row in rows)
    yield from ("", f"{works} of {len(rows)} cells work ({len(ENGINES)} engines, or `fast` alone for commands that measure or draw, for processes and for columns). The others are refused, in these words:", "")
    yield from (f"{number}. {text}" for text, number in why.items())


def differing(text, rows):
    """Of rows, those that the page does not have so, and features that it does not have."""
    whys = dict(re.findall(r"^(\d+)\. (.*)$", text, re.M))
    lines = {cells[0]: dict(zip(HEADS, cells[1:])) for cells in (line[2:-2].split(" | ") for line in text.splitlines() if line.startswith("| "))}

    def said(feature, relation, engine):
        cell = lines.get(feature, {}).get(relation, "missing")
        cell = dict(re.findall(r"`(\w+)` (yes|\[\d+\])", cell)).get(engine, cell)
        return "works" if cell == "yes" else whys.get(cell.strip("[]"), cell)
    return [row for row in rows if said(row["feature"], row["relation"], row["engine"]) != row["state"]]


def are_whole(rows):
    """Whether each feature was tried with each relation: a quick trial makes no table."""
    tried = {(row["feature"], row["relation"]) for row in rows}
    return all((feature, relation) in tried for feature, _ in tried for relation in HEADS)


def page(text, rows):
    """docs/relations.md with this table."""
    return between(text, "combinations", table(rows))

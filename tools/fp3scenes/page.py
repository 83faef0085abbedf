"""docs/scene_errors.md: error against run time of whole scenes, with a picture for each; and of docs/skipping.md what they need not do."""

from fp3bench.figures import COLOURS, looks
from fp3gen.text import evidence, markdown
from fp3scenes import peers
from fp3scenes import problems
from plot import draw

HEAD = """\
This page sets the error of a scene against its cost. FP3's engine `fast` and other engines step the same equations, each on one thread of the same processor.
Shorter steps cost more and have a smaller error, so each method is a curve, with a mark for each length of step. Lower is more accurate, and farther left is
cheaper.

- *Error*: each section defines its error, and the size that the error is divided by. The truth is computed in double from the scene's equations
  ([truth.md](truth.md#scenes)) by code that shares nothing with FP3's compiler and engines.
- *Cost*: processor time of the whole run, for one object and one second of the scene: the shortest of up to {turns} runs, which all engines make one after another. Reading the scene
  and compiling are not in it.
- *Steps* become shorter from left to right along a curve. IAS15 chooses its steps, so its marks are tolerances. *Bursts* means that the run is unstable; it has no mark.
- *Tables*: a cell has the error, then the cost in µs. An error is bold if no row of the scene has a smaller error for the same time or less.

*FP3*, *Taichi*, *Warp*, *Box2D* and *Rapier* compute in float32, *REBOUND*, *LAMMPS* and *MuJoCo* in double. Taichi and Warp are languages for kernels and have no
integrators, so we wrote the kernels (`tools/fp3scenes/by_taichi.py`, `by_warp.py`) after their own examples. Taichi makes all steps within one kernel. REBOUND, LAMMPS
and MuJoCo get the scene, and step it by their own methods and in their own code.

The comparison is not fair in these points:

- The scenes are FP3's own, and small: 160 to 2,304 objects. Taichi and Warp are made for GPUs and for many more objects. Warp starts each kernel from Python, which costs some microseconds per step.
- In each scene Taichi and Warp have one method only. Other methods could be written in them, too. So compare rows of the same method: FP3's `rk4` beats them by its order.
- All engines have one thread here, and all could have several.
- The cost of FP3 includes making its first lists, which takes up to a millisecond. If there are few steps, this is two fifths of the cost (`balls` with 1/128 s). The cost of LAMMPS does not include its first lists.
- REBOUND, LAMMPS and MuJoCo compute with 16 digits, FP3 with 7. MuJoCo's springs are flexible bodies, which could also touch each other.
- If motion is chaotic (`heap`, and `dam` at the end), single objects have no truth. The error is then that of a quantity of the whole scene.

[benchmarks.md](benchmarks.md) has such curves for single objects, beside GSL, SUNDIALS and others."""

ABOUT = {
    "cloth": "A cloth of 20 x 20 masses with dampers hangs from two corners and falls for {seconds:g} s. Taichi and Warp find neighbours by their place in the grid; FP3 reads lists of links.",
    "net": "A net of 48 x 48 masses on springs without dampers, held along an edge, swings down for 1/16 s.",
    "balls": "300 balls fall for {seconds:g} s, and some of them meet. The damper of a contact acts from the first touch on, so forces jump, and no method has more than first order for long. The truth itself is good to 1e-5 here. "
             "LAMMPS moves balls by velocity Verlet, with the damping of the speeds at half a step.",
    "stars": "300 bodies attract each other and fall together for {seconds:g} units of time; where they are close, gravity is softened.",
    "heap": "1,000 balls fall into a box and come to rest within {seconds:g} s. Rounding alone decides which ball lies where, and changes the mean height by about a thousandth. So an error of "
            "a thousandth is no error, and steps below the longest stable step gain nothing.",
    "chain": "Ten rods of 0.5 m hang in a chain of hinges, are let go from the horizontal, and swing for {seconds:g} s: rigid bodies, which FP3 steps with its built-in solver. It is one of the runs of "
             "[bodies_error.md](bodies_error.md), which has more engines. A step is a substep of a frame of 1/60 s.",
    "dam": "A column of water, 800 particles (SPH), falls and runs along the floor for {seconds:g} unit of time. Where its front is then is known to 1e-6. Warp fills its grid of neighbours again for each evaluation.",
}
NAMES = {"fp3": "FP3", "taichi": "Taichi", "warp": "Warp", "mujoco": "MuJoCo", "rebound": "REBOUND", "lammps": "LAMMPS", "box2d": "Box2D", "rapier": "Rapier"}


SECTIONS = [*problems.PROBLEMS, problems.CHAIN]


def label(row):
    return f"{NAMES[row['engine']]}, {row['method']}"


def cost(row):
    """Microseconds of one object for a second of the scene."""
    return row["ns_per_object_step"] / row["h"] / 1e3


def picture(scene):
    return f"scene_errors_{scene}.svg"


def by_label(rows):
    found = {}
    for row in rows:
        found.setdefault(label(row), []).append(row)
    return found


def drawn(problem, rows):
    methods = {}
    for row in rows:
        methods.setdefault(COLOURS["fast" if row["engine"] == "fp3" else row["engine"]], {})[label(row)] = None
    styles = looks(methods.items())
    series = [{"name": name, "look": styles[name], "points": [(cost(row), row["error"]) for row in of if row["error"]]} for name, of in by_label(rows).items()]
    return draw([one for one in series if one["points"]], "µs for a second of one object", f"error, a share of {problem.size:g}")


def is_beaten(row, rows):
    return any(other["error"] is not None and other["error"] < row["error"] and cost(other) <= cost(row) for other in rows)


def step(row):
    return f"1/{round(1 / row['h'])} s"


def number(value):
    return "" if value is None else f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def cell(row, rows):
    if row is None:
        return ""
    if row["error"] is None:
        return "bursts"
    error = f"{row['error']:.2g}"
    return f"{error if is_beaten(row, rows) else f'**{error}**'}, {number(cost(row))}"


def table(rows):
    """A line for each method, a column for each length of step."""
    fixed = [row for row in rows if row["method"] not in peers.CHOSEN]
    steps = dict.fromkeys(step(row) for row in sorted(fixed, key=lambda row: -row["h"]))

    def lines():
        for name, of in by_label(fixed).items():
            at = {step(row): row for row in of}
            yield [name, *(cell(at.get(one), rows) for one in steps)]
    return ["step", *steps], lines()


def listed(words):
    words = list(dict.fromkeys(words))
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def ratios(rows):
    """Who needs how much more for the same steps."""
    own = {(row["method"], row["h"]): row for row in rows if row["engine"] == "fp3" and row["method"] in (peers.EULER, peers.LEAPFROG, peers.HEUN)}
    for engine in dict.fromkeys(row["engine"] for row in rows if row["engine"] != "fp3"):
        found = sorted(row["ns_per_object_step"] / own[row["method"], row["h"]]["ns_per_object_step"] for row in rows
                       if row["engine"] == engine and (row["method"], row["h"]) in own and row["error"] and own[row["method"], row["h"]]["error"])
        if found:
            least, most = (f"{ratio:.2g}" for ratio in (found[0], found[-1]))
            yield f"{NAMES[engine]} {least if least == most else f'{least} to {most}'}"


def said(rows):
    """Who beats FP3."""
    ours = [row for row in rows if row["engine"] == "fp3" and row["error"]]
    others = [row for row in rows if row["engine"] != "fp3" and row["error"]]
    front = [row for row in ours if not is_beaten(row, ours)]
    beaten = [label(other) for other in others for row in front if is_beaten(row, [other])]
    yield f"{listed(beaten)} beat{'s' * (len(set(beaten)) == 1)} FP3 somewhere: a smaller error for as much time or less." if beaten else "No one beats FP3's best rows, with a smaller error for as much time or less."
    least = min(row["error"] for row in ours)
    deeper = [label(other) for other in others if other["error"] < least]
    if deeper:
        yield f"A smaller error than FP3 ever reaches: {listed(deeper)}."


def section(problem, rows):
    yield from ("", f"## {problem.name[0].upper()}{problem.name[1:]}", "", ABOUT[problem.name].format(seconds=problem.seconds), "")
    yield f"The error is {problem.what}, as a share of the scene's size, {problem.size:g}."
    yield from ("", f"![{problem.name}: error against time]({picture(problem.name)})", "")
    yield from markdown(*table(rows))
    lines, slower = [], list(ratios(rows))
    if slower:
        lines.append(f"By the same method with the same steps, others take so many times the time of FP3: {', '.join(slower)}.")
    for name, of in by_label(row for row in rows if row["method"] in peers.CHOSEN).items():
        lines.append(f"{name}, which chooses its steps: {'; '.join(cell(row, rows) for row in of)}.")
    if not problem.is_chance:                                   # else whose error is smaller says nothing
        lines += said(rows)
    yield from ("", " ".join(lines))


def page(rows, about):
    from fp3scenes.curves import TURNS
    yield "<!-- Generated by tools/pages.py (make report PAGES=scenes): do not edit. -->"
    yield "# Scenes: error against time"
    yield from ("", "*Measured, for numerics.*", "", HEAD.format(turns=TURNS), "", *evidence("scenes.curves"), "")
    yield (f"`make scenes PARTS=curves` measures and writes `build/results/scenes.json`, `make report PAGES=scenes` makes this page of it: of {about['date']}, on {about['processors']} "
           f"processors, {about['processor']}.")
    for problem in SECTIONS:
        of = [row for row in rows if row["scene"] == problem.name]
        if of:
            yield from section(problem, of)


def pages(rows, about):
    rows = [row for row in rows if "failed" not in row]
    scenes = [problem for problem in SECTIONS if any(row["scene"] == problem.name for row in rows)]
    return {"scene_errors.md": page(rows, about)} | {picture(problem.name): drawn(problem, [row for row in rows if row["scene"] == problem.name]) for problem in scenes}


# ---- what scenes need not do ---------------------------------------------------------------------------

LESS = """\
What scenes of objects [that see each other](relations.md) need not do. In each group of rows the first one does all the work, and *share* is what of its time or of its
cycles is left. The columns: the scene; what is done; nanoseconds of one thread of the engine `fast` for a step of an object that moves, the shortest of {turns} turns, which all rows of a group make one after another;
cycles of the simulated hardware for the same in a small form of the scene (16 to 64 objects); and the result: the same bits as the first row, or the root mean square
of the distance from it in the end, as a share of the scene's size."""
NOTES = {
    "sleep": "1,000 balls lie in a heap. With a [line `rest`](relations.md#objects-at-rest) all of them fall asleep. Awake, the heap creeps on: nothing rubs.",
    "lists": "Only pairs that touch push each other. A [list](relations.md#lists-of-near-objects) has few others in it, the fewer the thinner its skin; but a list with a thin skin is made anew more often, which the hardware leaves to the host, "
             "so its cycles have no share of that.",
    "kinds": "Balls fall on 324 balls that never move. As a [kind](relations.md#kinds) whose words never change, these make no steps, and no lists of their own. Sums are added in another order, and contacts make more of that with time.",
    "outputs": "10,000 masses of a cloth, recorded as HDF5 in every 4th step, by the command, with its start. A scene's program is the same whatever is observed: only writing is saved.",
    "precision": "100 bodies attract each other. Engine `fast` has vectors for FP32 alone; so bfloat16 is slower there, and saves multipliers of the hardware, not cycles "
                 "([arithmetic.md](arithmetic.md)). Records of 16 bits, which only processors without neighbours have (`lorenz`: 2,000 points), save neither: as much block RAM holds twice as many objects.",
}


def result(row):
    return "" if row["is_first"] else "the same bits" if row["words_differing"] == 0 else f"{row['error']:.1e}"


def skipped(rows, _):
    """A section of docs/skipping.md."""
    from fp3scenes.skipped import TURNS
    lines = ["## Whole scenes", "", *evidence("scenes.skipped"), "", LESS.format(turns=TURNS)]
    for way, note in NOTES.items():
        of = [row for row in rows if row["way"] == way]
        if of:
            lines += ["", f"*{way[0].upper()}{way[1:]}.* {note}", ""]
            lines += markdown(["scene", "", "fast, ns", "share", "cycles", "share", "result"],
                              ([f"`{row['scene']}`" if row["is_first"] else "", row["what"], number(row["ns_per_object_step"]), f"{row['share']:.3g}",
                                number(row["cycles_per_object_step"]), number(row["share_of_cycles"]), result(row)] for row in of))
    return {"skipping.md": lines}

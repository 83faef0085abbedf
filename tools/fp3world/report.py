"""The page of scenes of objects that see each other, from what make world has found."""

from fp3gen.text import evidence, markdown

HEAD = """\
`programs/world` has scenes of objects that [see each other](relations.md). `make world` runs them and compares the results with theory, in half an
hour on two busy processors; `make report PAGES=world` makes this page from `build/results/world.json`. `QUICK=1` takes a minute. `PARTS="hashes physics"` runs only
these parts, and `SCENES="belt slope"` only these scenes; the other rows stay. The exit code is 1 if a word differs, a row does not hold or a peer fails."""

SCENES = """\
| scene | what it shows |
|---|---|
| `chain` | 32 masses between two that are held: normal modes |
| `membrane` | 21 x 21 masses on threads under tension: its tones |
| `cloth`, `net` | springs with dampers, 20 x 20, and without, 128 x 128: where energy goes |
| `rope` | a rope of 40 links comes to rest: a catenary |
| `bridge` | a girder of bars takes up its own weight |
| `planets`, `eight`, `plummer`, `stars` | gravity: the solar system, three bodies on a figure of eight, a cluster in equilibrium, a collapse |
| `pair`, `balls`, `heap`, `gas` | contact: two balls collide, 300 and 10,000 come to rest in a box, 300 fly about in one |
| `dam` | a column of water in particles falls and runs along the floor |
| `players`, `train` | several kinds: players run through balls; couplings between the cars of a train have states of their own |
| `cradle` | Newton's cradle, five balls that touch: which ones move out |
| `slope`, `belt`, `glancing`, `pyramid` | friction that remembers, on a floor of another kind: blocks that hold and slide, a belt, two balls that make each other turn, three in a heap |
| `breaking`, `plastic` | links that remember: a girder whose bars break, rods that yield |
| `clocks`, `neurons` | oscillators and a driver fall into step; neurons, and synapses that learn, fire in a ring |"""

HASHES = """\
All runs of a scene must give the same words in all states of all objects. The columns: the scene; its steps; the runs, by engine; the hash of all words;
how many words differ. The first run is by the engine `isa`, or by the interpreter of `fast` if a scene is too large for `isa`. The others are

- by the engine `fast`, interpreted, and as native code for each kind of processor that this one can be;
- with up to 4 threads, in larger forms of the scenes, because a thread takes 512 objects at a time;
- with lists of near objects that are made in each phase (skin 0), or that reach a little farther, or ten times as far as the model's distance;
- with objects in another order, each with its links in the old order (`chain`, `cloth`). `near` and `all` add up in the order of the objects' numbers, so
  another order is another scene there;
- on the simulated hardware, with fewer steps and fewer objects."""

SPEED = """\
`bench/world` has loops in C for three of the models: `net` (springs), `balls` (contact) and `stars` (all pairs). They give the bits of
FP3, and so show what a scene could cost. The programs take turns, and the shortest run of each counts: processor time with one thread, elapsed time
with several. An elapsed time means nothing if the load was above the number of processors.

- *Springs.* A vector of 16 objects goes through its lists together. Neighbours that lie side by side, as on a grid, are loaded as one vector; at an edge some
  objects do nothing.
- *Contact.* Objects are in the order of the cells of a grid, and each has a record of 32 bytes. The records of 16 neighbours are loaded whole and
  transposed. Sums keep the order of the objects' numbers.
- *Two kinds.* `heap of two kinds` is `heap` with its balls dealt in turn to two kinds that see each other by the same law. The loop by hand keeps all balls
  together, and each ball has two lists, one for each sum.
- *All pairs.* Two vectors of 16 objects meet all others, one at a time.
- *Estimates.* FP3 takes the estimate of a root from a table with 1,024 entries: 1/sqrt of an interval's end, cut to 9 or 10 bits. Computing it is cheaper
  than a gather: the processor's `vrsqrt14ps` and one step of Newton have an error below 22 units of 2^-23, on the side where no cut is near. When a loop is
  opened, it compares all entries with `sw/machine/estimate.c`.

The peers are measured if `make setup-bench` has installed them, in processor time on one thread. The columns: the peer; the scene; what it solves; its
arithmetic; what differs from FP3.

| peer | scene | what it solves | arithmetic | what differs |
|---|---|---|---|---|
| Taichi | `net` | the same equations and steps | float32 | a stencil in place of lists |
| Warp | `net` | the same equations and steps | float32 | a stencil in place of lists |
| Warp | `stars` | the same equations and steps | float32 | |
| MuJoCo | `net` | the same equations and steps: bodies that slide along three axes, springs as edges of flexes | double | it has the edges of a general flex, with their Jacobians |
| Bullet | `net` | the same equations and steps, in its deformable world | float32 | it has the general solver of that world |
| Bullet, another model | `net` | as many threads as `net` has springs; each step restores the length of each thread, in one pass | float32 | threads instead of springs, in random order |
| LAMMPS | `heap` | the same forces (`gran/hooke`, with balls that do not turn), from where FP3 has the balls | double | velocity Verlet; a ball at two walls is damped by both; damping along a contact is at most 10,000 times the force across |
| Box2D 3 | `heap, 2D` | another scene, in two dimensions: 10,000 circles at rest, 31 deep | float32 | contacts are constraints; a step is 1/60 s in 4 substeps, where `heap` has 1/1024 s; the package is built with its assertions |
| REBOUND | `stars` | the same equations and steps | double | |

The columns of the table at the end: the scene; who computes it; threads; objects; nanoseconds for a step of an object; this time relative to the loop by
hand; the error, which is how far a result is from what it should be. There is no error if a peer solves something else, if many steps take too long, or if
nothing is known to compare with.

- `net`: the largest difference of a coordinate, after 1,024 steps, from the same steps made in double precision, as a share of the
  length of the net. It is the error of rounding alone, not that of the step.
- `stars, 1024`: how much the energy has changed after 2,048 steps, as a share of it. Most of it comes from the step.
- `heap`: the largest difference of a coordinate from where FP3 has the balls, after 256 steps from the same start at rest, as a share
  of the width of the box. It has the errors of both, and the difference of their integrators.

The program with Bullet's nets is `bench/world/bullet.cpp`; that of Box2D is in `tools/fp3world/peers.py`. The others are those of
[scene_errors.md](scene_errors.md), `tools/fp3scenes/by_*.py`. A result that is too far off makes no row, and neither does a peer that fails:
`make world` names it and ends with exit code 1."""

CHIP = """\
Clock cycles of the simulated hardware for a step of an object, from the difference of a longer and a shorter run. Scenes are small, because objects and
their lists share the store of a lane. The columns: the scene; the configuration; lanes; objects; the cycles; the share of them in which lanes exchange what
others see."""

PHYSICS = """\
The columns: the scene; a quantity; its value by theory or experiment; its value in the run; the largest difference allowed, whose reason
is `why` in the JSON file. The functions in `tools/fp3world/` (`physics.py`, `bodies.py`, `contact.py`, `friction.py`, `memory.py`, `rhythm.py`,
`water.py`) name the sources. `tests/world` changes each scene a little, and sees that a row then no longer holds.

*LAMMPS* has the law of [grains.ode](../programs/world/grains.ode), `pair_style gran/hooke/history`, in double. `make granular` asks it, and
`tools/fp3world/lammps.json` keeps what it says with its version, so the rows need no LAMMPS. Its forces read the speeds at half a step, and so its velocity
Verlet makes the steps of `semi_implicit_euler`. FP3 makes them with 24 bits and compensated sums.

Six heaps of 608 balls, which fall on a row of 41 balls that are held, are compared by their angle, from the same starts. The angle is that of a line from the
plate's end, fitted by least squares to the highest ball in each of 30 strips. Places of single balls cannot be compared, because each contact multiplies
differences. The standard deviation of the six angles is 0.42 degrees in LAMMPS and 0.31 degrees here."""


def number(value):
    return f"{value:.6g}" if value else "0"


def hashes(rows):
    """A line for each scene and number of steps."""
    found = {}
    for row in rows:
        found.setdefault((row["scene"], row["steps"]), []).append(row)
    for (scene, steps), same in found.items():
        by = {}
        for row in same:
            by[row["engine"]] = by.get(row["engine"], 0) + 1
        yield [scene, f"{steps:,}", ", ".join(f"{n} x `{engine}`" if n > 1 else f"`{engine}`" for engine, n in by.items()), f"`{same[0]['hash']}`",
               max(row["words_differing"] for row in same)]


def who(row):
    """The kind of processor of a loop by hand is that of the page."""
    if row["engine"] in ("hand", "fast"):
        return "by hand" if row["engine"] == "hand" else "fast"
    return row["engine"] + (f" ({row['variant']})" if row["variant"] else "")


def speed(rows):
    for row in rows:
        ratio = f"{row['ratio_to_hand']:.2f}" if "ratio_to_hand" in row else ""
        error = "" if row.get("error") is None else f"{row['error']:.2g}"
        yield [row["scene"], who(row), row["threads"], f"{row['objects']:,}", f"{row['ns_per_object_step']:.4g}", ratio, error]


def later(parts):
    """Which scenes were measured apart from their part."""
    for part, one in parts.items():
        for other in one.get("later", []):
            yield f"{part} of {', '.join(f'`{name}`' for name in other['scenes'])} {other['date']}, revision `{other['revision']}`, load {other['load']:.1f}"


def page(data):
    about = data["about"]
    yield "<!-- Generated by tools/pages.py (make report PAGES=world): do not edit. -->"
    yield "# Scenes of objects that see each other"
    yield from ("", "*Measured, for numerics.*")
    yield from ("", HEAD, "", SCENES, "")
    apart = "; ".join(later(data["measured"]))
    yield f"Measured on {about['processors']} processors: {about['processor']}; {about['compiler']}." + (f" Later than their parts: {apart}." if apart else "")
    for title, text, part, head, rows in (
            ("Physics", PHYSICS, "physics", ["scene", "what", "expected", "found", "within"],
             lambda rows: ([row["scene"], row["what"], number(row["expected"]), number(row["found"]), f"{row['within']:.2g}" + ("" if row["holds"] else ": does not hold")] for row in rows)),
            ("One hash a scene", HASHES, "hashes", ["scene", "steps", "runs", "hash", "words that differ"], hashes),
            ("Beside loops written by hand", SPEED, "speed", ["scene", "by", "threads", "objects", "ns for a step of an object", "of the loop by hand", "error"], speed),
            ("On the hardware", CHIP, "chip", ["scene", "configuration", "lanes", "objects", "cycles for a step of an object", "exchange"],
             lambda rows: ([row["scene"], f"`{row['config']}`", row["lanes"], row["objects"], f"{row['cycles_per_object_step']:.1f}", f"{100 * row['exchange_share']:.1f} %"] for row in rows))):
        if part in data:
            yield from ("", f"## {title}", "", *evidence(f"world.{part}"), "", text, "")
            yield from markdown(head, rows(data[part]))

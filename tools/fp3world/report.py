"""The page of scenes of objects that see each other, from what make world has found."""

from fp3gen.text import evidence, markdown

HEAD = """\
`programs/world` has scenes of objects that [see each other](relations.md). `make world` runs them and compares the results with theory. It takes half an hour
on two busy processors, and a minute with `QUICK=1`. `PARTS="hashes physics"` runs only these parts, and `SCENES="belt slope"` only these scenes; all other
rows stay. The exit code is 1 if a word differs, a row does not hold or a peer fails. `make report PAGES=world` makes this page from
`build/results/world.json`."""

SCENES = """\
| scene | what it shows |
|---|---|
| `chain` | 32 masses between two that are held: normal modes |
| `membrane` | 21 x 21 masses on threads under tension: its tones |
| `cloth` | 20 x 20 masses with springs and dampers: where energy goes |
| `net` | 128 x 128 masses with springs and no dampers: energy stays |
| `rope` | a rope of 40 links comes to rest: a catenary |
| `bridge` | a girder of bars takes up its own weight |
| `planets` | gravity: the solar system |
| `eight` | gravity: three bodies on a figure of eight |
| `plummer` | gravity: a cluster in equilibrium |
| `stars` | gravity: a collapse |
| `pair` | contact: two balls collide |
| `balls`, `heap` | contact: 300 and 10,000 balls come to rest in a box |
| `gas` | contact: 300 balls fly about in a box |
| `dam` | a column of water in particles falls and runs along the floor |
| `players` | two kinds: players run through balls |
| `train` | two kinds: couplings between the cars of a train have states of their own |
| `cradle` | Newton's cradle, five balls that touch: which balls move out |
| `slope` | friction that remembers, on a floor of another kind: blocks that hold and slide |
| `belt` | the same on a moving belt |
| `glancing` | friction between two balls, which make each other turn |
| `pyramid` | friction between three balls in a heap |
| `breaking` | links that remember: a girder whose bars break |
| `plastic` | links that remember: rods that yield |
| `clocks` | oscillators and a driver fall into step |
| `neurons` | neurons fire in a ring, with synapses that learn |"""

HASHES = """\
All runs of a scene must give the same words in all states of all objects. *Runs* has the number of runs by each engine, and *hash* the hash of all words. The
first run is by the engine `isa`, or by the interpreter of `fast` if a scene is too large for `isa`. The other runs are

- by the engine `fast`, interpreted, and as native code for each kind of processor whose code runs on this machine;
- with up to 4 threads, in larger forms of the scenes, because a thread takes 512 objects at a time;
- with lists of near objects that are made in each phase (skin 0), that reach a little farther, or that reach ten times as far as the model's distance;
- with objects in another order, each with its links in the old order (`chain`, `cloth`). Scenes with `near` and `all` have no such run: their sums follow the
  order of the objects' numbers, so another order is another scene;
- on the simulated hardware, with fewer steps and fewer objects."""

SPEED = """\
`bench/world` has loops in C, written by hand, for three of the models: `net` (springs), `balls` (contact) and `stars` (all pairs). They give the same bits as
FP3, so they show how fast a scene could be. The programs take turns, and the shortest run of each counts: processor time with one thread, elapsed time with
several. An elapsed time means nothing if the load was above the number of processors.

- *Springs.* A vector of 16 objects goes through its lists together. Neighbours that are side by side in memory, as on a grid, are loaded as one vector. At an
  edge some objects do nothing.
- *Contact.* Objects are in the order of the cells of a grid, and each has a record of 32 bytes. The records of 16 neighbours are loaded whole and
  transposed. Sums keep the order of the objects' numbers.
- *Two kinds.* `heap of two kinds` is `heap` with every second ball of another kind; both kinds have the same law. The loop by hand keeps all balls together,
  and each ball has two lists, one for each sum.
- *All pairs.* Two vectors of 16 objects meet all others, one at a time.
- *Estimates.* FP3 takes the estimate of a root from a table with 1,024 entries: 1/sqrt of an interval's end, truncated to 9 or 10 bits. The loops compute this
  value, because that is cheaper than a gather. The processor's `vrsqrt14ps` and one Newton step have an error below 22 units of 2^-23, on the side where it
  cannot change the truncated bits. When a loop is opened, it compares all entries with `sw/machine/estimate.c`.

The peers are measured if `make setup-bench` has installed them, in processor time on one thread.

| peer | scene | what it solves | arithmetic | what differs |
|---|---|---|---|---|
| Taichi | `net` | the same equations and steps | float32 | a stencil in place of lists |
| Warp | `net` | the same equations and steps | float32 | a stencil in place of lists |
| Warp | `stars` | the same equations and steps | float32 | |
| MuJoCo | `net` | the same equations and steps: bodies that slide along three axes, springs as edges of flexes | double | edges of a general flex, with their Jacobians |
| Bullet | `net` | the same equations and steps, in its deformable world | float32 | the general solver of that world |
| Bullet, another model | `net` | as many threads as `net` has springs; each step restores the length of each thread, in one pass | float32 | threads instead of springs, in random order |
| LAMMPS | `heap` | the same forces (`gran/hooke`, with balls that do not turn), from where FP3 has the balls | double | velocity Verlet; a ball at two walls is damped by both; damping along a contact is at most 10,000 times the force across |
| Box2D 3 | `heap, 2D` | another scene, in two dimensions: 10,000 circles at rest, 31 deep | float32 | contacts are constraints; a step is 1/60 s in 4 substeps, where `heap` has 1/1024 s; the package is built with its assertions |
| REBOUND | `stars` | the same equations and steps | double | |

In the table at the end, *of the loop by hand* is the time relative to the loop by hand. *Error* is defined for three scenes. It is empty if a peer solves
something else, if many steps take too long, or if there is nothing to compare with.

- `net`: the largest difference of a coordinate, after 1,024 steps, from the same steps made in double precision, as a share of the length of the net. It is
  the error of rounding alone, without the error of the step.
- `stars, 1024`: the change of the energy after 2,048 steps, as a share of the energy. Most of it comes from the step.
- `heap`: the largest difference of a coordinate from the result of FP3, after 256 steps from the same start at rest, as a share of the width of the box. It
  contains the errors of both, and the difference of their integrators.

The program with Bullet's nets is `bench/world/bullet.cpp`, and the program with Box2D is in `tools/fp3world/peers.py`. The other programs,
`tools/fp3scenes/by_*.py`, are also used by [scene_errors.md](scene_errors.md). If a peer fails, or its result is too far off, the table has no row for it;
`make world` names the peer and ends with exit code 1."""

CHIP = """\
The table has clock cycles of the simulated hardware for a step of an object, from the difference of a longer and a shorter run. Scenes are small, because
objects and their lists share the store of a lane. *Exchange* is the share of the cycles in which lanes exchange published words."""

PHYSICS = """\
*Expected* is the value by theory or experiment, and *found* the value in the run. *Within* is the largest difference allowed; `why` in the JSON file gives
the reason. The functions in `tools/fp3world/` (`physics.py`, `bodies.py`, `contact.py`, `friction.py`, `memory.py`, `rhythm.py`, `water.py`) name the sources
of the expected values. Tests change each scene a little, and check that a row then no longer holds.

*LAMMPS* has the law of [grains.ode](../programs/world/grains.ode), `pair_style gran/hooke/history`, in double. `make granular` runs LAMMPS, and stores its
results and its version in `tools/fp3world/lammps.json`, so the rows need no LAMMPS. Its forces read the speeds at half a step, so its velocity Verlet makes
the same steps as `semi_implicit_euler`. FP3 makes these steps with 24 bits and compensated sums.

In the last row, `pile`, 608 balls fall on a plate of 41 fixed balls and form a heap. FP3 and LAMMPS compute six heaps from the same starts, and the mean
angles of repose are compared. The angle of a heap is that of a line from the plate's end, fitted by least squares to the highest ball in each of 30 strips.
Positions of single balls cannot be compared, because each contact multiplies differences. The standard deviation of the six angles is 0.42 degrees in LAMMPS
and 0.31 degrees here."""


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

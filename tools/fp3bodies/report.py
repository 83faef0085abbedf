"""The page of rigid bodies beside theory and other engines, from what make bodies has found."""

from fp3bench.figures import COLOURS, DASHES, MARKS
from fp3gen.text import evidence, markdown
from plot import draw

HEAD = """\
`make bodies` gives the same scenes to every engine of rigid bodies that is there, and compares what they do with theory and with each other;
`make report PAGES=bodies` makes this page from `build/results/bodies.json`. It takes an hour, of which truths, standing and speed take some minutes each: peers other than Box2D have 4 s for a
scene to settle and 6 s to stand, and who has no answer 15 s later is left out as slower. `QUICK=1` takes seconds, `PARTS="truths"` makes this part
alone, and `ENGINES="box2d rapier"` makes the rows of these alone; the others stay. `tools/fp3bodies/scene.py` has the scenes, `truths.py` beside it what is
measured, `formulas.py` what theory says."""

TRUTHS = """\
Each engine steps 60 times a second with 4 substeps. Chipmunk, MuJoCo and Bullet have no substeps, so they take 240 steps a second. Nothing sleeps, and
thresholds of restitution are 0. Gravity is 10 m/s^2. The columns: a quantity; what theory says; the largest difference allowed; what each engine
does, in bold if it is farther off. Where an engine lacks something, the last table says what. The sources are in the docstrings of `truths.py`.

Most scenes are in the plane. Rapier, MuJoCo and Bullet have space alone: boxes are 1 m deep there, and a disc is a ball with a disc's moment of inertia.
Nothing holds Rapier's and Bullet's bodies in the plane but symmetry.

One row of FP3 does not hold: the heavy top's tilt leaves 60 degrees by 0.014 rad. Its pin is found once a substep, and the error goes with the substep:
8 of them make it 0.0048, 16 make it 0.0019, which would hold."""

STANDING = """\
The columns: the scene; the engine; seconds; how far a body drifts sideways; how far one sinks; the deepest overlap of two boxes; kinetic energy per
body; what the floor carries, as a share of the weight: the weight and the change of momentum within the last second."""

SPEED = """\
One thread. A scene settles for 600 steps of 1/60 s, or for 20 s of processor time if that is less; engines other than FP3 and Box2D have 4 s. Then all make turns one after another, 5
each, and the shortest turn counts, in time that the processor gave. Nothing sleeps. FP3, Box2D and Rapier have 4 substeps within a step; the others make
one step of 1/60 s, as their users do, and stand worse than above. The columns: the scene; the engine; loose bodies; steps that it settled;
nanoseconds for a step of a body; how many times that of Box2D, which is the user's own one if there is one.

What was aimed at and is not reached:

- *Pyramids of cubes*: 3 times the speed of Rapier and Box3D; the table has 2.5 to 2.9. Passes over contacts, which are wide already, take the largest part of such a step,
  nearly a third.
- *`pyramid 100`*: 350 ns. The time of worlds that fill the caches goes with the machine: an earlier run on it, at revision `bde25bd8`, had 310 beside Box2D's 477.
- *`mixed 2000`*: 230 ns. No part of its step takes more than a tenth of it: who has moved, which boxes meet, where shapes touch, rows and passes each take some per cent.
- *Two threads*: 1.7 times the speed of one. The wall and the larger pyramid in space reach it. In a plane a step of `pyramid 40` takes a quarter of a millisecond, and the two wait for each other
  after each colour of each pass; `pyramid 100`, whose step is eight times as long, gains more."""

ERROR = """\
How far an engine is from theory when it may take shorter substeps, and what a step of 1/60 s costs then. *Double pendulum*: two rods of 1 m let go from the
horizontal, 3 s. *Bounces*: a ball that falls 5 m on a floor of restitution 0.8, 4 s. *Sliding block*: at 5 m/s with friction 0.5 until it lies still, 1.5 s.
*Chain*: ten rods of 0.5 m let go from the horizontal, 2 s. The error is the root mean square of the distance of a point from where theory has it, over all
steps: of the tip of the last rod, else of the centre. Theory is a formula, or Lagrange's equations in double. Each run is there sixteen times in one world. Time is
nanoseconds of processor time for a step of 1/60 s of one body, over the whole run: the shortest of up to 5 turns, which all engines make one after another.

An engine without substeps of its own takes as many steps instead. MuJoCo is here by its integrators Euler, implicit and RK4; implicitfast, with which
other pages have it, is Euler where nothing damps. It works in double and in coordinates of joints, so its rods cannot come apart. In a table, a cell is the error in m, then the time in ns. An
error is bold if there is no smaller one in the table for as much time or less. FP3 is *beaten* by who has a smaller error for as much time or less.

FP3 has first order: with substeps half as long its error is about half. MuJoCo's RK4 has fourth order where nothing touches, so who needs joints to five digits is better off there. Bounces are
the exception: FP3 finds the time of each impact, so one substep is enough, and more of them add roundings, as speeds are float32."""

ENGINES = """\
*box2d* is `pyb2d3` from PyPI: its Box2D has vectors of 4 numbers (SSE2). Newer Box2D with AVX2 is faster, but no registry has it: who has
built one from its repository (newer than 3.1, `BUILD_SHARED_LIBS=ON`, `BOX2D_AVX2=ON`) says `make bodies BOX2D=DIR`, where `include/` and `lib/libbox2d.so`
are in DIR; that is *own box2d*. *own box3d* is Box3D, which no registry has either, built in the same way (`BOX3D_VALIDATE=OFF`) and named by `BOX3D=DIR`; it has vectors
of 4 numbers (SSE2). Chipmunk is `pymunk`, Rapier `rapier3d`, Bullet `pybullet`; `make setup-bench` installs them. In `pybullet` each
body is a multibody, as robots have them; Bullet's rigid bodies, which games have, may be better at impacts, and are not measured."""


HASHES = """\
Each scene is stepped in several ways, and `fp3_bodies_hash` tells of each where bodies are, how they move, who sleeps, and the impulses of contacts.
{differ} of {runs} runs differ. *built in* are the laws as C, on each kind of processor (`FP3_FAST`), with a call for each body, shape, joint and step (*calls*),
with a return to a saved state (*restored*), with other bodies that bounce and roll far away until half of the steps are made (*far*), and on several
[ranks](cluster.md#rigid-bodies); `isa`, `fast` and `rtl` execute the laws as programs, the hardware on two configurations. *file, last 2*: built-in
laws make all steps but the last 2, and a restart from a [checkpoint](checkpoints.md#rigid-bodies) makes the rest. The hardware makes few steps: one takes it seconds. *arm64* and
*riscv64* are machines under qemu-user, for which the library was compiled, *wasm* is [WebAssembly](playground.md) under wasmtime. Here bodies sleep. The scenes in a plane: boxes that stand; figures with limits in
their hinges on stairs; a car with springs, a motor and a rope on hills and a bridge, with every type of joint; shapes that bounce into a heap; dominoes; a heavy body on light links. In space: cubes that stand; two bodies in each
type of joint; a box that flips, a gyroscope and a top that falls over; balls in a box."""


LOOKS = {"fp3": "fast", "box2d": "box2d", "mujoco": "mujoco", "rapier": "rapier"}  # engines with a colour, and whose it is; the others are grey


CHIP = """\
The simulated hardware executes the laws of a first step: each colour of contacts or joints is a run of at most 64, and the host brings the words of rows and bodies before it and
takes them back behind it. A run always has 64 objects, empty lanes among them. *foreseen* is what the program, its loads and stores, and `isa/timing.toml` say of a run; {off} of {rows} rows
were measured otherwise. *38 lanes* is that of the same configuration with so many: two objects in a lane are too few to hide the latency, so a run of 64 takes as long as with 8 lanes; 38
lanes have contexts for 912 objects. Each hash was that of built-in laws. *bus* is what the words take between runs, measured from first handshake to response, and the host's own time is not in it. If a colour's passes followed
each other on the chip, so that each law found in its neighbours what the one before left, these are the cycles that would go, but for one transport there and back in a step; it takes a
store into words of neighbours, which the hardware does not have."""


def cycles(rows):
    for row in rows:
        yield [row["scene"], f"`{row['config']}`", f"`{row['law']}`", row["runs"], f"{row['lanes'] / row['runs']:.0f}", f"{row['cycles']:,}", f"{row['cycles'] / row['runs']:,.0f}",
               f"{row['foreseen']:,}", f"{row['foreseen_38']:,}", f"{row['bus_words'] / row['runs']:,.0f}", f"{row['bus_cycles'] / row['runs']:,.0f}"]


def number(value):
    return "none" if value is None else f"{value:.6g}"


def order(rows, key):
    return list(dict.fromkeys(row[key] for row in rows))


def peers_of(rows):
    """FP3 first, whoever was measured last."""
    return sorted(order(rows, "peer"), key=lambda peer: peer != "fp3")


def truths(rows):
    """A line for each quantity, a column for each engine."""
    peers = peers_of(rows)
    found = {(row["what"], row["peer"]): row for row in rows}

    def cell(row):
        return "" if row is None else number(row["found"]) if row["holds"] else f"**{number(row['found'])}**"

    def lines():
        for what in order(rows, "what"):
            of = [row for row in rows if row["what"] == what]
            yield [what, number(of[0]["expected"]), f"{of[0]['within']:.2g}", *(cell(found.get((what, peer))) for peer in peers)]
    return ["what", "theory", "within", *peers], lines()


def score(rows):
    for peer in peers_of(rows):
        of = [row for row in rows if row["peer"] == peer]
        yield [peer, sum(row["holds"] for row in of), len(of)]


def standing(rows):
    for row in rows:
        overlap = "" if row["overlap"] is None else f"{row['overlap']:.2g}"
        yield [row["scene"], row["engine"], row["seconds"], f"{row['drift']:.2g}", f"{row['sag']:.2g}", overlap, f"{row['energy_per_body']:.1e}", f"{row['floor_force']:.6f}"]


def speed(rows):
    for row in rows:
        ratio = f"{row['ratio_to_box2d']:.2f}" if "ratio_to_box2d" in row else ""
        yield [row["scene"], row["engine"], f"{row['bodies']:,}", row["settled"], f"{row['ns_per_body_step']:,.0f}", ratio]


def runs(rows):
    """A line for each hash of a scene after so many steps: one, if all is well."""
    made = [row for row in rows if "hash" in row]
    for scene, steps, found in dict.fromkeys((row["scene"], row["steps"], row["hash"]) for row in made):
        of = [row for row in made if (row["scene"], row["steps"], row["hash"]) == (scene, steps, found)]
        who = "; ".join(f"{engine}: " + ", ".join(row["variant"] for row in of if row["engine"] == engine) for engine in order(of, "engine"))
        yield [scene, steps, f"`{found}`", len(of), who]


def not_run(rows):
    """A sentence on the variants that scenes have not, with the reasons."""
    by = {}
    for row in rows:
        if "why" in row:
            by.setdefault((row["why"], row["variant"]), []).append(row["scene"])
    if by:
        why = {reason: [f"*{variant}*" for other, variant in by if other == reason] for reason, _ in by}
        scenes = {reason: list(dict.fromkeys(scene for (other, _), many in by.items() if other == reason for scene in many)) for reason in why}
        yield from ("", "Not run: " + "; ".join(f"{', '.join(why[reason])} of {', '.join(scenes[reason])} ({reason})" for reason in why) + ".")


def beats(rows):
    """Those that no other beats in error for as much time or less."""
    return [row for row in rows if row["error"] is not None and not any(
        other["error"] is not None and other["error"] < row["error"] and other["ns_per_body_step"] <= row["ns_per_body_step"] for other in rows)]


def error(rows):
    """A line for each engine of one run, a column for each number of substeps."""
    many, best = sorted(set(order(rows, "substeps"))), beats(rows)
    found = {(row["engine"], row["substeps"]): row for row in rows}

    def cell(row):
        if row is None:
            return ""
        off = "none" if row["error"] is None else f"{row['error']:.2g}"
        return (f"**{off}**" if row in best else off) + f", {row['ns_per_body_step']:,.0f}"
    return ["substeps", *map(str, many)], ([engine, *(cell(found.get((engine, one))) for one in many)] for engine in order(rows, "engine"))


def listed(names):
    *most, last = dict.fromkeys(names)
    return f"{', '.join(most)} and {last}" if most else last


def worse(rows):
    """Where fp3 is beaten: by whom, at how many substeps; and who is better however long it takes."""
    rows, by = [row for row in rows if row["error"] is not None], {}
    own, others = [row for row in rows if row["engine"] == "fp3"], [row for row in rows if row["engine"] != "fp3"]
    for row in own:
        for other in others:
            if other["error"] < row["error"] and other["ns_per_body_step"] <= row["ns_per_body_step"]:
                by.setdefault(other["engine"], []).append(str(row["substeps"]))
    for engine, many in by.items():
        yield f"With {listed(many)} substep{'s' if many != ['1'] else ''} FP3 is beaten by *{engine}*."
    better = [f"*{other['engine']}*" for other in others if own and other["error"] < min(row["error"] for row in own)]
    if better:
        yield f"A smaller error than FP3 ever reaches {'has' if len(set(better)) == 1 else 'have'} {listed(better)}."


def picture(scene):
    return f"bodies_error_{scene.replace(' ', '_')}.svg"


def beside(data):
    """Files beside the page, each with its text: the page of errors, and for each run the curves of all engines."""
    if "error" not in data:
        return {}
    return {"bodies_error.md": "\n".join(of_error(data)).rstrip("\n") + "\n"} | pictures(data["error"])


def pictures(rows):
    def look(engine):
        family = next((one for one in LOOKS if one in engine), None)
        member = [one for one in sorted(set(order(rows, "engine"))) if family and family in one or not family and not any(other in one for other in LOOKS)]
        return COLOURS[LOOKS[family]] if family else "#888888", DASHES[member.index(engine) % len(DASHES)], MARKS[member.index(engine)]

    def series(scene):
        for engine in order(rows, "engine"):
            points = [(row["ns_per_body_step"], row["error"]) for row in rows
                      if (row["scene"], row["engine"]) == (scene, engine) and row["error"] and row["error"] < 10]
            if points:
                yield {"name": engine, "look": look(engine), "points": points}
    return {picture(scene): draw(list(series(scene)), "ns for a step of 1/60 s of a body", "error, m") for scene in order(rows, "scene")}


def of_error(data):
    """Its page."""
    yield "<!-- Generated by tools/pages.py (make report PAGES=bodies): do not edit. -->"
    yield "# Rigid bodies: error against time"
    yield from ("", "*Measured, for games.*")
    yield from ("", ERROR, "")
    yield "[bodies_results.md](bodies_results.md) says which engines these are, and has truths, standing and speed."
    yield from ("", *evidence("bodies.error"))
    for scene in order(data["error"], "scene"):
        rows = [row for row in data["error"] if row["scene"] == scene]
        yield from ("", f"## {scene[0].upper()}{scene[1:]}", "", f"![{scene}: error against time]({picture(scene)})", "")
        yield from markdown(*error(rows))
        beaten = list(worse(rows))
        if beaten:
            yield from ("", " ".join(beaten))
    yield from left(data["error_refused"])


def left(rows):
    if rows:
        yield from ("", "Left out: " + "; ".join(f"{row['engine']} of {row['scene']} ({row['why']})" for row in rows) + ".")


def page(data):
    about = data["about"]
    yield "<!-- Generated by tools/pages.py (make report PAGES=bodies): do not edit. -->"
    yield "# Rigid bodies beside theory and other engines"
    yield from ("", "*Measured, for games.*")
    yield from ("", HEAD, "")
    yield f"Measured on {about['processors']} processors: {about['processor']}. {ENGINES}"
    if "truths" in data:
        yield from ("", "## Truths", "", *evidence("bodies.truths"), "", TRUTHS, "")
        yield from markdown(*truths(data["truths"]))
        yield from ("", "How many rows hold:", "")
        yield from markdown(["engine", "hold", "of"], score(data["truths"]))
        yield from ("", "What an engine lacks:", "")
        yield from markdown(["engine", "truth", "what it lacks"], ([row["peer"], f"`{row['test']}`", row["why"]] for row in data["truths_refused"]))
    if "standing" in data:
        yield from ("", "## Standing", "", *evidence("bodies.standing"), "", STANDING, "")
        yield from markdown(["scene", "engine", "s", "drift, m", "sag, m", "overlap, m", "energy, J", "floor"], standing(data["standing"]))
        yield from left(data["standing_refused"])
    if "chip" in data:
        from fp3bodies import chip
        yield from ("", "## Cycles of the hardware", "", *evidence("bodies.chip"), "", CHIP.format(rows=len(data["chip"]), off=len(chip.wrong(data["chip"]))), "")
        yield from markdown(["scene", "configuration", "law", "runs", "lanes in a run", "cycles", "of a run", "foreseen", "38 lanes", "words on the bus", "bus cycles"], cycles(data["chip"]))
    if "hashes" in data:
        from fp3bodies import hashes
        yield from ("", "## One hash a scene", "", *evidence("bodies.hashes"), "", HASHES.format(runs=sum("hash" in row for row in data["hashes"]), differ=len(hashes.differing(data["hashes"]))), "")
        yield from markdown(["scene", "steps", "hash", "runs", "which"], runs(data["hashes"]))
        yield from not_run(data["hashes"])
    if "speed" in data:
        yield from ("", "## Speed", "", *evidence("bodies.speed"), "", SPEED, "")
        yield from markdown(["scene", "engine", "bodies", "settled", "ns", "of Box2D"], speed(data["speed"]))
        yield from left(data["speed_refused"])
        notes = {row["engine"]: row["note"] for row in data["speed"] if row["note"]}
        if notes:
            yield from ("", "; ".join(f"*{engine}*: {note}" for engine, note in notes.items()) + ".")

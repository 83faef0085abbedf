"""What fp3 tune chooses for scenes whose objects see each other, and whether the choice keeps its tolerance in scenes that it has not seen: with other seeds,
or with starts that differ a little.
"""

import json
import subprocess

from fp3gen.text import evidence, markdown
from fp3world import scene as ws

# Steps of each scene for which there is a solution within 1e-5, and that take some seconds.
STEPS = {"chain": 2560, "clocks": 1024, "cloth": 64, "eight": 1024, "membrane": 512, "neurons": 2048, "planets": 1024, "plastic": 3072, "players": 256, "plummer": 32,
         "rope": 1024, "stars": 64, "train": 1024}
SCENES = sorted(STEPS)
TOLERANCES = (1e-1, 1e-2, 1e-3)
QUICK = {"scenes": ("chain", "planets"), "steps": 32, "tolerances": (1e-1, 1e-2), "held_out": 2}
HELD_OUT = 4
KEPT = 0.95                         # of the choices
WORK = 4e9                          # numbers of a solution


def tuned(options, scene, steps, tolerance, held_out):
    """The row of a choice; where nothing meets the tolerance it has none, and so has nothing to keep."""
    path = ws.put(options.folder, ws.replace(ws.text_of(scene), r"steps = \d+", f"steps = {steps}"), scene)
    found = options.folder / "tuned.json"
    found.unlink(missing_ok=True)
    done = subprocess.run([str(options.fp3), "tune", str(path), "--tolerance", repr(tolerance), "--held-out", str(held_out), "--work", repr(WORK), "--json", str(found)],
                          capture_output=True, text=True, check=False)
    if not found.exists():
        if done.returncode != 3:
            raise ws.Failed(f"{scene}: {done.stderr.strip()}")
        return {"scene": scene, "tolerance": tolerance, "met": None, "steps": steps, "why": done.stderr.strip().splitlines()[-1].replace(f"{path}", scene)}
    said = json.loads(found.read_text(encoding="utf-8"))
    choice, own = said["choice"], said["own"]
    row = {"scene": scene, "tolerance": tolerance, "met": said["met"] if choice else None, "steps": steps, "known_until_step": said["known_until_step"],
           "held_out": said["held_out"], "differ": said["differ"], "own_error": own["error"]}
    if choice:
        row |= {key: choice[key] for key in ("integrator", "arithmetic", "h", "error", "cycles")}
        row |= {"error_held_out": said["error_held_out"], "cycles_ratio": choice["cycles"] / own["cycles"], "ns_ratio": choice["ns"] / own["ns"] if choice["ns"] else None}
    return row


def measure(options, say):
    names = [name for name in (QUICK["scenes"] if options.quick else SCENES) if not options.scenes or name in options.scenes]
    rows = []
    for name in names:
        for tolerance in QUICK["tolerances"] if options.quick else TOLERANCES:
            rows.append(tuned(options, name, QUICK["steps"] if options.quick else STEPS[name], tolerance, QUICK["held_out"] if options.quick else HELD_OUT))
        say(f"{name} is tuned")
    return rows


# ---- what is wrong -----------------------------------------------------------------------------------

def chosen(rows):
    return [row for row in rows if row["met"] is not None]


def wrong(rows):
    """Too few choices that hold; a tighter tolerance that costs less."""
    kept = [row["met"] for row in chosen(rows)]
    if kept and sum(kept) < KEPT * len(kept):
        yield f"tuned: {sum(kept)} of {len(kept)} choices keep their tolerance in scenes that they have not seen, expected {KEPT:.0%}"
    for scene in sorted({row["scene"] for row in rows}):
        costs = [row["cycles"] for row in sorted(chosen(rows), key=lambda row: -row["tolerance"]) if row["scene"] == scene]
        if costs != sorted(costs):
            yield f"tuned: {scene}: a looser tolerance costs more: {costs}"


# ---- the page ----------------------------------------------------------------------------------------

def result(row):
    if row["met"] is None:
        return [f"`{row['scene']}`", f"{row['tolerance']:g}", "nothing", "", "", "", "", ""]
    known = "" if row["known_until_step"] == row["steps"] else f" (of {row['steps']})"
    return [f"`{row['scene']}`", f"{row['tolerance']:g}", f"{row['integrator']}, {row['arithmetic'].replace('_', '-')}", f"{row['h']:.3g}", f"{row['known_until_step']}{known}",
            f"{row['error']:.1e}", f"{row['error_held_out']:.1e}" + ("" if row["met"] else ": too large"), f"{row['cycles_ratio']:.3g}"]


def pages(rows, _):
    kept = [row["met"] for row in chosen(rows)]
    lines = ["## Scenes whose objects see each other", "", *evidence("scenes.tuned"), "",
             f"{sum(kept)} of {len(kept)} choices keep their tolerance in {HELD_OUT} scenes that they have not seen; for {len(rows) - len(kept)} of {len(rows)} rows nothing meets it, or {WORK:g} numbers give no solution. "
             "The columns: the [scene](../programs/world); the tolerance; the choice and its `h`; the steps of the scene over which errors are known; the error in the scenes that the choice has seen,",
             "and in those that it has not; its cycles, as a share of those of the scene as it is. [The tuner](tuner.md#scenes-whose-objects-see-each-other) says how it chooses, "
             "and `make scenes PARTS=tuned` measures this again.", "",
             *markdown(["scene", "tolerance", "choice", "h", "steps", "error", "held out", "cycles"], [result(row) for row in rows]), ""]
    return {"tuning.md": lines}

#!/usr/bin/env python3
"""Rigid bodies beside theory and beside other engines: what holds, what stands, how fast.

    tools/bodies.py                                     all of it, by everyone who is installed: an hour; truths, standing, speed take 5 minutes each
    tools/bodies.py --quick                             the same in seconds, for the tests
    tools/bodies.py --parts truths --engines box2d rapier                           only these; the rows of others stay

Writes build/results/bodies.json, row by row as they come; parts that are not measured stay as they were in it. A peer who takes too long is told so. A peer's row that does not hold is no fault
of ours. Exit code 1: an engine failed, a row of fp3 does not hold, or a scene has two hashes.
"""

import argparse
import json
import math
import pathlib
import select
import subprocess
import sys
import time

import bench

PARTS = ("truths", "standing", "speed", "error", "hashes", "chip")
ALONE = {"hashes", "chip"}  # parts without peers
# Who is a part of an engine that is there already has its own parts; implicitfast is Euler where nothing damps.
SOME = {"fp3, laws on fast": ("speed",), "fp3, threads 2": ("speed",), "mujoco": ("truths", "standing", "speed"), "mujoco, RK4": ("truths", "standing", "error"), "mujoco, Euler": ("error",), "mujoco, implicit": ("error",)}
OWN = "fp3"
BESIDE = ("own box2d", "box2d")  # whom FP3 is compared with, who has as much time as FP3
SETTLE, MOST, OTHERS, TURN, TURNS = 600, 20.0, 4.0, 0.1, 5  # steps before a scene is timed; seconds that they may take, and may of other peers; seconds of a turn; turns
LIMIT = 15.0  # seconds that a peer has for an answer, beside twice what the scene may take
STAND, OTHERS_STAND = 100.0, 6.0  # seconds that a scene may take to stand, and may of other peers


class Failed(Exception):
    """An engine did not answer."""


class Slow(Exception):
    """It took longer than it may."""


class Engine:
    """A process with one engine, which answers line by line; started again after it died."""

    def __init__(self, name, python, tool="bodies_peers"):
        self.name, self.command, self.process = name, [python, bench.ROOT / f"tools/{tool}.py", name], None

    def ask(self, limit=None, **command):
        """limit: seconds for the answer; then it is ended."""
        if self.process is None or self.process.poll() is not None:
            self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        try:
            self.process.stdin.write(json.dumps(command) + "\n")
            self.process.stdin.flush()
            if limit and not select.select([self.process.stdout], [], [], limit)[0]:
                self.process.kill()
                self.process.wait()
                raise Slow(f"slower than {limit:g} s")
            line = self.process.stdout.readline()
        except OSError:
            line = ""
        if not line:
            raise Failed(f"{self.name}: ended with exit code {self.process.wait()} at {command}")
        answer = json.loads(line)
        if "error" in answer:
            raise Failed(f"{self.name}: {answer['error']} at {command}")
        return answer

    def end(self):
        if self.process:
            self.process.stdin.close()
            self.process.wait()


def listed(python, tool="bodies_peers"):
    """Who can be measured by a Python."""
    if not python.exists():
        return []
    done = subprocess.run([python, bench.ROOT / f"tools/{tool}.py", "list"], capture_output=True, text=True)
    return [line for line in done.stdout.splitlines() if line] if done.returncode == 0 else []


def most_of(name, own, others):
    """FP3 and whom it is compared with have as much time."""
    return own if name in (OWN, "fp3, threads 2", *BESIDE) else others


class Lab:
    def __init__(self, options, say):
        pythons = {name: python for python in (options.peers, pathlib.Path(sys.executable)) for name in listed(python)}
        wanted = [name for name in pythons if not options.engines or name in options.engines]
        self.engines, self.quick, self.say = {name: Engine(name, pythons[name]) for name in wanted}, options.quick, say
        self.failed, self.scenes, self.limit, self.record = [], options.scenes, options.limit, lambda found: None

    def who(self, part):
        return [name for name in self.engines if part in SOME.get(name, PARTS)]

    def wanted(self, scenes):
        return [scene for scene in scenes if not self.scenes or scene in self.scenes]

    def ask(self, name, **command):
        """None: it failed, which is noted. A peer who does not answer in time is refused."""
        most = command.get("most", 0.0)
        try:
            return self.engines[name].ask(limit=None if name.split(",")[0] == OWN else 2 * most + self.limit, **command)
        except Slow as why:
            return {"refused": str(why)}
        except Failed as why:
            self.failed.append(str(why))
            self.say(f"failed: {why}")
            return None

    def truths(self):
        from fp3bodies import truths  # it needs NumPy, which the page does not
        rows, refused = [], []
        for truth in [truths.slope, truths.pendulum] if self.quick else truths.TRUTHS:
            for name in self.who("truths"):
                answer = self.ask(name, do="truth", test=truth.__name__) or {"rows": [], "refuses": []}
                if "refused" in answer:
                    answer = {"rows": [], "refuses": [{"test": truth.__name__, "why": answer["refused"]}]}
                rows += [row | {"peer": name} for row in answer["rows"]]
                refused += [row | {"peer": name} for row in answer["refuses"]]
            of = [row for row in rows if row["test"] == truth.__name__]
            self.record({"truths": rows, "truths_refused": refused})
            self.say(f"{truth.__name__}: {sum(row['holds'] for row in of)} of {len(of)} rows hold")
        return {"truths": rows, "truths_refused": refused}

    def standing(self):
        from fp3bodies import standing
        rows, refused = [], []
        for scene in self.wanted(standing.QUICK if self.quick else standing.SCENES):
            for name in self.who("standing"):
                answer = self.ask(name, do="stand", scene=scene, seconds=2 if self.quick else standing.SCENES[scene][1],
                                  most=most_of(name, STAND, OTHERS_STAND))
                if answer and "refused" not in answer:
                    rows.append({"scene": scene, "engine": name} | answer)
                elif answer:
                    refused.append({"scene": scene, "engine": name, "why": answer["refused"]})
                self.record({"standing": rows, "standing_refused": refused})
            self.say(f"{scene} stood")
        return {"standing": rows, "standing_refused": refused}

    def speed(self):
        """All make their turns one after another, as often as there is time for; the shortest turn counts."""
        from fp3bodies import scene as sc
        rows, refused = [], []
        for scene in self.wanted(["pyramid 10"] if self.quick else [make().name for make in sc.FAST]):
            made = {name: self.ask(name, do="make", scene=scene, steps=20 if self.quick else SETTLE, most=most_of(name, MOST, OTHERS)) for name in self.who("speed")}
            refused += [{"scene": scene, "engine": name, "why": answer["refused"]} for name, answer in made.items() if answer and "refused" in answer]
            made = {name: answer for name, answer in made.items() if answer and "refused" not in answer}
            steps = {name: max(1, round(TURN * answer["steps"] / max(answer["seconds"], 1e-6))) for name, answer in made.items()}
            best = {}
            for _ in range(3 if self.quick else TURNS):
                for name in list(made):
                    answer = self.ask(name, do="turn", steps=steps[name])
                    if answer is None or "refused" in answer:
                        refused += [{"scene": scene, "engine": name, "why": answer["refused"]}] if answer else []
                        made.pop(name)
                        continue
                    best[name] = min(best.get(name, math.inf), answer["seconds"] / steps[name])
            for name, answer in made.items():
                row = {"scene": scene, "engine": name, "threads": answer.get("threads", 1), "bodies": answer["bodies"], "settled": answer["steps"],
                       "substeps": answer["substeps"], "ns_per_body_step": 1e9 * best[name] / answer["bodies"],
                       "arithmetic": answer["arithmetic"], "note": answer["note"]}
                beside = next((one for one in BESIDE if one in made), None)
                rows.append(row | ({"ratio_to_box2d": best[name] / best[beside], "box2d": beside} if beside else {}))
                self.say(f"{scene}, {name}: {row['ns_per_body_step']:.0f} ns")
            self.record({"speed": rows, "speed_refused": refused})
        return {"speed": rows, "speed_refused": refused}

    def chip(self):
        from fp3bodies import chip, hashes
        try:
            return {"chip": chip.measure(self.quick, self.say, self.wanted(chip.SCENES) if self.scenes else ())}
        except hashes.Failed as why:
            self.failed.append(str(why))
            return {}

    def hashes(self):
        from fp3bodies import hashes
        try:
            return {"hashes": hashes.measure(self.quick, self.say, self.wanted(hashes.SCENES) if self.scenes else ())}
        except hashes.Failed as why:
            self.failed.append(str(why))
            return {}

    def error(self):
        """Likewise in turns; who has taken long has no more."""
        from fp3bodies import error
        rows, refused = [], []
        for run in self.wanted(error.QUICK if self.quick else error.RUNS):
            for substeps in error.SUBSTEPS[:3:2] if self.quick else error.SUBSTEPS:
                found = {name: self.ask(name, do="error", run=run, substeps=substeps) for name in self.who("error")}
                refused += [{"scene": run, "engine": name, "why": answer["refused"]} for name, answer in found.items()
                            if answer and "refused" in answer and substeps == error.SUBSTEPS[0]]
                found = {name: answer["off"] for name, answer in found.items() if answer and "refused" not in answer}
                best, spent = {}, dict.fromkeys(found, 0.0)
                for _ in range(1 if self.quick else 5):
                    for name in [name for name in found if spent[name] < 1]:
                        begin, answer = time.monotonic(), self.ask(name, do="pace", run=run, substeps=substeps)
                        spent[name] += time.monotonic() - begin
                        best[name] = min(best.get(name, math.inf), answer["ns"] if answer and "refused" not in answer else math.inf)
                rows += [{"scene": run, "engine": name, "substeps": substeps, "error": off if math.isfinite(off) else None, "ns_per_body_step": best[name]}
                         for name, off in found.items() if math.isfinite(best[name])]
                self.record({"error": rows, "error_refused": refused})
                self.say(f"{run}, {substeps} substeps")
        return {"error": rows, "error_refused": refused}


def joined(options, data, found):
    """What is found of some engines and scenes takes the place of their rows alone."""
    def is_new(key, row):
        return ((not options.engines or key in ALONE or row.get("peer", row.get("engine")) in options.engines) and
                (not options.scenes or row.get("scene") in options.scenes))
    return {key: [row for row in data.get(key, []) if not is_new(key, row)] + rows for key, rows in found.items()}


def partly(data, found):
    """The same while a part is measured: rows take the place of those that are of the same."""
    def of(row):
        return row.get("scene"), row.get("test"), row.get("peer", row.get("engine")), row.get("substeps")

    def join(old, rows):
        new = {of(row) for row in rows}
        return [row for row in old if of(row) not in new] + rows
    return {key: join(data.get(key, []), rows) for key, rows in found.items()}


def wrong(found):
    from fp3bodies import truths
    for row in found.get("truths", []):
        off = math.inf if row["found"] is None else abs(row["found"] - row["expected"])
        if row["peer"] == OWN and not row["holds"] and off > truths.SHORT.get(row["what"], 0):
            yield f"{row['what']}: found {row['found']}, expected {row['expected']:.6g} within {row['within']:.2g}"
    if "chip" in found:
        from fp3bodies import chip
        for row in chip.wrong(found["chip"]):
            yield f"{row['scene']}, {row['config']}, {row['law']}: {row['cycles']} cycles, foreseen {row['runs']} times {row['foreseen']}"
    if "hashes" in found:
        from fp3bodies import hashes
        for row in hashes.differing(found["hashes"]):
            yield f"{row['scene']}, {row['engine']}, {row['variant']}: hash {row['hash']} is not that of others"


def measure(options):
    """Parts one by one, each written at once; yields what is wrong."""
    begin, data = time.monotonic(), bench.kept(options)
    about = bench.about(options) | {"command": "make bodies" + (" QUICK=1" if options.quick else "")}
    lab = Lab(options, lambda text: print(f"bodies: {text}, {time.monotonic() - begin:.0f} s so far", file=sys.stderr, flush=True))
    if not lab.engines:
        yield "nobody to measure: make setup-bench"
    measured = data.get("measured", {})
    try:
        for part in options.parts:
            if part in ALONE and options.engines and OWN not in options.engines:
                continue
            lab.record = lambda some: bench.write(options.output, json.dumps(data | {"about": about} | partly(data, some), indent=1) + "\n")
            found = getattr(lab, part)()
            measured[part] = {"date": about["date"], "revision": about["revision"], "load": about["load"]}
            data |= {"about": about, "measured": measured} | joined(options, data, found)
            bench.write(options.output, json.dumps(data, indent=1) + "\n")
            yield from wrong(found)
        yield from lab.failed
    finally:
        for engine in lab.engines.values():
            engine.end()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peers", type=pathlib.Path, default=bench.ROOT / ".venv-bench/bin/python",
                        help="a Python that may have Box2D and other engines (default: that of make setup-bench)")
    parser.add_argument("--quick", action="store_true", help="few tests, small scenes")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS, help="only these (default: all)")
    parser.add_argument("--engines", nargs="+", help="only these (default: all that are installed)")
    parser.add_argument("--scenes", nargs="+", help="of other parts than truths, only these")
    parser.add_argument("--limit", type=float, default=LIMIT, metavar="SECONDS", help="what a peer has for an answer, beside twice what the scene may take (default: %(default)g)")
    parser.add_argument("--output", type=pathlib.Path, default=bench.ROOT / "build/results/bodies.json", help="the file to write")
    options = parser.parse_args()
    if options.scenes and "truths" in options.parts:
        parser.error("expected --parts without truths beside --scenes")
    errors = 0
    for error in measure(options):
        print(f"bodies: {error}", file=sys.stderr)
        errors += 1
    print(f"{errors} rows of fp3 do not hold or differ, or engines failed")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())

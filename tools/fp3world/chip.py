"""Cycles of the simulated hardware for a step of an object, and the share of them in which lanes exchange what others see."""

import pathlib
import re
import subprocess
import tomllib

from fp3world import hashes
from fp3world import scene as ws

STEPS = {True: (4, 8), False: (50, 100)}
SCENES = ["balls", "chain", "cloth", "planets", "stars"]


def lanes_of(config):
    keys = next(keys for keys in tomllib.loads((ws.ROOT / "isa/configs.toml").read_text(encoding="utf-8"))["config"] if keys["name"] == config)
    return keys.get("tiles", 1) * keys.get("schedulers", 1) * keys.get("lanes", 1)


def exchange_share(fp3, path, config, steps):
    """As the cycles are foreseen, which tests/cosim/lanes_scene.c holds to those of the hardware, and prints."""
    if lanes_of(config) == 1:
        return 0
    program = pathlib.Path(fp3).absolute().parent / "tests/lanes_scene"
    done = subprocess.run([program, path, config, str(steps)], capture_output=True, text=True)
    if done.returncode:
        raise ws.Failed(f"{program.name} {path.name}: {done.stdout}{done.stderr}")
    cycles, copying = map(int, re.search(r"cycles (\d+), of copies (\d+)", done.stdout).groups())
    return copying / cycles


def counters(said):
    return {name: int(count) for name, count in re.findall(r"^(\w+) +(\d+)$", said, re.M)}


def measure(fp3, folder, quick, say):
    """Cycles of the steps alone: those of a longer run less those of a shorter one."""
    rows, refused = [], []
    for name in SCENES:
        label, text = hashes.form_of(name, hashes.SMALL)
        path = ws.put(folder, text, "chip")
        for config in ws.worlds():
            try:
                short, long = (counters(ws.call(fp3, path, "--engine", "rtl", "--config", config, "--steps", n)) for n in STEPS[quick])
            except ws.Failed as why:
                if not why.is_limit():
                    raise
                refused.append({"scene": label, "config": config, "why": str(why)})
                continue
            cycles, steps = (long[key] - short[key] for key in ("cycles", "object_steps"))
            rows.append({"scene": label, "config": config, "lanes": lanes_of(config), "objects": long["object_steps"] // STEPS[quick][1],
                         "cycles_per_object_step": cycles / steps, "exchange_share": exchange_share(fp3, path, config, STEPS[quick][0])})
            say(f"{label}, {config}: {cycles / steps:.1f} cycles for a step of an object")
    return rows, refused

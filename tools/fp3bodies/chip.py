"""Cycles of the simulated hardware for the laws of a step: measured, foreseen, and those of the bus between its runs."""

import pathlib
import tempfile

from fp3bodies import hashes

SCENES = ["pyramid 10", "2 ragdolls", "car"]
QUICK = ["30 dominoes, 0.35 apart"]
STEPS = 1
WORDS = ("runs", "lanes", "cycles", "foreseen", "foreseen_38", "bus_words", "bus_cycles")


def measure(quick, say, names=()):
    """A row for each law that a scene has; the hash is that of built-in laws, or this fails."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in names or (QUICK if quick else SCENES):
            path = hashes.write(pathlib.Path(folder), hashes.SCENES[name]())
            wanted = hashes.stepped(path, STEPS)
            for config in hashes.CONFIGS[:1] if quick else hashes.CONFIGS:
                found, *lines = hashes.said(path, STEPS, "rtl", config).splitlines()
                if found != wanted:
                    raise hashes.Failed(f"{name}, rtl, {config}: hash {found}, expected {wanted}")
                for law, *numbers in map(str.split, lines):
                    row = dict(zip(WORDS, map(int, numbers)))
                    if row["runs"]:
                        rows.append({"scene": name, "config": config, "law": law, "steps": STEPS} | row)
                say(f"{name}, {config}: {sum(row['cycles'] for row in rows if (row['scene'], row['config']) == (name, config))} cycles")
    return rows


def wrong(rows):
    """Those whose cycles are not those that were foreseen."""
    return [row for row in rows if row["cycles"] != row["runs"] * row["foreseen"]]

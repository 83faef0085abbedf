"""The tables of docs/cluster_results.md and its picture, from what `make cluster` measured."""

import numpy as np

from fp3cluster import model as cm
from fp3gen.text import between, markdown
import plot

CONSTANTS = {"step_us": "what a step costs without objects", "object_us": "a step of a mass of the cloth, on one processor", "near_latency_us": "latency on one node",
             "near_us_per_byte": "a byte on one node", "far_latency_us": "latency between two nodes without delay, both on this machine",
             "far_us_per_byte": "a byte between two nodes", "switch_us": "another rank gets the processor", "balls_object_us": "a step of a ball",
             "stars_pair_us": "a pair of stars"}


def number(value):
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def hashes(data):
    rows = {}
    for row in data["hashes"]:
        rows.setdefault(row["scene"], (row["sees"], row["steps"], row["hash"][:12], {}))[3].setdefault(row["engine"], []).append(str(row["ranks"]))
    yield from markdown(["scene", "objects see", "steps", "hash", "`isa`", "`fast`", "`rtl`"],
                     [[scene, sees, steps, f"`{short}`", *(", ".join(on.get(engine, ["–"])) for engine in ("isa", "fast", "rtl"))]
                      for scene, (sees, steps, short, on) in rows.items()])


def kills(data):
    found = data["kills"]
    yield (f"Of {found['tried']} kills {found['right']} ended with the right hash; {found['one_rank']} of them killed one rank, "
           f"{found['whole_job']} the whole job.")


def exchange(data):
    yield from markdown(["how", "ranks", "nodes", "delay, µs", "packet there and back, µs", "exchange, µs", "step, µs", "bytes"],
                     [[row["way"], row["ranks"], row["nodes"], row["delay_us"] if row["nodes"] == 2 else "–",
                       number(row["round_trip_us"]) if "round_trip_us" in row else "–", number(row["us_per_step"]),
                       number(row["step_us"]), number(row["bytes_per_step"])] for row in data["exchange"]])


def scale(data):
    share, million = data["share"], data["million"]
    side = share["side"]
    rows = [[f"exchange, share of a step of a {side} × {side} cloth on 2 ranks", f"{100 * share['share']:.2f} %", "at most 10 %"],
            ["speed of 2 ranks with a thread each, as a share of that of one process with 2 threads", f"{100 * share['ratio']:.1f} %", "at least 90 %"]]
    for row in data["ghosts"]:
        rows.append([f"bytes that {row['ranks']} ranks send in a step of {row['scene']}", f"{row['sent']:,.0f}", f"{row['needed']:,} ({row['needed_is']})"])
    for row in million:
        name = "a cloth of 1000 × 1000" if row["scene"].startswith("cloth") else "a million balls"
        rows.append([f"{name}: compiled, divided, set up and one step made, on 2 ranks", f"{row['seconds']['2']:.2f} s", "at most 5 s"])
        memory = ", ".join(f"{max(mb):,.0f}" for mb in row["memory_mb"].values())
        rows.append([f"{name}: peak memory of a rank, of 1, 2 and 4", f"{memory} MB", "–"])
    yield from markdown(["what", "measured", "goal, or what is needed"], rows)


def model(data):
    yield from markdown(["constant", "µs"], [[text, f"{data['constants'][name]:.3g}"] for name, text in CONSTANTS.items() if name in data["constants"]])
    yield ""
    tried = [row for row in data["model"] if not row["is_fitted"]]
    off = sorted(abs(row["predicted"] / row["measured"] - 1) for row in tried)
    yield (f"The rows below took no part in the fit. Half of the {len(tried)} predictions are within {100 * off[len(off) // 2]:.0f} % of the measurement; "
           f"the worst is {100 * off[-1]:.0f} % off. The columns: masses; ranks; nodes; the delay of the wire; "
           "the time of a step as predicted and as measured; their ratio.")
    yield ""
    yield from markdown(["masses", "ranks", "nodes", "delay, µs", "predicted, µs", "measured, µs", "ratio"],
                     [[f"{row['side']} × {row['side']}", row["ranks"], row["nodes"], row["delay_us"] if row["nodes"] == 2 else "–", number(row["predicted"]),
                       number(row["measured"]), f"{row['predicted'] / row['measured']:.2f}"] for row in tried])


def every_case(constants):
    """Name, colour, dash, time of a step for so many ranks, objects, most ranks. 2^25 objects are the most that an engine in the host has."""
    for objects, colour in ((10 ** 6, "#0072b2"), (2 ** 25, "#56b4e9")):
        size = f"{objects:,}"
        yield f"cloth, {size}, nodes", colour, "-", lambda r, n=objects: cm.cloth_at(cm.NODES, constants["object_us"], n, r), objects, 10 ** 4
        yield f"balls, {size}, nodes", colour, "--", lambda r, n=objects: cm.balls_at(cm.NODES, constants["balls_object_us"], n, r), objects, 10 ** 4
    yield "stars, 100,000, nodes", "#d55e00", "-", lambda r: cm.stars_at(cm.NODES, constants["stars_pair_us"], 10 ** 5, r), 10 ** 5, 10 ** 4
    yield "cloth, 256 a board", "#009e73", "-", lambda r: cm.cloth_at(cm.BOARDS, cm.BOARD_OBJECT_US, cm.BOARD_ROOM * r, r), None, 10 ** 3


def cases(constants):
    """Those of which the fit knows what an object takes: times that other work has lengthened may leave nothing for it."""
    return [case for case in every_case(constants) if case[3](1) > 0]


def extended(data):
    constants, rows = data["constants"], []
    for name, _, _, at, objects, most in cases(constants):
        ranks = np.unique(np.logspace(0, np.log10(most), 60).astype(int))
        per_rank = [at(1) * (1 if objects else count) / (count * at(int(count))) for count in ranks]
        half = [int(count) for count, share in zip(ranks, per_rank) if share >= 0.5]
        fastest = int(ranks[int(np.argmin([at(int(count)) / (1 if objects else count) for count in ranks]))])
        more = "more than " if half[-1] == most else ""
        rows.append([name, f"{more}{half[-1]:,}", f"{fastest:,}", number(at(fastest))])
    yield from markdown(["scene", "ranks at half efficiency", "fastest with", "a step then, µs"], rows)


def draw(data):
    series = []
    for name, colour, dash, at, objects, most in cases(data["constants"]):
        ranks = np.unique(np.logspace(0, np.log10(most), 60).astype(int))
        points = [(int(count), 1e6 * (objects or cm.BOARD_ROOM * count) / at(int(count))) for count in ranks]
        series.append({"name": name, "look": (colour, dash, None), "points": points})
    return plot.draw(series, "ranks", "object-steps per second, by the model")


# What each needs of the file.
PARTS = {"hashes": (hashes, "hashes"), "kills": (kills, "kills"), "exchange": (exchange, "exchange"), "scale": (scale, "share"), "model": (model, "model"),
         "extended": (extended, "model")}


def page(text, data):
    for name, (part, needs) in PARTS.items():
        if needs in data:
            text = between(text, name, part(data))
    return text


def beside(data):
    return {"cluster.svg": draw(data)} if "model" in data else {}

"""A model of the time of a step: what ranks compute, latency, bytes. Fitted to this machine, then extended to others.

    step = start + object * objects / ranks * imbalance * sharing + latency + bytes / bandwidth + switch * (sharing - 1)

`sharing` is how many ranks share a processor, at least 1. A rank talks to all its neighbours at the same time, so a step has one latency. `bytes` are
those of one rank. Times are in microseconds.
"""

import os

import numpy as np

IMBALANCE = 1.02  # what the partition allows: UNEVEN in sw/engine/mpi/divide.c
PROCESSORS = os.cpu_count()


def sharing(row):
    return max(1.0, row["ranks"] / PROCESSORS)


def load(row):
    """Objects that the slowest rank computes, times how many ranks share its processor."""
    return row["side"] ** 2 / row["ranks"] * (IMBALANCE if row["ranks"] > 1 else 1.0) * sharing(row)


def terms(row):
    """What stands before each constant."""
    is_near, is_far = row["ranks"] > 1 and row["nodes"] == 1, row["nodes"] == 2
    own = row["bytes"] / row["ranks"]
    return {"step_us": 1.0, "object_us": load(row), "near_latency_us": 1.0 * is_near, "near_us_per_byte": own * is_near,
            "far_latency_us": 1.0 * is_far, "far_us_per_byte": own * is_far, "switch_us": (sharing(row) - 1) * is_near}


def fit(rows):
    """Least squares of relative errors, no constant below zero."""
    rows = [row for row in rows if row["is_fitted"]]
    names = [name for name in terms(rows[0]) if any(terms(row)[name] for row in rows)]
    left = names
    while True:
        matrix = np.array([[terms(row)[name] / row["measured"] for name in left] for row in rows])
        found = dict(zip(left, np.linalg.lstsq(matrix, np.ones(len(rows)), rcond=None)[0].tolist()))
        if min(found.values()) >= 0:
            return {name: found.get(name, 0.0) for name in names}
        left = [name for name in left if found[name] >= 0]


def step(constants, row):
    """Microseconds. The delay of a wire comes on top of its latency."""
    delay = row["delay_us"] if row["nodes"] == 2 else 0
    return sum(constants[name] * value for name, value in terms(row).items() if name in constants) + delay


# ---- other machines ----

# Latency in microseconds, bytes a microsecond, processors a rank. None was measured: 2 us and 100 Gbit/s are assumed of a cluster's network, 50 us and
# 1 Gbit/s of the Ethernet between boards.
NODES = {"latency": 2.0, "bandwidth": 12500.0}
BOARDS = {"latency": 50.0, "bandwidth": 125.0}
# Cycles for a step of an object of the cloth and MHz of configuration `world` (docs/world.md, docs/sizes.md), objects that its store has room for.
BOARD_OBJECT_US = 392.6 / 119.5
BOARD_ROOM = 256
GHOST_BYTES = 24  # six words


def cloth_at(network, object_us, objects, ranks):
    """Squares: each rank needs two rows of masses along each of its four edges."""
    edge = (objects / ranks) ** 0.5
    ghosts = min(objects - objects / ranks, 8 * edge) if ranks > 1 else 0
    return (object_us * objects / ranks * (IMBALANCE if ranks > 1 else 1) + (network["latency"] if ranks > 1 else 0) +
            ghosts * GHOST_BYTES / network["bandwidth"])


def balls_at(network, object_us, objects, ranks):
    """Cubes with a layer of one ball around them; and all ranks ask each other whether some ball has moved far, in log2(ranks) rounds."""
    edge = (objects / ranks) ** (1 / 3)
    ghosts = min(objects - objects / ranks, 6 * edge ** 2) if ranks > 1 else 0
    return (object_us * objects / ranks * (IMBALANCE if ranks > 1 else 1) + (network["latency"] * (1 + 2 * np.log2(ranks)) if ranks > 1 else 0) +
            ghosts * GHOST_BYTES / network["bandwidth"])


def stars_at(network, pair_us, objects, ranks):
    """Three words of all others go to every rank, one message from each."""
    return pair_us * objects ** 2 / ranks + (ranks - 1) * network["latency"] + (objects - objects / ranks) * 12 / network["bandwidth"]


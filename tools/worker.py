"""A peer in a process of its own, told line by line: tools/bodies_peers.py and tools/scenes_peers.py.

    sys.exit(worker.serve(__doc__, NAMES, installed, Worker))

A line has a command in JSON, {"do": "turn", "steps": 10}: a method of the worker, and what it takes. The answer is a line, too: what the method returns, {"refused": WHY} for
what the peer has not, or {"error": WHY}.
"""

import argparse
import json
import os
import sys


def answer(worker, refused, do, **more):
    try:
        return getattr(worker, do)(**more)
    except refused as why:
        return {"refused": str(why)}
    except Exception as why:  # whatever a peer does: the others go on  # pylint: disable=broad-exception-caught
        return {"error": f"{type(why).__name__}: {why}"}


def serve(about, names, installed, make, refused=()):
    """Answers until there are no more lines. installed(): who is there; make(name): whose methods are called; refused: what they raise for what they have not."""
    parser = argparse.ArgumentParser(description=about.splitlines()[0])
    parser.add_argument("peer", choices=["list", *names], help="who; list: print who is installed")
    peer = parser.parse_args().peer
    if peer == "list":
        print("\n".join(installed()))
        return 0
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # some print when they begin
    worker = make(peer)
    for line in sys.stdin:
        print(json.dumps(answer(worker, refused, **json.loads(line))), file=answers, flush=True)
    return 0

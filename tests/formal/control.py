"""The scoreboard's flags tell the truth: what its FORMAL block asserts, proved by induction."""

from mutants import Bug

# Latencies of units, with bypass and without; each of the configurations' kinds and the edges.
SHAPES = [(1, 1, 1), (1, 2, 2), (1, 3, 5), (1, 14, 13), (0, 1, 1), (0, 14, 13)]

BUGS = [
    (Bug("control", "a flag for what nobody waits for", "scoreboard.v", "BYPASS != 0 ? |(insert >> FREE) : issue_i",
         "issue_i"), (1, 1, 1)),
    (Bug("control", "a flagged destination issues", "scoreboard.v", "assign blocked_o = busy_q[d_i]",
         "assign blocked_o = 1'b0"), (1, 2, 2)),
    (Bug("control", "a taken slot is overwritten", "scoreboard.v", "|(slot & (valid_q >> 1))", "1'b0"), (1, 3, 5)),
    (Bug("control", "a flag falls with the wrong result", "scoreboard.v", "one << d_q[FREE]", "one << d_q[0]"),
     (1, 2, 2)),
]


def prove(yosys, files, shape):
    bypass, add, mul = shape
    # A proof that fails makes yosys fail.
    yosys.run("read_verilog -formal scoreboard.v; "
              f"chparam -set REG_W 3 -set BYPASS {bypass} -set ADD_LATENCY {add} -set MUL_LATENCY {mul} scoreboard; "
              "prep -top scoreboard -flatten; async2sync; chformal -lower; dffunmap; opt -full; "
              "sat -tempinduct -prove-asserts -set-assumes -maxsteps 2 -verify scoreboard; "
              "write_json done.json", files, "done.json")
    return "proved by induction"


def find(yosys, files, bug, shape):
    try:
        prove(yosys, bug.patch(files), shape)
    except RuntimeError as failed:
        if "proof did fail" not in str(failed):
            raise
        return "found: the induction fails"
    raise RuntimeError("the bug was not found")


def cases():
    """(name, action of yosys and files) for every proof and every seeded bug."""
    for shape in SHAPES:
        bypass, add, mul = shape
        name = f"scoreboard, latencies {add} and {mul}, {'bypass' if bypass else 'no bypass'}"
        yield name, lambda yosys, files, shape=shape: prove(yosys, files, shape)
    for bug, shape in BUGS:
        yield f"seeded: {bug.name}", lambda yosys, files, bug=bug, shape=shape: find(yosys, files, bug, shape)

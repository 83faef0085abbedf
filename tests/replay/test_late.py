"""Where z is read later than x and y (Z_LATE, rtl/config/derived.vh), no bit and no cycle comes of it; elsewhere it may not be.

A recorded run is replayed in Icarus by the hardware with something changed: its answers, cycles and the hash of all
retirements tell whether it is still the same.
"""

import shutil

import pytest
from test_unknown import compiled, start

# z is a register that the instruction before has written, or a constant; a product has none.
PROGRAM = """
.state  v s
.shared h
step:
    madd s, h, v, s
    mul  v, v, s
    add  s, s, v
    msub v, v, s, h
    sub  s, s, h
"""
CONFIG, LATE = "config/derived.vh", "SCHEDULERS == 1 ? MUL_LATENCY : 0"
# What is changed: (configuration, objects, program, file, right, other)
SAME = {
    "never late": ("many", 2, PROGRAM, CONFIG, LATE, "SCHEDULERS == 1 ? 0 : 0"),
    "half as late": ("many", 24, PROGRAM, CONFIG, LATE, "SCHEDULERS == 1 ? MUL_LATENCY / 2 : 0"),
}
OTHER = {
    "a number that does not wait": ("many", 2, PROGRAM, "sequence/fp3_issue.v", ".N(Z_LATE)", ".N(0)"),
    "the context of a cycle later": ("many", 2, PROGRAM, "sequence/fp3_issue.v", "SHARED : issue_context, z_q[", "SHARED : number(current_i), z_q["),
    "-0 a cycle too soon": ("many", 24, PROGRAM, "sequence/fp3_issue.v", ".d_i({zero_q, z_q", ".d_i({to_mul, z_q"),
    "a value that waits too": ("many", 2, PROGRAM, "fp/fp3_fp_value.v", ".N(DEPTH - Z_LATE)", ".N(DEPTH)"),
    "for one object": ("single", 1, PROGRAM, CONFIG, "INTERLEAVE != 0 && CHAIN", "CHAIN"),
    "where something is made of z and x": ("many_full", 2, PROGRAM + "    max  v, v, s\n", CONFIG, "VALUES == 0 && SCHEDULERS == 1 ?", "SCHEDULERS == 1 ?"),
    "where schedulers share an adder": ("shared", 2, PROGRAM, CONFIG, "VALUES == 0 && SCHEDULERS == 1 ?", "VALUES == 0 ?"),
}
QUICK = ("never late", "a number that does not wait")


def replayed(root, fp3, to, config, objects, program, file, right, other):
    (to / "x.s").write_text(program)
    done = start(fp3, "run", to / "x.s", "-c", config, "-N", objects, "--set", "s=0.75", "--set", "h=0.125",
                 *(["--spread", "v=1.5:2"] if objects > 1 else ["--set", "v=1.5"]), "--bus-log", to / "x.session")
    assert done.returncode == 0, done.stderr
    for folder in ("rtl", "sim"):
        shutil.copytree(root / folder, to / folder, ignore=shutil.ignore_patterns("fpga"))
    text = (to / "rtl" / file).read_text()
    assert text.count(right) == 1, f"{file}, expected once: {right!r}"
    (to / "rtl" / file).write_text(text.replace(right, other))
    return start("vvp", "-n", compiled(to, config, "-DFP3_CHECK"), f"+session={to / 'x.session'}").stdout


def parametrized(cases):
    return pytest.mark.parametrize("name", [pytest.param(name, marks=[] if name in QUICK else pytest.mark.long) for name in cases])


@parametrized(SAME)
def test_it_is_the_same_machine(root, fp3, tmp_path, name):
    said = replayed(root, fp3, tmp_path, *SAME[name])
    assert "PASS " in said and "FAIL" not in said, said


@parametrized(OTHER)
def test_it_is_another_one(root, fp3, tmp_path, name):
    said = replayed(root, fp3, tmp_path, *OTHER[name])
    assert "FAIL" in said and "PASS" not in said, said

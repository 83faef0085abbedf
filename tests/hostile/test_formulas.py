"""Numbers of models that FP32 or double has no room for: refused with the formula that they are the value of."""

import math
import re
import struct

import pytest

pytestmark = pytest.mark.smoke


def model(slope, step="1", head=""):
    return f"param k = 1\n{head}\nstate x = 1\nstep {step}\nx' = {slope}\n"


STEPS = ["1e-50", "1e-46", "1e39", "1e-200*1e-200", "0", "-1", "1e400", "1e-400"]


@pytest.mark.parametrize("step", STEPS)
def test_a_step_is_a_number_above_0(refused, step):
    refused({"a.ode": model("-x", step)}, ["compile", "a.ode", "-o", "a.s"], r"^a\.ode:4:6: error: found '")


REFUSED = [
    # right side, what the message says
    ("1e-50*x", r"^a\.ode:5:11: error: k1: x' = 1e-50\*x: found 1e-50, expected 0 or a number above 7e-46, the start of FP32"),
    ("1e39*x", r"^a\.ode:5:10: error: k1: x' = 1e\+39\*x: found 1e\+39, expected a number below 3\.4028236e38, the end of FP32"),
    ("0*x + 1e-60", r"found 1e-60, expected 0 or a number above 7e-46"),
    ("k*1e-50*x", r"k\*1e-50 \(line 5 of the model\) is 1e-50: expected 0 or a number above 7e-46"),
    ("k*1e-25*1e-25*x", r"k\*1e-25\*1e-25 \(line 5 of the model\) is 1e-50: expected 0 or a number above"),
    ("k*1e30*1e30*x", r"k\*1e\+30\*1e\+30 \(line 5 of the model\) is 1e\+60: expected a number below 3\.4028236e38"),
    ("1e-200*1e-200*x", r"1e-200\*1e-200 \(line 5 of the model\) is nan: expected a finite number, and none below 2\.2e-308 on the way"),
    ("k*1e200*1e200*x", r"k\*1e\+200\*1e\+200 \(line 5 of the model\) is inf: expected "),
    ("1e-160*1e-160*1e300*x", r"1e-160\*1e-160\*1e\+300 \(line 5 of the model\) is nan"),  # 3 digits are left of it
    ("exp(-1000*k)*x", r"exp\(\(-1000\)\*k\) \(line 5 of the model\) is nan: expected a finite number, and none below"),
    ("log(0*k)*x", r"log\(0\*k\) \(line 5 of the model\) is -inf: expected a"),
    ("sqrt(-k)*x", r"sqrt\(-k\) \(line 5 of the model\) is -?nan: expected a finite number"),
]


@pytest.mark.parametrize("engine", ["isa", "rtl"])
@pytest.mark.parametrize("slope, message", REFUSED, ids=map(str, range(len(REFUSED))))
def test_what_no_register_can_hold_is_refused(refused, slope, message, engine):
    refused({"a.ode": model(slope)}, ["run", "a.ode", "--integrator", "euler", "--engine", engine], message)


def test_a_declaration_is_refused_where_it_stands(refused):
    refused({"a.ode": model("x", head="param q = 1e-200*1e-200")}, ["compile", "a.ode", "-o", "a.s"],
            r"^a\.ode:2:11: error: found '1e-200', expected a value computed without numbers below 2\.2e-308")


RIGHT = [
    # Where what is lost does not count: one step of Euler's method from 1.
    ("(1 + exp(-1000*k))*x", 2.0),
    ("(0*exp(-1000*k))*x", 1.0),
    ("max(exp(-1000*k), 0.5)*x", 1.5),
    ("(k > 0 ? 1 : exp(-1000*k))*x", 2.0),
    ("1e-30*1e-30*1e60*k*x", 2.0),
    ("1e200*1e-200*k*x", 2.0),
]


@pytest.mark.parametrize("slope, x", RIGHT, ids=map(str, range(len(RIGHT))))
def test_what_does_not_count_is_no_error(hostile, slope, x):
    done = hostile({"a.ode": model(slope)}, ["run", "a.ode", "--integrator", "euler", "--engine", "isa"])
    assert done.returncode == 0, done.stderr
    found = struct.unpack("<f", struct.pack("<I", int(re.search(rb"^x +\S+ +(0x\w+)", done.stdout, re.M)[1], 16)))[0]
    assert math.isclose(found, x, rel_tol=1e-7)

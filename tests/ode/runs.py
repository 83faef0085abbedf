"""The command, started by a test, and the numbers that it prints as bits."""

import os
import pathlib
import re
import struct
import subprocess

BUILD = os.environ["FP3_BUILD"]
FP3 = os.path.join(BUILD, "fp3")


ROWS = pathlib.Path(__file__).resolve().parents[2] / "sw/language/function_rows.h"


def functions():
    """Those of the language that are computed with constants."""
    return set(re.findall(r"^    X\(\w+, (\w+), POLYNOMIAL", ROWS.read_text(encoding="utf-8"), re.M))


def fp3(*arguments, status=0):
    done = subprocess.run([FP3, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == status, done.stdout + done.stderr
    return done


def number(bits):
    return struct.unpack("<f", struct.pack("<I", int(bits, 16)))[0]


def truth(path, t, status=0):
    """The states at time t by fp3_model_truth, or why there are none."""
    done = subprocess.run([os.path.join(BUILD, "tests/models"), "truth", path, str(t)], capture_output=True, text=True)
    assert (done.returncode != 0) == (status != 0), done.stdout + done.stderr
    return done.stderr if status else {name: float(value) for name, value in map(str.split, done.stdout.splitlines())}

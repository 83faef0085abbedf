"""Runs a bench of cocotb inside Icarus, of the RTL or of a broken copy of it."""

import functools
import os
import re
import subprocess
from pathlib import Path


FAILED = r"cocotb\.regression +(\w+) failed"


class Done:
    """What a bench said, whether all of its tests passed, and which of them failed."""

    def __init__(self, said, passed):
        self.said, self.passed = said, passed
        self.failed = re.findall(FAILED, said)


def python(root):
    """The Python that has cocotb."""
    path = root / ".venv/bin/python"
    assert path.exists(), "make setup makes .venv"
    return path


def top(config):
    """The top module of a configuration, as the build has made it."""
    return Path(os.environ.get("FP3_BUILD", Path(__file__).resolve().parents[1] / "build")) / f"rtl/fp3_{config}.v"


def key(config, name):
    """The value of a key, as the top gives it to fp3."""
    return int(re.search(rf"\.{name} +\((\d+)\)", top(config).read_text())[1])


def shape(config):
    """What sim/replay.v must be told of a configuration."""
    tiles, schedulers, lanes, multiply_add = (key(config, name) for name in ("TILES", "SCHEDULERS", "LANES", "MULTIPLY_ADD"))
    bits = int(re.search(r"\[(\d+):0\] +s_axi_awaddr", top(config).read_text())[1]) + 1
    return [f"-DFP3_TOP=fp3_{config}", f"-DFP3_ADDRESS_W={bits}", f"-DFP3_SCHEDULERS={tiles * schedulers}", f"-DFP3_LANES={tiles * schedulers * lanes}", f"-DFP3_STREAMS={1 + (multiply_add == 3)}"]


def config_word(tree, values):
    """The parameter CONFIG with these values of keys, and the others as they are by default."""
    text = (tree / "rtl/gen/parameters.vh").read_text()
    width, word = re.search(r"CONFIG = (\d+)'h(\w+)", text).groups()
    word, at = int(word, 16), {key: int(low) for key, low in re.findall(r"(\w+)\s*= CONFIG\[\d+:(\d+)\]", text)}
    for key, value in values.items():
        word = word & ~(0xffffffff << at[key]) | value << at[key]
    return f"{width}'h{word:x}"


def compiled(tree, folder, top, file, *options):
    """The module `top` with every module that it needs, from the RTL of `tree`."""
    bench, clock = folder / f"{top}.vvp", folder / "clock.f"
    clock.write_text("+timescale+1ns/1ps\n")
    done = subprocess.run(["iverilog", "-g2012", "-s", top, "-c", "rtl/fp3.f", "-c", clock, *options, "-o", bench, file],
                          cwd=tree, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return bench


@functools.cache
def config(root, *arguments):
    """What cocotb says of where it lies."""
    return subprocess.run([python(root), "-m", "cocotb.config", *arguments], capture_output=True, text=True, check=True).stdout.strip()


def cocotb(root, folder, bench, module, whole=True, seconds=None, **environment):
    """Runs the tests of a Python module on what was compiled; `environment` is for them. Not `whole`: up to the first that fails. After so many
    `seconds` of processor time it is ended, and has not passed."""
    results = folder / "results.xml"
    results.unlink(missing_ok=True)
    own = {"MODULE": module.stem, "TOPLEVEL": bench.stem, "TOPLEVEL_LANG": "verilog", "PYTHONPATH": str(module.parent),
           "LIBPYTHON_LOC": config(root, "--libpython"), "VIRTUAL_ENV": str(root / ".venv"), "COCOTB_RESULTS_FILE": str(results),
           "PYTHONDONTWRITEBYTECODE": "1", **{name: str(value) for name, value in environment.items()}}
    said = []
    limit = ["prlimit", f"--cpu={seconds}"] if seconds else []
    with subprocess.Popen([*limit, "vvp", "-n", "-M", config(root, "--lib-dir"), "-m", config(root, "--lib-name", "vpi", "icarus"), bench], cwd=folder,
                          env={**os.environ, **own}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        for line in process.stdout:
            said.append(line)
            if not whole and re.search(FAILED, line):
                process.kill()
    found = results.read_text() if results.exists() else ""
    return Done("".join(said), process.returncode == 0 and "<testcase" in found and "<failure" not in found)

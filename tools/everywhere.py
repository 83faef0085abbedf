#!/usr/bin/env python3
"""One hash of each scene on every machine: processors of other families run under qemu, as compiled for them.

    tools/everywhere.py --output build/results/everywhere.json
    tools/everywhere.py --only kepler balls         these scenes

Rows are {"scene", "platform", "variant", "hash"}: the hash is that of all that the run recorded, of its flags and of its failures.
The exit code is 1 if a hash differs from that of engine isa on this machine, or a platform that is asked for cannot run.
"""

import argparse
import datetime
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from bench import revision, write
from fp3gen.text import evidence

ROOT = pathlib.Path(__file__).resolve().parents[1]
# What is run, and how: programs that are small enough for the hardware under a simulator.
SCENES = {
    "kepler": ["programs/kepler.ode", "-c", "many_full", "-N", 40, "--spread", "v_y=0.5:1.2", "-n", 40, "--every", 20],
    "kepler, compensated": ["programs/kepler.ode", "-c", "many_full", "-k", "-i", "yoshida6", "-N", 24, "-n", 20, "--every", 10],
    "kepler, double-single": ["programs/kepler.ode", "-c", "many_full", "--double-single", "-i", "leapfrog", "-N", 24, "-n", 12, "--every", 6],
    "lorenz": ["programs/lorenz.ode", "-c", "many_full", "-i", "dopri5", "-N", 30, "--spread", "x=0.5:2", "-n", 16, "--every", 8],
    "van der Pol, stiff": ["programs/van_der_pol_stiff.ode", "-c", "many_full", "-i", "rodas3", "-N", 24, "-n", 32, "--every", 16],
    "van der Pol, adaptive": ["programs/van_der_pol.ode", "-c", "many_full", "-N", 24, "--spread", "mu=1:4", "--tolerance", "1e-3", "--times", "0.5,1,2"],
    "bouncing ball, located": ["programs/bouncing_ball.ode", "-c", "many_full", "-N", 8, "--spread", "e=0.5:0.9", "--set", "x=0.1", "--until", 0.1875, "--times", "0.125,0.1875"],
    "rigid body": ["programs/rigid_body.ode", "-c", "many_full", "-N", 30, "--spread", "w_x=0.1:2", "-n", 16, "--every", 8],
    "ship": ["programs/ship.s", "-c", "many_full", "-N", 1, "-n", 60, "--params", "programs/ship.cfg", "--every", 20],
    "overflow": ["tests/everywhere/overflow.ode", "-c", "many_full", "-N", 30, "--spread", "a=1:1e6", "-n", 40, "--every", 20, "--allow-failures"],
    "almost 2^-126": ["tests/everywhere/edge.s", "-c", "many_full", "-N", 24, "-n", 3, "--set", "x=0"],
    "almost 2^-126, of neighbours": ["tests/everywhere/edge.ode", "-i", "euler", "-N", 24, "-n", 3],
    "below 2^-126, of neighbours": ["tests/everywhere/edge.ode", "-i", "euler", "-N", 24, "-n", 3, "--set", "q=1e-19"],
    "chain": ["--scene", "programs/world/chain.scene", "-n", 24, "--every", 12],
    "balls": ["--scene", "tests/everywhere/balls.scene", "-n", 30, "--every", 10],
}
OTHERS = {"arm64": "aarch64", "riscv64": "riscv64"}      # the triplet's first word, which qemu has, too


# Those that fit a configuration of fp3 board, whose cycles are others, not its bits; of the one for one object there is a netlist, too.
ON_BOARD = {"ship": "single", "lorenz": "many", "rigid body": "many", "overflow": "many", "almost 2^-126": "many"}
NETLIST = "single"

LIMIT = 300     # seconds for a run


class Failed(Exception):
    """A run that has no hash."""


class Machine:
    """A command, and the environment that it runs in."""

    def __init__(self, folder, command, cc=None):
        self.folder, self.command, self.cc = folder, [str(word) for word in command], cc

    def environment(self, fast):
        mine = {name: value for name, value in os.environ.items() if not name.startswith("FP3_")}
        return mine | {"FP3_CACHE_DIR": str(self.folder / "cache"), "FP3_FAST": fast} | ({"FP3_CC": self.cc} if self.cc else {})

    def run(self, scene, engine, fast="", threads=None, more=(), config=None):
        """The hash, and how it was executed."""
        found = self.folder / "found.csv"
        found.unlink(missing_ok=True)
        words = [config if config and before == "-c" else word for before, word in zip(["", *SCENES[scene]], SCENES[scene])]
        words += ["--engine", engine, *(["--threads", threads] if threads else []), "--output", found, *more]
        try:
            done = subprocess.run([*self.command, "run", *map(str, words)], cwd=ROOT, env=self.environment(fast), capture_output=True, text=True, timeout=LIMIT)
        except subprocess.TimeoutExpired as why:
            raise Failed(f"{scene}, {engine}: more than {LIMIT} s") from why
        if done.returncode or not found.exists():
            raise Failed(f"{scene}: exit code {done.returncode}: {(done.stderr.strip().splitlines() or ['no word'])[-1]}")
        said = [line for line in (done.stdout + done.stderr).splitlines() if re.match(r"flags |.*failed|object \d+ ", line)]
        if not any(line.startswith("flags") for line in said):
            raise Failed(f"{scene}: no line 'flags' in what fp3 said")
        how = re.search(r"; (native|interpreter) (\S+)", done.stdout)
        text = found.read_bytes() + "\n".join(said).encode()
        return hashlib.sha256(text).hexdigest()[:16], " ".join(how.groups()) if how else engine


def kinds_here():
    flags = set(re.search(r"^flags\s*:(.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)[1].split())
    return ["x86-64"] + ["x86-64-v3"] * ({"avx2", "fma"} <= flags) + ["x86-64-v4"] * ({"avx512f", "avx512dq", "avx512vl", "avx512bw"} <= flags)


def on_fast(machine, scene, kind, platform):
    """Native code by one thread and by two. Its kind is what was asked for, or the row would be another's."""
    for threads in (1, 2):
        found, how = machine.run(scene, "fast", kind, threads)
        if how != f"native {kind}":
            raise Failed(f"{scene}: executed by {how}, expected native {kind}")
        yield platform, f"{threads} thread{'s' * (threads > 1)}", found


def here(machine, scene, replays, netlist):
    yield "isa", "", machine.run(scene, "isa")[0]
    for kind in kinds_here():
        yield from on_fast(machine, scene, kind, kind)
    yield "interpreter", "", machine.run(scene, "fast", "interpreter")[0]
    log = machine.folder / "session"
    found, _ = machine.run(scene, "rtl", more=["--bus-log", log])
    yield "rtl-verilator", "", found
    if replays:
        yield "rtl-icarus", "replay", replay(scene, log, found, replays / f"replay_{config_of(scene)}.vvp")
    if scene in ON_BOARD:
        yield "board", ON_BOARD[scene], on_board(machine, scene)
    if netlist and ON_BOARD.get(scene) == NETLIST:
        found, _ = machine.run(scene, "rtl", more=["--bus-log", log], config=NETLIST)
        yield "netlist", f"ECP5, {NETLIST}", replay(scene, cleared(log), found, netlist)


def on_board(machine, scene):
    """The hardware with a serial line in front of it, which the command talks over."""
    board = subprocess.Popen([*machine.command, "board", "-c", ON_BOARD[scene]], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                             start_new_session=True)
    try:
        port = board.stdout.readline().strip()
        return machine.run(scene, "board", more=["--port", port], config=ON_BOARD[scene])[0]
    finally:
        os.killpg(board.pid, signal.SIGTERM)     # also what a script has started
        board.communicate()


def config_of(scene):
    words = SCENES[scene]
    return words[words.index("-c") + 1] if "-c" in words else "world"


def replay(scene, log, found, bench):
    """Icarus has what Verilator had, word for word, or this fails: then it has the same hash."""
    done = subprocess.run(["vvp", "-n", bench, f"+session={log}"], capture_output=True, text=True)
    if not done.stdout.startswith("PASS "):
        raise Failed(f"{scene}: Icarus: {(done.stdout.strip().splitlines() or ['no word'])[-1]}")
    return found


def cleared(log):
    """The session of one object, which writes 0 to its registers first: those of simulated hardware hold 0, those of a netlist anything.
    The hash of a run is that of all registers."""
    lines = log.read_text().splitlines()
    read = {int(line.split()[1], 16): int(line.split()[2], 16) for line in lines[:6]}
    objects, registers = 2 << (read[0x30] >> 24), read[0x04] & 0xff
    begin = next(i for i, line in enumerate(lines) if line.startswith("w "))
    lines[begin:begin] = [f"w {objects + 4 * i:08x} 00000000" for i in range(registers)]
    other = log.with_suffix(".cleared")
    other.write_text("\n".join(lines[:-1] + [f"e {len(lines) - 1:08x} 00000000"]) + "\n")
    return other


def elsewhere(machine, scene, platform, kind):
    yield platform, "isa", machine.run(scene, "isa")[0]
    for name, variant, found in on_fast(machine, scene, kind, platform):
        yield name, f"native {kind}, {variant}", found
    yield platform, "interpreter", machine.run(scene, "fast", "interpreter")[0]


def machine_of(platform, folder):
    """None where `make everywhere` has not compiled for it, or there is no qemu."""
    family = OTHERS[platform]
    fp3, qemu = ROOT / f"build/everywhere/{family}-linux-gnu/bin/fp3", shutil.which(f"qemu-{family}")
    if not fp3.exists() or not qemu:
        return None
    return Machine(folder, [qemu, "-L", f"/usr/{family}-linux-gnu", fp3], f"{family}-linux-gnu-gcc")


LEAST = {"arm64": "armv8-a", "riscv64": "rv64gc"}


WASM = ROOT / "build/wasm"


def on_wasm(machine, scene):
    """It has no threads and makes no native code."""
    yield "wasm", "isa", machine.run(scene, "isa")[0]
    yield "wasm", "interpreter", machine.run(scene, "fast")[0]


def wasm(folder):
    """None where there is no compiler for it: make setup-playground."""
    fp3, python = WASM / "fp3.wasm", ROOT / ".venv/bin/python"
    return Machine(folder, [python, ROOT / "tools/wasi.py", fp3]) if fp3.exists() and python.exists() else None


def operations(machine, binary):
    """Hashes of each arithmetic operation, by tests/everywhere/operations.c."""
    done = subprocess.run([*machine.command[:-1], binary], capture_output=True, text=True)
    if done.returncode:
        raise Failed(f"operations: exit code {done.returncode}: {done.stderr.strip()}")
    return hashlib.sha256(done.stdout.encode()).hexdigest()[:16]


def measure(options, folder):
    rows, failed, begin = [], [], time.monotonic()
    machines = {"": Machine(folder, [options.fp3])}
    for platform in (*OTHERS, "wasm"):
        (folder / platform).mkdir(mode=0o700)
        machine = wasm(folder / platform) if platform == "wasm" else machine_of(platform, folder / platform)
        if machine:
            machines[platform] = machine
        elif options.all:
            failed.append(f"{platform}: not compiled for, or nothing here runs it: make everywhere does both")

    def keep(scene, made):
        try:
            for platform, variant, found in made:
                rows.append({"scene": scene, "platform": platform, "variant": variant, "hash": found})
        except Failed as why:
            failed.append(str(why))
    for scene in options.only or SCENES:
        print(f"everywhere: {scene}, {time.monotonic() - begin:.0f} s so far", file=sys.stderr)
        for platform, machine in machines.items():
            keep(scene, on_wasm(machine, scene) if platform == "wasm" else
                 elsewhere(machine, scene, platform, LEAST[platform]) if platform else here(machine, scene, options.replays, options.netlist))
    for platform, machine in machines.items() if not options.only else ():
        binary = (options.fp3.parent.parent / "tests/operations" if not platform else WASM / "operations.wasm" if platform == "wasm" else
                  ROOT / f"build/everywhere/{OTHERS[platform]}-linux-gnu/tests/operations")
        keep("operations", ((platform or "isa", "isa" if platform else "", operations(machine, binary)) for _ in (0,)))
    return rows, failed


def differing(rows):
    wanted = {row["scene"]: row["hash"] for row in rows if row["platform"] == "isa"}
    return [row for row in rows if row["hash"] != wanted.get(row["scene"])]


# ---- the page ---------------------------------------------------------------------------------------

HEAD = """<!-- Generated by tools/pages.py (make report PAGES=everywhere): do not edit. -->
# The same bits everywhere

*Measured, for everyone.*

`make everywhere` runs the scenes below on everything that can execute a program: all that a run records, its flags and its failures are one
hash. {machines}

{evidence}

| platform | what it is |
|---|---|
| `isa` | the simulator of the instruction set, in C |
| `x86-64`, `x86-64-v3`, `x86-64-v4` | engine `fast`, native code for these kinds of processor, with one thread and with two |
| `interpreter` | engine `fast` without a compiler |
| `arm64`, `riscv64` | the library compiled for these machines, under qemu-user: `isa`, `fast` by native code of the compiler there (NEON on arm64), with one thread and with two, and interpreted |
| `wasm` | the command compiled for [WebAssembly](playground.md), as it runs in browsers, under wasmtime: `isa` and `fast`, interpreted. It has one rounding and no flags: `sw/base/fpu_soft.h` finds them |
| `rtl-verilator` | the hardware under Verilator |
| `rtl-icarus` | the same session, replayed under Icarus Verilog: every word that was read is compared |
| `netlist` | ... and what yosys makes of configuration `single` for an ECP5, before place and route: LUTs, block RAMs and multipliers, likewise |
| `board` | a board with a serial line, simulated by `fp3 board`, for the scenes that fit configuration `single` or `many` |

`operations` is each arithmetic operation in all four arithmetics, on {count:,} operands that are hard to get right: subnormal numbers, ties, NaNs, the
ends of each range. ARM detects tininess before rounding, FP3 and the other machines after it: the scenes *almost 2^-126* are there for that.

A cell has the first 8 digits of the hash; all runs of a scene on a platform have it. A dash means that the platform has no room for the scene, or, in the row
`operations`, that it is a program in C.

"""
TAIL = """
## What the bits of a host depend on
Equations are executed by FP3's own arithmetic. What a host computes in double before a run, constants of a model such as `exp(-k)` and what
`params` are rounded to, goes through the C library: its functions may differ between versions by one unit of a double, which is one of FP32 in 2 of 10^9
cases. Constants that a model needs to the bit can be given as numbers.

Worlds of rigid bodies have [hashes of their own](bodies_results.md), on these machines too.

Not tried: macOS and Windows. Of POSIX the library and the command use threads, `dlopen`, `posix_spawn` for a
compiler, `open_memstream`, `flock`, `mkdtemp`, `realpath`, `uselocale` and `SIGXFSZ`; of glibc `secure_getenv`.
"""


def page(data):
    rows = data["rows"]
    platforms = list(dict.fromkeys(row["platform"] for row in rows))
    lines = ["| scene | " + " | ".join(platforms) + " |", "|---" * (len(platforms) + 1) + "|"]
    for scene in dict.fromkeys(row["scene"] for row in rows):
        cells = []
        for platform in platforms:
            found = sorted({row["hash"] for row in rows if (row["scene"], row["platform"]) == (scene, platform)})
            cells.append(" ".join(f"`{one[:8]}`" for one in found) or "–")
        lines.append(f"| {scene} | " + " | ".join(cells) + " |")
    runs = f"{len(rows)} runs, {len(differing(rows))} of which differ from `isa`."
    return HEAD.format(machines=runs, evidence="\n".join(evidence("everywhere")), count=data["about"]["operands"]) + "\n".join(lines) + "\n" + TAIL


OPERANDS = 38 ** 3 + 60000      # for each operation and arithmetic: tests/everywhere/operations.c


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fp3", type=pathlib.Path, default=ROOT / "build/bin/fp3")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/results/everywhere.json")
    parser.add_argument("--replays", type=pathlib.Path, help="benches for Icarus; without it rtl-icarus is left out")
    parser.add_argument("--netlist", type=pathlib.Path, help="a bench of tools/netlist.sh; without it netlist is left out")
    parser.add_argument("--only", nargs="+", choices=SCENES, metavar="SCENE", help="these scenes")
    parser.add_argument("--all", action="store_true", help="fail if a platform cannot run")
    options = parser.parse_args()
    options.fp3 = options.fp3.resolve()
    with tempfile.TemporaryDirectory() as folder:
        rows, failed = measure(options, pathlib.Path(folder))
    off = differing(rows)
    about = {"revision": revision(), "date": datetime.date.today().isoformat(), "operands": OPERANDS}
    write(options.output, json.dumps({"about": about, "rows": rows, "failed": failed}, indent=1) + "\n")
    for row in off:
        print(f"everywhere: {row['scene']} on {row['platform']} {row['variant']}: {row['hash']}, not that of isa", file=sys.stderr)
    for why in failed:
        print(f"everywhere: {why}", file=sys.stderr)
    print(f"{len(rows)} runs, {len(off)} with another hash, {len(failed)} failed: {options.output}")
    return 1 if off or failed else 0


if __name__ == "__main__":
    sys.exit(main())

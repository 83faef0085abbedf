"""A configuration that isa/configs.toml does not have: its sources, and what the engine rtl loads. For tools/random_configs.py and
tools/chip.py, which test it with what `make all` has built: only what knows which configurations there are is compiled anew.
"""

import pathlib
import subprocess

import tops
from fp3gen.read import load
from generate import outputs

ROOT = pathlib.Path(__file__).resolve().parents[2]
KEYS = (ROOT / "isa/configs.toml").read_text(encoding="utf-8").partition("[[config]]")[0]
CFLAGS = "-O1 -D_GNU_SOURCE -ffp-contract=off -w".split()
LIBS = "-lgsl -lgslcblas -lconfig -lz -ldl -lm".split()


class Failed(Exception):
    """A configuration that does not do what it should, or cannot be built."""


def run(*command, timeout=600):
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True, timeout=timeout)
    if done.returncode:
        raise Failed(" ".join(str(x) for x in command) + f"\nended with {done.returncode}\n" + done.stdout + done.stderr)
    return done.stdout


def build(row, tree, made):
    """rtl/, isa/ and the generated files in `tree`, what the engine rtl loads, and own.o: linked before libfp3.a, its list of
    configurations is the one that counts. made: build/."""
    make_tree(row, tree)
    run("gcc", "-std=c11", *CFLAGS, *includes(tree), "-c", "-o", tree / "own.o", ROOT / "sw/machine/config.c")
    make_hardware(row["name"], tree, made)


def toml(row):
    def text(value):
        return f'"{value}"' if isinstance(value, str) else str(value)

    return KEYS + "[[config]]\n" + "".join(f"{key} = {text(value)}\n" for key, value in row.items())


def includes(tree):
    return [f"-I{path}" for path in (tree / "sw", ROOT / "sw/include", ROOT / "sw", ROOT / "sim")]


def make_tree(row, tree):
    """The project's rtl/, isa/, integrators and headers by links, configs.toml and the generated files anew."""
    headers = "sw/include/fp3"
    (tree / "isa").mkdir(parents=True)
    (tree / "rtl").mkdir()
    (tree / headers).mkdir(parents=True)
    for path in (ROOT / headers).glob("*.h"):
        (tree / headers / path.name).symlink_to(path)
    for path in ROOT.glob("rtl/*"):
        if path.name != "gen":
            (tree / "rtl" / path.name).symlink_to(path)
    for name in ("isa.toml", "registers.toml", "timing.toml"):
        (tree / "isa" / name).symlink_to(ROOT / "isa" / name)
    (tree / "programs").mkdir()
    (tree / "programs/integrators").symlink_to(ROOT / "programs/integrators")
    (tree / "isa/configs.toml").write_text(toml(row))
    for name, text in outputs(tree).items():
        path = tree / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)    # never through a link
        path.write_text(text)
    machine = load(tree)
    tops.write(machine.configs[0], machine, tree)


def verilator_root():
    return pathlib.Path(run("verilator", "--getenv", "VERILATOR_ROOT").strip()) / "include"


def make_hardware(name, tree, made):
    """What the rtl engine loads."""
    top, rtl = f"fp3_{name}", tree / "rtl"
    rooms = [word for room in sorted({path.parent for path in (ROOT / "rtl").glob("*/*.v")} - {ROOT / "rtl/gen"})
             for word in ("-y", rtl / room.name)]
    run("verilator", f"+incdir+{rtl}", f"+incdir+{rtl / 'gen'}", "-y", rtl, *rooms, "+libext+.v", "-DFP3_CHECK", "-DFP3_ZEROS", "-DFP3_TRACE",
        "-Wno-lint", "-Wno-fatal", "-O3", "--x-assign", "fast", "--x-initial", "unique", "--cc", "--prefix", f"V{top}",
        "--top-module", top, "--Mdir", tree / "cc", tree / f"{top}.v")
    # In one file, as Makefile has it: headers are read once, and what runs once is compiled as it stands.
    files = sorted((tree / "cc").glob("*.cpp"), key=lambda path: (path.name.endswith("Slow.cpp"), path.name))
    first = next(i for i, path in enumerate(files) if path.name.endswith("Slow.cpp"))
    lines = [f'#include "{path}"\n' for path in [ROOT / "sim/fp3_shim.cpp", *files]]
    lines.insert(1 + first, '#pragma GCC optimize ("O0")\n')
    (tree / "all.cc").write_text("".join(lines))
    include = verilator_root()
    run("g++", "-std=c++17", *CFLAGS, *includes(tree), f"-DFP3_CONFIG={name}", "-fPIC", "-shared", "-isystem", tree / "cc", "-isystem", include,
        "-isystem", include / "vltstd", "-o", tree / f"{top}.so", tree / "all.cc",
        made / "obj/verilator/verilated.o", made / "obj/verilator/verilated_threads.o")

"""What may kill a mutant. A rung is built once from the netlist of a design, then asked for one mutant after another.

    rung = Bench(design, "rounds", {"FP3_RTL": root / "rtl"})
    rung.build()
    rung.kills(0, folder)                # False, or the rung says nothing: the module without a mutant
    rung.kills(7, folder)                # True: something failed, or did not end
"""

import os
import resource
import subprocess

import simulate

from .netlist import Failed

PATIENCE = 6              # a mutant that takes so many times the processor time of none does not end


def spent():
    """Seconds of processor time of all programs so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Rung:
    """name: how the page calls it."""
    name = ""
    patience = None

    def __init__(self, design):
        self.design = design

    def start(self, folder):
        """Builds it, and asks it for the module as it is: this must pass, and says how long a run takes."""
        self.build()
        start = spent()
        passed, said = self.run(0, folder)
        if not passed:
            raise Failed(f"{self.design.top}: {self.name} fails without a mutant: {said.strip()[-800:]}")
        self.patience = round(PATIENCE * (spent() - start)) + 5

    def kills(self, number, folder):
        return not self.run(number, folder)[0]

    def active(self, number, folder):
        """Where the simulator runs, it finds the number of the mutant."""
        (folder / "mutant").write_text(f"{number:x}\n")


class Bench(Rung):
    """A bench of cocotb under Icarus, of tests/modules."""
    name = "bench"

    def __init__(self, design, bench, told, root):
        super().__init__(design)
        self.module, self.told, self.root = root / f"tests/modules/{bench}_bench.py", told, root

    def build(self):
        """The bench asks its module for parameters, which the netlist has no more: those of the source, as Icarus knows them."""
        design = self.design
        chosen = [f"-Pfp3_{design.top.removeprefix('fp3_')}.{name}={value}" for name, value in design.parameters.items()]
        source = next(path for path in self.root.glob(f"rtl/**/{design.top}.v") if "fpga" not in path.parts)
        folder = design.folder / "constants"
        folder.mkdir(exist_ok=True)
        vvp = simulate.compiled(self.root, folder, design.top, source, *chosen, "-y", "rtl/board")
        names = folder / "names.txt"
        done = simulate.cocotb(self.root, folder, vvp, self.root / "tests/modules/constants.py", FP3_NAMES=names)
        if not done.passed:
            raise Failed(f"{design.top}: its constants cannot be read: {done.said[-800:]}")
        design.write("bench.v", names.read_text())
        self.vvp = design.folder / f"{design.top}.vvp"
        succeeds("iverilog", "-g2012", "-s", design.top, "-o", self.vvp, design.folder / "bench.v")

    def run(self, number, folder):
        self.active(number, folder)
        done = simulate.cocotb(self.root, folder, self.vvp, self.module, whole=False, seconds=self.patience,
                               FP3_ISA=self.root / "isa/isa.toml", FP3_RTL=self.root / "rtl", **self.told)
        return done.passed, done.said


class Program(Rung):
    """A program in C that compares the netlist under Verilator with a model. `name`: also that of the program."""

    def __init__(self, design, made, name, *arguments):
        super().__init__(design)
        self.made, self.name, self.arguments = made, name, arguments

    def run(self, number, folder):
        self.active(number, folder)
        command = [str(word) for word in (self.program, *self.arguments)]
        limit = ["prlimit", f"--cpu={self.patience}"] if self.patience else []
        done = subprocess.run([*limit, *command], cwd=folder, env={**os.environ, "FP3_RTL_DIR": str(self.design.folder)}, capture_output=True,
                              text=True, errors="replace")
        return done.returncode == 0, done.stdout + done.stderr

    def shim(self, name, *options):
        """The netlist in C++ and what connects it with C, as one file: the shortest way. `options` compile it."""
        design, top = self.design, self.design.top
        succeeds("verilator", "--cc", "-Wno-lint", "-Wno-fatal", "-O3", "--x-assign", "fast", "--prefix", f"V{top}", "--top-module", top,
                 "--Mdir", design.folder / "cc", design.folder / "netlist.v", cwd=design.root)
        files = sorted((design.folder / "cc").glob("*.cpp"), key=lambda path: (path.name.endswith("Slow.cpp"), path.name))
        lines = [f'#include "{path}"\n' for path in [design.root / "sim" / name, *files]]
        lines.insert(1 + next(i for i, path in enumerate(files) if path.name.endswith("Slow.cpp")), '#pragma GCC optimize ("O0")\n')
        (design.folder / "all.cc").write_text("".join(lines))
        include = succeeds("verilator", "--getenv", "VERILATOR_ROOT").strip() + "/include"
        succeeds("g++", "-std=c++17", "-O1", "-w", "-fPIC", *options[:1], "-I", design.root / "sim", "-I", design.root / "sw/include", "-I", design.root / "sw",
                 "-isystem", design.folder / "cc", "-isystem", include, "-isystem", f"{include}/vltstd", design.folder / "all.cc", *options[1:])


class Units(Program):
    """tests/fp and tests/lns: arithmetic alone. The design's top is their bench of Verilog."""

    def build(self):
        self.program = self.design.folder / self.name
        room = "fp" if self.design.top == "fp_bench" else "lns"
        self.shim(f"{self.design.top}_shim.cpp", "-DNDEBUG", self.made / f"obj/tests/{room}/{self.name}.o", self.made / "lib/libfp3.a",
                  self.made / "obj/verilator/verilated.o", self.made / "obj/verilator/verilated_threads.o", "-o", self.program,
                  "-lmpfr", "-lgmp", "-lgsl", "-lgslcblas", "-lm", "-pthread")


class Cosim(Program):
    """tests/cosim: a whole processor against the engine isa. The design's top is that of a named configuration."""

    def build(self):
        """What the engine rtl loads; several programs of one design share it."""
        self.program = self.made / "tests" / self.name
        library = self.design.folder / f"{self.design.top}.so"
        if not library.exists():
            self.shim("fp3_shim.cpp", f"-DFP3_CONFIG={self.design.top.removeprefix('fp3_')}", "-shared", self.made / "obj/verilator/verilated.o",
                      self.made / "obj/verilator/verilated_threads.o", "-o", library)


def succeeds(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode:
        raise Failed(f"{command[0]} failed: {(done.stderr or done.stdout).strip()[-800:]}")
    return done.stdout

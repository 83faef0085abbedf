#!/usr/bin/env python3
"""A SoC of LiteX with a VexRiscv and FP3 on one bus, its program, and the whole of it simulated: `make soc`.

    .venv/bin/python examples/litex/soc.py                          build/soc/
    .venv/bin/python examples/litex/soc.py --config many --ships 8
    .venv/bin/python examples/litex/soc.py --program scenes
    .venv/bin/python examples/litex/soc.py --program memory --sdram M12L64322A

The program, ships.c, prints the final states of its ships; they have to be those of `fp3 run -e isa`, bit for bit. The program scenes.c
prints a hash of all states of each of its scenes; the engine fast has to have the same. So it is with memory.c, whose objects are in an SDRAM:
LiteDRAM controls it, and LiteDRAM's model is the chip.
"""

import argparse
import contextlib
import inspect
import logging
import os
import pathlib
import re
import shutil
import subprocess
import sys

try:
    import litedram.modules
    import litex
    from litedram.init import get_sdram_phy_c_header
    from litedram.phy.model import SDRAMPHYModel, sdram_module_nphases
    from litex.build.generic_platform import Pins, Subsignal
    from litex.build.io import CRG
    from litex.build.sim import SimPlatform
    from litex.soc.integration import export
    from litex.soc.integration.soc_core import SoCCore, get_mem_data
except ImportError as error:
    sys.exit(f"soc.py: {error}: run make setup-soc, and this with .venv/bin/python")

import memory_data
import scenes_data
from fp3_litex import ROOT, add_fp3

HERE = pathlib.Path(__file__).resolve().parent
SOFTWARE = pathlib.Path(litex.__file__).parent / "soc/software"
ORIGIN = 0x9000_0000          # VexRiscv caches nothing from 0x8000_0000 on
MAIN_RAM = 0x4000_0000        # LiteX has the SDRAM of a VexRiscv here
MEMORY = {"ships": (0x4000, 0x1000), "scenes": (0x10000, 0x4000), "memory": (0x10000, 0x1000)}   # bytes of ROM and of RAM
LIMIT = {"ships": 2_000_000, "scenes": 60_000_000, "memory": 200_000_000}                        # cycles that are simulated
CONFIG = {"ships": "single", "scenes": scenes_data.CONFIG, "memory": memory_data.CONFIG}
CLOCK = 100_000_000
STEPS = 1000
SDRAMS = {"MT48LC16M16": 16, "M12L64322A": 32, "MT41K128M16": 16}   # chips, as on a ULX3S, a Colorlight i5 and an Arty A7, and their bits of data
SDRAM = next(iter(SDRAMS))
SERIAL = [Subsignal(f"{way}_{name}", Pins(width)) for way in ("source", "sink") for name, width in (("valid", 1), ("ready", 1), ("data", 8))]


class Failed(Exception):
    pass


def chip_of(sdram):
    kind = getattr(litedram.modules, sdram)
    return kind(CLOCK, f"1:{sdram_module_nphases[kind.memtype]}")


class SoC(SoCCore):
    """contents: words that the SDRAM holds at the start; None: there is no SDRAM."""

    def __init__(self, config, bus, program="ships", sdram=SDRAM, contents=None):
        platform = SimPlatform("SIM", [("sys_clk", 0, Pins(1)), ("serial", 0, *SERIAL)])
        rom, sram = MEMORY[program]
        super().__init__(platform, clk_freq=CLOCK, bus_standard=bus, bus_timeout=10_000, cpu_type="vexriscv", uart_name="sim",
                         integrated_rom_size=rom, integrated_sram_size=sram, timer_uptime=contents is not None)
        self.crg = CRG(platform.request("sys_clk"))
        if contents is not None:
            chip = chip_of(sdram)
            self.sdrphy = SDRAMPHYModel(chip, data_width=SDRAMS[sdram], clk_freq=CLOCK, init=contents)
            self.add_sdram("sdram", phy=self.sdrphy, module=chip, l2_cache_size=0)
        add_fp3(self, config=config, origin=ORIGIN)


def start(*command, **options):
    """What a command prints."""
    command = [str(part) for part in command]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode:
        raise Failed(f"{' '.join(command[:3])} ..: exit {done.returncode}\n{done.stdout}")
    return done.stdout


def write_headers(soc, folder):
    generated = folder / "generated"
    generated.mkdir(parents=True, exist_ok=True)
    csr = export.get_csr_header(soc.csr_regions, soc.constants, csr_base=soc.mem_regions["csr"].origin)
    for name, text in (("mem.h", export.get_mem_header(soc.mem_regions)), ("soc.h", export.get_soc_header(soc.constants)), ("csr.h", csr)):
        (generated / name).write_text(text)
    if hasattr(soc, "sdram"):
        settings = soc.sdram.controller.settings
        (generated / "sdram_phy.h").write_text(str(get_sdram_phy_c_header(settings.phy, settings.timing, settings.geom)))
    (folder / "regions.ld").write_text(export.get_linker_regions(soc.mem_regions))


def compile_program(soc, folder, fp3, program, ships):
    """The contents of the ROM."""
    sources = [HERE / "start.S", HERE / f"{program}.c", HERE / "machine.c", ROOT / "sw/bare/fp3_bare.c"]
    if program == "ships":
        start(fp3, "asm", ROOT / "programs/ship.s", "-o", folder / "ship.fp3")
        start(fp3, "dis", folder / "ship.fp3", "--header", folder / "ship.h")
    elif program == "scenes":
        scenes_data.make(fp3, folder)
        sources.append(ROOT / "sw/bare/fp3_bare_neighbours.c")
    else:
        sources.append(ROOT / "sw/bare/fp3_bare_moves.c")
    # Warnings in LiteX's headers are LiteX's business.
    start("clang", "--target=riscv32-unknown-elf", "-march=rv32im", "-mabi=ilp32", "-mno-relax", "-ffreestanding", "-nostdlib", "-std=gnu11", "-Os",
          "-Wall", "-Wextra", "-Werror", f"-DSHIPS={ships}", f"-DSTEPS={STEPS}", f"-I{HERE}", f"-I{ROOT / 'sw'}", f"-I{ROOT / 'sw/bare'}",
          f"-I{ROOT / 'sw/include'}", f"-I{folder}", "-isystem", SOFTWARE / "include", "-isystem", pathlib.Path(inspect.getfile(type(soc.cpu))).parent, "-isystem", folder, "-fuse-ld=lld",
          f"-Wl,-T,{HERE / 'ships.ld'},-L,{folder},--oformat=binary", *sources, "-o", folder / f"{program}.bin")
    return get_mem_data(str(folder / f"{program}.bin"), endianness="little")


def verilate(soc, folder):
    """The simulated SoC. Files of LiteX and VexRiscv are not ours to warn about; `make lint` looks at FP3's."""
    sources = [name for name, *_ in soc.platform.sources] + ["soc.v"]
    includes = [f"-I{path}" for path in soc.platform.verilog_include_paths]
    start("verilator", "--cc", "--exe", "--build", "-O3", "-Wno-fatal", "-Wno-lint", "-Wno-style", "-DFP3_CHECK", "--prefix", "Vsoc",
          "--top-module", "soc", "--Mdir", "verilated", "-CFLAGS", "-O1", "-o", "soc", *includes, *sources, HERE / "soc_main.cpp", cwd=folder,
          env={**os.environ, "OBJCACHE": shutil.which("ccache") or ""})
    return folder / "verilated/soc"


def simulate(program, folder, limit):
    """What came out of the UART. The memories of the SoC are files in its folder."""
    done = subprocess.run([program, str(limit)], cwd=folder, capture_output=True, text=True)
    print(done.stdout + done.stderr, end="")
    if done.returncode or not done.stdout.endswith("done\n"):
        raise Failed("the program did not say that it is done")
    return done.stdout


def expected_scenes(fp3, folder):
    """The hashes of what the engine fast has, as the program prints them."""
    return [f"{name} {scenes_data.hash_of(scenes_data.expected(fp3, folder, name))}" for name in scenes_data.SCENES]


def expected_ships(fp3, config, ships):
    """The states by the engine isa, as the program prints them."""
    spread = ["--spread", f"v=0:{ships - 1}"] if ships > 1 else []
    text = start(fp3, "run", ROOT / "programs/ship.s", "-e", "isa", "-c", config, "-N", ships, "-n", STEPS, "--params", ROOT / "programs/ship.cfg",
                 "--all", *spread)
    states = [re.findall(rf"^{name} .* 0x([0-9a-f]{{8}}) ", text, re.M) for name in "vs"]
    return [f"v {v} s {s}" for v, s in zip(*states, strict=True)]


def judge_memory(row, got, sdram):
    """What came out has the hashes of the engine fast and the addresses that are refused. Returns a text of what LiteDRAM gave."""
    end = memory_end(sdram)
    name = row["scene"].removesuffix(".scene")
    want = [f"{name} begins {row['begins']}", f"{name} ends {row['ends']}", f"list outside {end:08x}", f"store outside {end:08x}"]
    cycles = {what: int(number) for what, number in re.findall(r"^(list|load|store) (\d+) cycles$", "\n".join(got), re.M)}
    if [line for line in got if not line.endswith(" cycles")] != want or len(cycles) != 3:
        raise Failed("the engine fast has other bits, or addresses outside of memory are not told:\n" + "\n".join(want))
    step = cycles["list"] / row["objects"] / row["steps"]
    to, back = (memory_data.MEASURED / cycles[what] for what in ("load", "store"))
    return (f"{row['objects']} objects in {row['chunks']} chunks, {row['steps']} steps: {step:.1f} cycles for a step of an object, "
            f"{step / row['in_store']:.3f} times as many as in the store\n{sdram}: {to:.3f} words a cycle to FP3, {back:.3f} from it")


def memory_end(sdram):
    chip = chip_of(sdram)
    return MAIN_RAM + chip.nbanks * chip.nrows * chip.ncols * SDRAMS[sdram] // 8


def run(args):
    folder = args.output.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    row = contents = None
    if args.program == "memory":
        row = memory_data.make(args.alone, folder, args.scene, args.steps, args.roam, MAIN_RAM, memory_end(args.sdram))
        contents = memory_data.words_of(folder / "memory.image")
    soc = SoC(args.config, args.bus, args.program, args.sdram, contents)
    soc.finalize()
    write_headers(soc, folder)
    soc.init_rom(name="rom", contents=compile_program(soc, folder, args.fp3, args.program, args.ships))
    with contextlib.chdir(folder):
        soc.platform.get_verilog(soc, name="soc").write("soc.v")
    got = simulate(verilate(soc, folder), folder, LIMIT[args.program]).splitlines()[:-1]
    if row:
        print(judge_memory(row, got, args.sdram))
        what, engine = row["scene"], "fast"
    else:
        is_ships = args.program == "ships"
        engine = "isa" if is_ships else "fast"
        want = expected_ships(args.fp3, args.config, args.ships) if is_ships else expected_scenes(args.fp3, folder)
        if got != want:
            raise Failed(f"the engine {engine} has other bits:\n" + "\n".join(want))
        what = f"{len(got)} ships, {STEPS} steps" if is_ships else ", ".join(scenes_data.SCENES)
    print(f"{args.config} on {args.bus}: {what}: the bits of the engine {engine}")


def main():
    parser = argparse.ArgumentParser(description="a SoC with FP3, simulated")
    parser.add_argument("--program", choices=list(MEMORY), default="ships", help="that the processor runs (ships)")
    parser.add_argument("--config", help="of FP3 (single; of scenes world, of memory world_memory, and no other)")
    parser.add_argument("--ships", type=int, choices=range(1, 9), default=1, help="that fly, 1 to 8 (1)")
    parser.add_argument("--bus", choices=["wishbone", "axi-lite"], default="wishbone", help="of the SoC (wishbone)")
    parser.add_argument("--sdram", choices=list(SDRAMS), default=SDRAM, help="the chip, for memory (%(default)s)")
    parser.add_argument("--steps", type=int, default=10, help="that the objects in memory make (%(default)s)")
    parser.add_argument("--scene", type=pathlib.Path, default=memory_data.SCENE, help="of the objects in memory (the gallery's flag)")
    parser.add_argument("--roam", type=float, help="how far these may go, if they see those that are near")
    parser.add_argument("--alone", type=pathlib.Path, default=ROOT / "build/bench/alone", help="the command that knows what memory has to be (build/bench/alone)")
    parser.add_argument("--fp3", type=pathlib.Path, default=ROOT / "build/bin/fp3", help="the command (build/bin/fp3)")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/soc", help="the folder (build/soc)")
    args = parser.parse_args()
    args.config = args.config or CONFIG[args.program]
    if args.program != "ships" and args.config != CONFIG[args.program]:
        parser.error(f"argument --config: objects that see each other: expected '{CONFIG[args.program]}', found '{args.config}'")
    logging.disable(logging.WARNING)
    try:
        run(args)
    except (Failed, OSError, ValueError) as error:
        sys.exit(f"soc.py: {error}")


if __name__ == "__main__":
    main()

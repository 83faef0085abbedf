"""The example SoC with something broken: broken.py WHAT FP3 FOLDER [OPTIONS]; WHAT is a function below, OPTIONS are those of soc.py."""

import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples/litex"))

import fp3_litex
import soc
from migen import Signal

sane_headers, sane_compile = soc.write_headers, soc.compile_program


def replace(path, old, new):
    text = path.read_text()
    assert re.search(old, text), (path, old)
    path.write_text(re.sub(old, new, text))


def address():
    """The software has another place of FP3 than the hardware."""
    def write_headers(chip, folder):
        sane_headers(chip, folder)
        replace(folder / "generated/mem.h", "0x90000000", "0xa0000000")
    soc.write_headers = write_headers


def interrupt():
    """The wire ends in nothing."""
    def add_fp3(*args, **options):
        fp3_litex.add_fp3(*args, **options).ev.irq = Signal()
    soc.add_fp3 = add_fp3


def hole():
    """FP3 gets two bits of the address less than its window has: a write to an object is one to a register."""
    def get_verilog(chip, *args, **options):
        verilog = sane_verilog(chip, *args, **options)
        verilog.main_source = re.sub(r"(s_axi_a[wr]addr +\()(\w+)\[17:0\]", r"\1{2'd0, \2[15:0]}", verilog.main_source)
        return verilog
    sane_verilog, soc.SimPlatform.get_verilog = soc.SimPlatform.get_verilog, get_verilog


def program():
    """The program makes a step less."""
    def start(*command, **options):
        return sane_start(*[f"-DSTEPS={soc.STEPS - 1}" if word == f"-DSTEPS={soc.STEPS}" else word for word in command], **options)
    sane_start, soc.start = soc.start, start


def cache():
    """The processor keeps in its cache what memory had before. Of this scene all states fit in it."""
    soc.memory_data.SCENE = soc.ROOT / "programs/world/rope.scene"
    def write_headers(chip, folder):
        sane_headers(chip, folder)
        replace(folder / "generated/soc.h", "#define CONFIG_CPU_HAS_DCACHE", "// ")
    soc.write_headers = write_headers


def bounds():
    """The SDRAM takes each address, as LiteDRAM does: the low bits count."""
    class Bounds(fp3_litex.Bounds):
        def __init__(self, origin, size):
            super().__init__(0, 1 << 31)
    fp3_litex.Bounds = Bounds


def sdram():
    """FP3 has a port to memory, and there is no SDRAM."""
    soc.memory_data.words_of = lambda image: None


def l2():
    """LiteX's cache is between the processor and the SDRAM."""
    sane_sdram = soc.SoC.add_sdram
    soc.SoC.add_sdram = lambda chip, *args, **options: sane_sdram(chip, *args, **{**options, "l2_cache_size": 8192})


def silence():
    """The processor does nothing."""
    def compile_program(*args):
        return [0x6f] * len(sane_compile(*args))  # j .
    soc.compile_program = compile_program


globals()[sys.argv[1]]()
sys.argv = ["soc.py", "--fp3", sys.argv[2], "--output", *sys.argv[3:]]
soc.main()

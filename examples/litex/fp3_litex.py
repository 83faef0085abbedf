"""FP3 in a LiteX SoC: the sources of a configuration, its AXI4-Lite port, its interrupt.

    from fp3_litex import add_fp3
    add_fp3(soc, config="many", origin=0x9000_0000)

The SoC's headers have FP3_BASE and FP3_SIZE (mem.h) and FP3_INTERRUPT (soc.h) then; sw/bare is the driver.
"""

import pathlib
import re
import subprocess
import sys

from litex.gen import LiteXModule
from migen import ClockSignal, Instance, ResetSignal, Signal
from litex.soc.integration.soc import SoCRegion
from litex.soc.interconnect import axi
from litex.soc.interconnect.csr import CSRStatus

ROOT = pathlib.Path(__file__).resolve().parents[2]
RTL = ROOT / "rtl"


class Interrupt:
    """What LiteX asks of a module's `ev`. FP3's own register `interrupt` enables and shows it, so LiteX's events are not needed."""

    def __init__(self):
        self.irq = Signal()


class FP3(LiteXModule):
    """bus: AXI4-Lite, which answers the low `size` bytes; ev.irq: high while a run has ended and its interrupt is enabled.

    CSR errors: how many transfers were answered with SLVERR. VexRiscv takes no notice of errors on its data bus.
    """

    def __init__(self, platform, config="single"):
        made = subprocess.run([sys.executable, ROOT / "tools/tops.py", config], capture_output=True, text=True)
        if made.returncode:
            raise ValueError(made.stderr.strip())
        top = pathlib.Path(made.stdout.strip())
        text = top.read_text()
        width = int(re.search(r"\[(\d+):0\] s_axi_awaddr", text)[1]) + 1
        self.size = 1 << width
        self.bus = bus = axi.AXILiteInterface(data_width=32, address_width=32)
        self.ev = Interrupt()
        self.errors = CSRStatus(32)
        refused = [channel.valid & channel.ready & (channel.resp != axi.RESP_OKAY) for channel in (bus.b, bus.r)]
        self.sync += self.errors.status.eq(self.errors.status + refused[0] + refused[1])
        self.specials += Instance(
            f"fp3_{config}",
            i_s_axi_aclk=ClockSignal("sys"), i_s_axi_aresetn=~ResetSignal("sys"),
            i_s_axi_awaddr=bus.aw.addr[:width], i_s_axi_awprot=0, i_s_axi_awvalid=bus.aw.valid, o_s_axi_awready=bus.aw.ready,
            i_s_axi_wdata=bus.w.data, i_s_axi_wstrb=bus.w.strb, i_s_axi_wvalid=bus.w.valid, o_s_axi_wready=bus.w.ready,
            o_s_axi_bresp=bus.b.resp, o_s_axi_bvalid=bus.b.valid, i_s_axi_bready=bus.b.ready,
            i_s_axi_araddr=bus.ar.addr[:width], i_s_axi_arprot=0, i_s_axi_arvalid=bus.ar.valid, o_s_axi_arready=bus.ar.ready,
            o_s_axi_rdata=bus.r.data, o_s_axi_rresp=bus.r.resp, o_s_axi_rvalid=bus.r.valid, i_s_axi_rready=bus.r.ready,
            o_irq=self.ev.irq)
        platform.add_verilog_include_path(str(RTL))
        for line in (RTL / "gen/files.f").read_text().splitlines():
            if line.startswith("rtl/"):
                platform.add_source(str(ROOT / line))
        platform.add_source(str(top))


def add_fp3(soc, name="fp3", config="single", origin=None):
    """origin: where its window begins, a multiple of its size, where the processor does not cache (io_regions); None: LiteX chooses."""
    fp3 = FP3(soc.platform, config)
    soc.add_module(name, fp3)
    soc.bus.add_slave(name, fp3.bus, SoCRegion(origin=origin, size=fp3.size, cached=False))
    if soc.irq.enabled:
        soc.irq.add(name, use_loc_if_exists=True)
    return fp3

"""FP3 in a LiteX SoC: the sources of a configuration, its AXI4-Lite port, its interrupt, its port to an SDRAM.

    from fp3_litex import add_fp3
    add_fp3(soc, config="many", origin=0x9000_0000)

A configuration with the key `master` has a port to memory. It is connected to the SoC's SDRAM, which soc.add_sdram() must have added before,
without its L2 cache: l2_cache_size=0.

The SoC's headers have FP3_BASE and FP3_SIZE (mem.h) and FP3_INTERRUPT (soc.h) then; sw/bare is the driver.
"""

import pathlib
import re
import subprocess
import sys

from litex.gen import LiteXModule
from migen import FSM, ClockSignal, If, Instance, NextState, NextValue, ResetSignal, Signal, log2_int
from litex.soc.integration.soc import SoCRegion
from litex.soc.interconnect import axi
from litex.soc.interconnect.csr import CSRStatus

ROOT = pathlib.Path(__file__).resolve().parents[2]
RTL = ROOT / "rtl"


class Interrupt:
    """What LiteX asks of a module's `ev`. FP3's own register `interrupt` enables and shows it, so LiteX's events are not needed."""

    def __init__(self):
        self.irq = Signal()


def memory_bus():
    """AXI4 as the port to memory has it."""
    return axi.AXIInterface(data_width=32, address_width=32, id_width=1)


def memory_pins(bus):
    """The ports of FP3's instance."""
    request = "id addr len size burst lock cache prot valid"
    out = {"aw": request, "ar": request, "w": "data strb last valid", "b": "ready", "r": "ready"}
    into = {"aw": "ready", "ar": "ready", "w": "ready", "b": "id resp valid", "r": "id data resp last valid"}
    return {f"{way}_m_axi_{channel}{name}": getattr(getattr(bus, channel), name)
            for way, channels in (("o", out), ("i", into)) for channel, names in channels.items() for name in names.split()}


class Bounds(LiteXModule):
    """Between a master of AXI and a memory that has `size` bytes from `origin` on: answers what is outside with DECERR.

    LiteDRAM looks at the low bits of an address only, so a wrong address would be another word's. A burst is inside or outside as a whole,
    responses are in order, all have ID 0, and data of a write come after its address: all of which FP3 promises.
    """

    def __init__(self, origin, size):
        self.master, self.memory = memory_bus(), memory_bus()
        self.read = self.refuse(origin, size, self.master.ar, self.memory.ar, self.memory.r, reads=True)
        self.write = self.refuse(origin, size, self.master.aw, self.memory.aw, self.memory.b, reads=False)

    def refuse(self, origin, size, address, inside, answer, reads):
        """A burst that is outside waits until memory has answered all before it."""
        master, memory = self.master, self.memory
        under_way, left, last = Signal(8), Signal(8), Signal()
        outside = address.addr[log2_int(size):] != origin >> log2_int(size)
        self.comb += last.eq(answer.valid & answer.ready & (answer.last if reads else 1))
        self.sync += under_way.eq(under_way + (inside.valid & inside.ready) - last)
        fsm = FSM(reset_state="PASS")
        fsm.act("PASS",
                memory.r.connect(master.r) if reads else [*master.w.connect(memory.w), *memory.b.connect(master.b)],
                If(~outside, address.connect(inside))
                .Elif(address.valid & (under_way == 0), address.ready.eq(1), NextValue(left, address.len), NextState("REFUSE" if reads else "DROP")))
        if reads:
            fsm.act("REFUSE",
                    master.r.valid.eq(1), master.r.resp.eq(axi.RESP_DECERR), master.r.last.eq(left == 0),
                    If(master.r.ready, NextValue(left, left - 1), If(left == 0, NextState("PASS"))))
        else:
            fsm.act("DROP", master.w.ready.eq(1), If(master.w.valid & master.w.last, NextState("REFUSE")))
            fsm.act("REFUSE", master.b.valid.eq(1), master.b.resp.eq(axi.RESP_DECERR), If(master.b.ready, NextState("PASS")))
        return fsm


class FP3(LiteXModule):
    """bus: AXI4-Lite, which answers the low `size` bytes; ev.irq: high while a run has ended and its interrupt is enabled.

    memory: AXI4, as a master; None: the configuration has no such port.

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
        self.memory = memory_bus() if re.search(r"output +wire .*m_axi_awaddr", text) else None
        self.specials += Instance(
            f"fp3_{config}", **(memory_pins(self.memory) if self.memory else {}),
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


class Later(LiteXModule):
    """A gate before a port of LiteDRAM: no data of a write go through before their command.

    LiteDRAM's converter to a wider controller takes data at once. Its AXI bridge counts commands without data, and asks for nothing more when
    that number falls below 0.
    """

    def __init__(self, inner):
        from litedram.common import LiteDRAMNativePort
        self.port = port = LiteDRAMNativePort("both", inner.address_width, inner.data_width)
        owed = Signal(8)
        passes = owed != 0
        self.comb += [port.cmd.connect(inner.cmd), inner.rdata.connect(port.rdata), port.wdata.connect(inner.wdata, omit={"valid", "ready"}),
                      inner.wdata.valid.eq(port.wdata.valid & passes), port.wdata.ready.eq(inner.wdata.ready & passes)]
        self.sync += owed.eq(owed + (port.cmd.valid & port.cmd.ready & port.cmd.we) - (port.wdata.valid & port.wdata.ready))


def connect_memory(soc, name, fp3):
    """A port of the SDRAM's controller of its own: not over the bus of the SoC, which takes many cycles a word."""
    if not hasattr(soc, "sdram"):
        raise ValueError(f"{name} has a port to memory, and the SoC no SDRAM: call add_sdram() before add_fp3()")
    if hasattr(soc, "l2_cache"):
        raise ValueError(f"{name} has a port to memory, and the SDRAM a cache that does not see what is written there: add_sdram(.., l2_cache_size=0)")
    from litedram.frontend.axi import LiteDRAMAXI2Native
    region = soc.bus.regions["main_ram"]
    bounds = Bounds(region.origin, region.size)
    soc.add_module(f"{name}_bounds", bounds)
    soc.comb += axi.connect_axi(fp3.memory, bounds.master)
    later = Later(soc.sdram.crossbar.get_port(data_width=32))
    soc.add_module(f"{name}_later", later)
    soc.add_module(f"{name}_memory", LiteDRAMAXI2Native(bounds.memory, later.port, base_address=region.origin))


def add_fp3(soc, name="fp3", config="single", origin=None):
    """origin: where its window begins, a multiple of its size, where the processor does not cache (io_regions); None: LiteX chooses."""
    fp3 = FP3(soc.platform, config)
    soc.add_module(name, fp3)
    if fp3.memory:
        connect_memory(soc, name, fp3)
    soc.bus.add_slave(name, fp3.bus, SoCRegion(origin=origin, size=fp3.size, cached=False))
    if soc.irq.enabled:
        soc.irq.add(name, use_loc_if_exists=True)
    return fp3

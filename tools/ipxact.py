#!/usr/bin/env python3
"""IP-XACT (IEEE 1685-2014) components of the configurations: `make ipxact`.

    .venv/bin/python tools/ipxact.py                    every configuration: build/ipxact/fp3_<name>.xml
    .venv/bin/python tools/ipxact.py single array       these

PeakRDL writes the memory map out of rtl/gen/fp3.rdl; ports, bus interfaces and files are added here. The address blocks of a scheduler
are `registers`, `constants`, ..; with several schedulers their names end in its number or in `_broadcast`. Addresses are those of the bus.

s_axi           amba.com:AMBA4:AXI4-Lite:r0p0, a slave
m_axi           amba.com:AMBA4:AXI4:r0p0, a master, with `master`
s_axi_aclk      xilinx.com:signal:clock:1.0
s_axi_aresetn   xilinx.com:signal:reset:1.0, active low
irq             xilinx.com:signal:interrupt:1.0, active high
"""

import argparse
import os
import pathlib
import sys
import tempfile
from xml.dom import minidom

sys.dont_write_bytecode = True

import tops
from fp3gen import fusesoc, verilog
from fp3gen.check import Bad
from fp3gen.read import load, version

try:
    from peakrdl_ipxact import IPXACTExporter
    from systemrdl import RDLCompileError, RDLCompiler
except ImportError as error:
    sys.exit(f"ipxact.py: {error}: run make setup, and this with .venv/bin/python")

SPACE = "ipxact:"
ROOT = pathlib.Path(__file__).resolve().parents[1]
IDENTITY = {"vendor": "fp3", "library": "fp3", "version": ".".join(map(str, version(ROOT)))}  # as in fp3.core
LICENCE = " SPDX-License-Identifier: Apache-2.0 "  # the schema has no element for it
AXI = {"vendor": "amba.com", "library": "AMBA4", "name": "AXI4-Lite", "version": "r0p0"}
MEMORY = {**AXI, "name": "AXI4"}


class Blocks(IPXACTExporter):
    """The map of one scheduler; the names of its address blocks end in `suffix`."""
    suffix = ""

    def get_name(self, node):
        name = super().get_name(node)
        # Nothing else is asked for while no register has been added.
        return name + self.suffix if node.parent is self.scheduler else name

    def blocks(self, scheduler, path):
        self.scheduler, self.skip_not_present = scheduler, True
        instance = scheduler.current_idx
        self.suffix = f"_{instance[0]}" if instance else "_broadcast" if scheduler.inst_name == "broadcast" else ""
        self.export(scheduler, path)
        return self.doc.getElementsByTagName(SPACE + "addressBlock")


def memory_map(compiler, name):
    """The exporter's document, with the blocks of all schedulers in its only memory map."""
    top = compiler.elaborate(f"fp3_{name}").top
    exporter = Blocks(**IDENTITY)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "x.xml")
        blocks = [block for scheduler in top.children(unroll=True) for block in exporter.blocks(scheduler, path)]
    return exporter.doc, blocks


class Writer:
    """Elements of a component."""

    def __init__(self, doc):
        self.doc = doc

    def element(self, tag, *inside, **attributes):
        made = self.doc.createElement(SPACE + tag)
        for name, value in attributes.items():
            made.setAttribute(name, value)
        for one in inside:
            made.appendChild(self.doc.createTextNode(str(one)) if isinstance(one, (str, int)) else one)
        return made

    def named(self, tag, name, *inside):
        return self.element(tag, self.element("name", name), *inside)

    def interface(self, name, bus, mapped, mode, parameters):
        """mapped: (the bus's name of a signal, the port's)."""
        maps = [self.element("portMap", self.named("logicalPort", logical), self.named("physicalPort", port)) for logical, port in mapped]
        rows = [self.element("parameter", self.element("name", key), self.element("value", f'"{value}"'), parameterId=f"{name}_{key}")
                for key, value in parameters]
        return self.named("busInterface", name, self.element("busType", **bus), self.element("abstractionTypes", self.element(
            "abstractionType", self.element("abstractionRef", **{**bus, "name": bus["name"] + "_rtl"}), self.element("portMaps", *maps))),
            mode, *([self.element("parameters", *rows)] if rows else []))

    def interfaces(self, row, ports, mapped):
        def signal(kind):
            return {"vendor": "xilinx.com", "library": "signal", "name": kind, "version": "1.0"}

        axi = [(name.removeprefix("s_axi_").upper(), name) for _, _, name in ports if name.startswith("s_axi_")]
        axi = [("ARESETn" if logical == "ARESETN" else logical, name) for logical, name in axi]
        slave = self.element("slave", self.element("memoryMapRef", memoryMapRef=mapped))
        memory = [(name.removeprefix("m_axi_").upper(), name) for _, _, name in ports if name.startswith("m_axi_")]
        modes = {name: "slave" if direction == "input" else "master" for direction, _, name in ports}
        return self.element(
            "busInterfaces", self.interface("s_axi", AXI, axi, slave, []),
            *([self.interface("m_axi", MEMORY, memory, self.element("master"), [])] if memory else []),
            *[self.interface(name, signal(kind), [(logical, name)], self.element(modes[name]), parameters.items())
              for name, (kind, logical, parameters) in verilog.signals(ROOT, row).items()])

    def model(self, module, ports):
        def port(direction, width, name):
            vector = self.element("vectors", self.element("vector", self.element("left", width - 1), self.element("right", 0)))
            wire = self.element("wire", self.element("direction", {"input": "in", "output": "out"}[direction]), *([vector] if width > 1 else []))
            return self.named("port", name, wire)

        instance = self.named("componentInstantiation", "verilog", self.element("language", "verilog"), self.element("moduleName", module),
                              self.element("fileSetRef", self.element("localName", "rtl")))
        view = self.named("view", "rtl", self.element("componentInstantiationRef", "verilog"))
        return self.element("model", self.element("views", view), self.element("instantiations", instance),
                            self.element("ports", *[port(*row) for row in ports]))

    def files(self, included, sources):
        def file(name, *more):
            return self.element("file", self.element("name", name), self.element("fileType", "verilogSource"), *more)

        return self.element("fileSets", self.named(
            "fileSet", "rtl", *[file(name, self.element("isIncludeFile", "true")) for name in included], *[file(name) for name in sources]))


def component(compiler, root, row, regs, folder):
    """The XML of a configuration. folder: names of files are seen from there."""
    doc, blocks = memory_map(compiler, row["name"])
    writer = Writer(doc)
    ports = [port for port in verilog.ports(row, regs) if port]
    maps = doc.getElementsByTagName(SPACE + "memoryMaps")[0]
    body = maps.parentNode
    body.replaceChild(writer.element("memoryMaps", writer.named("memoryMap", "host", *blocks, writer.element("addressUnitBits", 8))), maps)
    maps = doc.getElementsByTagName(SPACE + "memoryMaps")[0]
    name = doc.getElementsByTagName(SPACE + "name")[0]
    name.firstChild.data = f"fp3_{row['name']}"
    body.insertBefore(writer.interfaces(row, ports, "host"), maps)
    body.appendChild(writer.model(f"fp3_{row['name']}", ports))

    def seen(names):
        return [pathlib.PurePath(os.path.relpath(root / "rtl" / one, folder)).as_posix() for one in names]

    body.appendChild(writer.files(seen(fusesoc.headers(root)), [*seen(fusesoc.rtl_sources(root, "*.v")), f"fp3_{row['name']}.v"]))
    body.appendChild(writer.element("description", row["doc"]))
    doc.insertBefore(doc.createComment(LICENCE), body)
    return doc.toprettyxml(indent="  ", encoding="UTF-8")


def main():
    parser = argparse.ArgumentParser(description="IP-XACT components of the configurations")
    parser.add_argument("configs", nargs="*", help="which; all of them if none is named")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/ipxact", help="the folder (build/ipxact)")
    args = parser.parse_args()
    try:
        machine = load(ROOT)
        unknown = sorted(set(args.configs) - {row["name"] for row in machine.configs})
        if unknown:
            raise Bad(f"there is no configuration {unknown[0]}")
        compiler = RDLCompiler()
        compiler.compile_file(str(ROOT / "rtl/gen/fp3.rdl"))
        args.output.mkdir(parents=True, exist_ok=True)
        for row in machine.configs:
            if not args.configs or row["name"] in args.configs:
                path = args.output / f"fp3_{row['name']}.xml"
                tops.write(row, machine, args.output)
                path.write_bytes(component(compiler, ROOT, row, machine.registers, args.output.resolve()))
                print(f"wrote {path}")
    except (Bad, OSError, RDLCompileError) as error:
        sys.exit(f"ipxact.py: {error}")


if __name__ == "__main__":
    main()

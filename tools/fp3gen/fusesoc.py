"""fp3.core, FuseSoC's description of the project, and plain lists of files."""

from .text import MARK

SAMPLE = "single"  # what lint, replay and ecp5 take; sim/replay.v takes it, too
SESSION = "ship.single.session"


def rtl_sources(root, pattern):
    """The files of rtl/ and its rooms, those left out that are generated, a vendor's, or around the processor."""
    return sorted(path.relative_to(root / "rtl").as_posix() for depth in ("", "*/")
                  for path in (root / "rtl").glob(depth + pattern) if path.parent.name not in ("gen", "board", "video"))


def headers(root):
    """What the sources include, from rtl/."""
    return [f"gen/{name}" for name in ("isa.vh", "registers.vh", "estimates.vh", "lns_curves.vh", "lns_sums.vh", "parameters.vh", "host_map.vh", "settings.vh", "events.vh",
                                       "operands.vh", "choices.vh", "choice_of.vh", "config_values.vh", "config_rules.vh", "timing.vh")] + rtl_sources(root, "*.vh")


def file_list(root):
    """For tools that want every file named; from the project's directory."""
    return [f"// {MARK.format(source='the files in rtl/')}",
            "// Every file below a top, for tools that do not look for modules by name (else: rtl/fp3.f). The top of a configuration",
            "// (make top CONFIG=name: build/rtl/fp3_name.v) is named beside this list. Paths are relative to the project's directory.",
            "+incdir+rtl", *[f"rtl/{name}" for name in rtl_sources(root, "*.v")]]


def core_file(root, version, configs):
    """FuseSoC's description: the modules that there are, a target for each configuration, and three that do something with one."""
    names = [row["name"] for row in configs]
    out = ["CAPI=2:", f"# {MARK.format(source='isa/configs.toml and the files in rtl/')}",
           f"name: fp3:fp3:fp3:{'.'.join(map(str, version))}", "description: A field-programmable physics processor", "license: Apache-2.0", "",
           "filesets:", "  rtl:", "    file_type: verilogSource", "    files:"]
    # The sources say `include "gen/isa.vh"`, from rtl/.
    out += [f"      - rtl/{name}: {{is_include_file: true, include_path: rtl}}" for name in headers(root)]
    out += [f"      - rtl/{name}" for name in rtl_sources(root, "*.v")]
    out += ["  replay:", "    files:", "      - rtl/gen/mnemonic.vh: {file_type: verilogSource, is_include_file: true, include_path: rtl}",
            "      - sim/replay.v: {file_type: verilogSource}", f"      - programs/{SESSION}: {{file_type: user, copyto: {SESSION}}}"]
    out += ["", "parameters:", "  session: {datatype: str, paramtype: plusarg, description: a recorded session}",
            "  FP3_CHECK: {datatype: bool, paramtype: vlogdefine, description: the RTL's own checks}",
            "  FP3_TRACE: {datatype: bool, paramtype: vlogdefine, description: a top has the ports of the trace (for simulation alone)}",
            "  FP3_ZEROS: {datatype: bool, paramtype: vlogdefine, description: memories are zero at power-up (for simulation alone)}", "",
            "generators:", "  top: {interpreter: python3, command: tools/tops.py, description: the top module of a configuration}", "generate:",
            *[f"  {name}: {{generator: top, parameters: {{config: {name}}}}}" for name in names], "", "targets:", "  default:", "    filesets: [rtl]", "    toplevel: fp3"]
    for name in names:
        out += [f"  {name}:", "    filesets: [rtl]", f"    generate: [{name}]", f"    toplevel: fp3_{name}"]
    if SAMPLE in names:
        out += ["  lint:", "    filesets: [rtl]", f"    generate: [{SAMPLE}]", f"    toplevel: fp3_{SAMPLE}", "    parameters: [FP3_CHECK=true]",
                "    flow: lint", "    flow_options: {tool: verilator, verilator_options: [-Wall]}",
                "  replay:", "    filesets: [rtl, replay]", f"    generate: [{SAMPLE}]", "    toplevel: replay", f"    parameters: [FP3_CHECK=true, FP3_TRACE=true, FP3_ZEROS=true, session={SESSION}]",
                "    flow: sim", "    flow_options: {tool: icarus, iverilog_options: [-g2012]}",
                "  ecp5:", "    filesets: [rtl]", f"    generate: [{SAMPLE}]", f"    toplevel: fp3_{SAMPLE}",
                "    flow: generic", "    flow_options: {tool: yosys, arch: ecp5, output_format: json}"]
    return out

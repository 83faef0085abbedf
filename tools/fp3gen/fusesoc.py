"""rtl/fp3.core, FuseSoC's description of the project."""

from .text import MARK


def rtl_sources(root, pattern):
    """The files of rtl/ and its rooms, those left out that are generated, a vendor's, or around the processor."""
    return sorted(path.relative_to(root / "rtl").as_posix() for depth in ("", "*/")
                  for path in (root / "rtl").glob(depth + pattern) if path.parent.name not in ("gen", "board"))


def headers(root):
    """What the sources include, from rtl/."""
    return [f"gen/{name}" for name in ("isa.vh", "registers.vh", "estimates.vh", "parameters.vh", "config_keys.vh", "shown.vh",
                                       "operands.vh", "choices.vh", "choice_of.vh", "config_values.vh", "timing.vh")] + rtl_sources(root, "*.vh")


def core_file(root, configs):
    """FuseSoC's description: the modules that there are, and a target for each configuration."""
    names = [row["name"] for row in configs]
    out = ["CAPI=2:", f"# {MARK.format(source='isa/configs.toml and the files in rtl/')}",
           "name: fp3:fp3:fp3:0", "description: A field-programmable physics processor", "",
           "filesets:", "  rtl:", "    file_type: verilogSource", "    files:"]
    # The sources say `include "gen/isa.vh"`, from here.
    out += [f"      - {name}: {{is_include_file: true, include_path: .}}" for name in headers(root)]
    out += [f"      - {name}" for name in rtl_sources(root, "*.v")]
    for name in names:
        out += [f"  {name}:", "    file_type: verilogSource", f"    files: [gen/fp3_{name}.v]"]
    out += ["", "targets:", "  default:", "    filesets: [rtl]", "    toplevel: fp3"]
    for name in names:
        out += [f"  {name}:", f"    filesets: [rtl, {name}]", f"    toplevel: fp3_{name}"]
    out += ["  lint:", f"    filesets: [rtl, {names[0]}]", f"    toplevel: fp3_{names[0]}",
            "    flow: lint", "    flow_options: {tool: verilator, verilator_options: [-Wall]}"]
    return out

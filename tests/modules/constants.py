"""Not a bench: writes the parameters of a module, and what it computes of them, as Verilog, for a netlist that has them no more."""

import os
from pathlib import Path

import cocotb
from cocotb.handle import ConstantObject


@cocotb.test()
async def constants(dut):
    rows = []
    for handle in dut:
        if isinstance(handle, ConstantObject):
            value = handle.value
            word = value if isinstance(value, int) else f"{len(value)}'b{value.binstr}"
            rows.append(f"  localparam {handle._name} = {word};\n")
    Path(os.environ["FP3_NAMES"]).write_text("".join(rows))

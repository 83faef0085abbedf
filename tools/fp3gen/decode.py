"""What hardware decodes by table: which operands an instruction has, and what fp_value does for it."""

from .isa import code_bits
from .text import MARK, columns
from .verilog import verilog_header


def choices(isa):
    """The instructions of fp_value; the number of each is its place here, from 1 on."""
    return [op for op in isa["op"] if op["path"][0] == "value"]


def operands_verilog(isa):
    """An instruction's code, and for each operand, whether the instruction has it. Of what takes a neighbour's word, or gives one, and
    of what makes lists, decode knows it, so that a build without compares no code for it."""
    out = [f"// {MARK.format(source='isa/isa.toml')}", "// Included inside a module that includes isa.vh."]
    more = code_bits(isa) > 5
    code = "{1'b1, code_word[C_HI:C_LO]}", "{3'd0, code_word[OP_HI:OP_LO]}"
    out += ["// Whether the rest of the code stands in field c, and the code.", "// verilator lint_off UNUSEDSIGNAL",
            "function more_code(input [31:0] code_word);", f"    more_code = {'&code_word[OP_HI:OP_LO]' if more else '1' + chr(39) + 'b0'};", "endfunction",
            "function [CODE_W-1:0] code_of(input [31:0] code_word);",
            f"    code_of = {f'more_code(code_word) ? {code[0]} : {code[1]}' if more else 'code_word[OP_HI:OP_LO]'};", "endfunction",
            "// verilator lint_on UNUSEDSIGNAL"]
    for letter in "abc":
        codes = [f"op == OP_{op['name'].upper()}" for op in isa["op"] if letter in op["operands"] and not {"computes", "takes"} & op.keys() and op.get("needs") != "keep"]
        out += [f"function has_{letter}(input [CODE_W-1:0] op);", f"    has_{letter} =",
                " ||\n".join(f"        {code}" for code in codes) + ";", "endfunction"]
    return out


def choices_verilog(isa):
    """The numbers that decode gives and fp_value takes."""
    names = ["none", *(op["name"] for op in choices(isa))]
    return verilog_header("isa/isa.toml", [
        ("What fp_value does: nothing, or what these instructions say.",
         [("[CHOICE_W-1:0] ", f"CHOICE_{name.upper()}", i) for i, name in enumerate(names)])])


def config_values_verilog(isa):
    """Whether a build has an instruction of fp_value, and the width of a choice among them."""
    needed = dict.fromkeys(op["needs"].upper() for op in choices(isa))
    return [f"// {MARK.format(source='isa/isa.toml')}",
            "// Included by rtl/config/derived.vh: not 0 where there is an instruction of fp_value; the width of a choice.",
            f"parameter integer VALUES   = {' | '.join(needed)},",
            f"parameter integer CHOICE_W = {len(choices(isa)).bit_length()},"]


def choice_of_verilog(isa):
    rows = [(f"        OP_{op['name'].upper()}: ", f"choice_of = {op['needs'].upper()} != 0 ? ",
             f"CHOICE_{op['name'].upper()} ", ": CHOICE_NONE;") for op in choices(isa)]
    return [f"// {MARK.format(source='isa/isa.toml')}",
            "// Included inside a module that includes config.vh, isa.vh and choices.vh: what fp_value does for an",
            "// instruction, as far as this build has it.",
            f"function [CHOICE_W-1:0] choice_of(input [CODE_W-1:0] op);", "    case (op)",
            *columns([*rows, ("        default: ", "choice_of = CHOICE_NONE;", "", "")]), "    endcase", "endfunction"]

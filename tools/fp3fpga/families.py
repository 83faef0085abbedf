"""Devices that tools/synth.py and tools/bitstream.py know, and how their families are synthesised, placed and packed: data only.

A new device is a row of DEVICES; a new family a row of FAMILIES besides, and its programs in tools/setup.sh.
"""

from collections import namedtuple

# maker   and the family's name. The family's key is also the folder of rtl/fpga/ with its versions of modules, if `own` says no other.
# synth   yosys commands. {top} and {json} are the module and the file of the netlist.
# kinds   of each figure the cells that count, as a regular expression, and how much each counts.
# placed  which figure of nextpnr's report is the number of logic cells; None: not placed here
# tool    the placer. Programs have the names that they have everywhere: flow.tool finds them
# place   its arguments, beside those of the device. {json}, {report}, {seed}, {mhz}, {grade}
# limits  likewise, where there is a file of constraints, {limits}
# alone   likewise, where there is none
# timed   whether it knows how slow a multiplier without registers is
# bitstream  what a bitstream takes; None: none is made
# pin     how the placer wants to be told a pin: a line with {port} and {site}. None: placed without pins, the top's
#         ports being registers; otherwise the top has three pins, and shifts its inputs in.
# loose   inputs of cells that are to be open where their driver is the constant cell
# own     the folder of rtl/fpga/, if it is not that of its key
Family = namedtuple("Family", "maker synth kinds placed tool place limits alone timed bitstream pin loose own", defaults=[None, None])

# cells   yosys's models of the primitives
# routed  the placer's argument for what the packer reads, {routed}
# pack    the packer and its arguments: {routed}, {out}
# suffix  of the bitstream
Bitstream = namedtuple("Bitstream", "cells routed pack suffix")

FAMILIES = {
    "ecp5": Family(
        "Lattice ECP5", "synth_ecp5 -abc9 -top {top} -json {json}",
        {"lut4": {"LUT4": 1}, "carry": {"CCU2C": 1}, "ff": {"TRELLIS_FF": 1}, "dsp": {"MULT18X18D": 1}, "ebr": {"DP16KD": 1}},
        "TRELLIS_COMB", "nextpnr-ecp5",
        "--speed {grade} --seed {seed} --freq {mhz} --timing-allow-fail --json {json} --report {report}", "--lpf {limits}", "--out-of-context", True,
        Bitstream("+/ecp5/cells_sim.v +/ecp5/cells_bb.v", "--textcfg {routed}", "ecppack --compress {routed} {out}", ".bit"), None),
    # There is no distributed memory: what asks for it gets what there is. Not with abc9: it loses multipliers without registers.
    "ice40": Family(
        "Lattice iCE40 UltraPlus",
        "hierarchy -top {top}; proc; setattr -unset ram_style -unset ramstyle -unset syn_ramstyle a:ram_style=distributed; opt; opt_share; "
        "synth_ice40 -device u -top {top} -json {json}",
        {"lut4": {"SB_LUT4": 1}, "carry": {"SB_CARRY": 1}, "ff": {"SB_DFF.*": 1}, "dsp": {"SB_MAC16": 1}, "ebr": {"SB_RAM40_4K.*": 1}},
        "ICESTORM_LC", "nextpnr-ice40",
        "--seed {seed} --freq {mhz} --timing-allow-fail --json {json} --report {report}", "--pcf {limits}", None, False,
        Bitstream("+/ice40/cells_sim.v", "--asc {routed}", "icepack {routed} {out}", ".bin"), "set_io {port} {site}"),
    # -nowidelut: the placer spends most of its time on chains of MUX2_LUT5 to MUX2_LUT8 otherwise.
    # synth_gowin gives pads to modules that keep their hierarchy, too; so they are put around the top alone, afterwards.
    "gowin": Family(
        "Gowin Arora",
        "synth_gowin -family gw2a -noiopads -nowidelut -top {top} -json {json}; "
        "iopadmap -bits -inpad IBUF O:I -outpad OBUF I:O {top}; clean; write_json {json}",
        {"lut4": {"LUT[1-4]": 1}, "carry": {"ALU": 1}, "ff": {"DFF.*": 1}, "dsp": {"MULT18X18": 1, "MULT9X9": 0.5, "MULT36X36": 4},
         "ebr": {"(SDP|SP|DP|pROM)(X9)?B?": 1}},
        "LUT4", "nextpnr-himbaechel-gowin",
        "--seed {seed} --freq {mhz} --timing-allow-fail --json {json} --report {report}", "--vopt cst={limits}", None, True,
        Bitstream("+/gowin/cells_sim.v", "--write {routed}", "gowin_pack -d GW2A-18C -o {out} {routed}", ".fs"),
        'IO_LOC "{port}" {site};'),
    # router2 finds no way for the clock from its pin to the clock buffer; router1 does.
    # Of each carry chain the first cell's CIN comes without a driver from the family's map, gets a 0 in abc9, and is
    # refused by nextpnr with that (YosysHQ/yosys, issue 5639): `loose` takes it away again.
    "nexus": Family(
        "Lattice CrossLink-NX", "synth_nexus -top {top} -json {json}",
        {"lut4": {"LUT4": 1, "WIDEFN9": 2}, "carry": {"CCU2": 1}, "ff": {"FD1P3.*": 1},
         "dsp": {"MULT18X18": 1, "MULTADDSUB18X18": 1, "MULT9X9": 0.5, "MULTADDSUB9X9WIDE": 2, "MULT18X36": 2, "MULTADDSUB18X36": 2, "MULT36X36": 4},
         "ebr": {"PDP(SC)?16K(_MODE)?": 1, "DP16K(_MODE)?": 1}},
        "OXIDE_COMB", "nextpnr-nexus",
        "--router router1 --seed {seed} --freq {mhz} --timing-allow-fail --json {json} --report {report}", "--pdc {limits}", None, True, None,
        "ldc_set_location -site {{{site}}} [get_ports {port}]", ("CCU2", "CIN", "VLO", "Z")),
    "xc7": Family(
        "AMD 7 series", "synth_xilinx -family xc7 -flatten -noiopad -noclkbuf -top {top} -json {json}",
        {"lut4": {"LUT[1-6]": 1}, "carry": {"CARRY4": 1}, "ff": {"FD[RSCP]E": 1}, "dsp": {"DSP48E1": 1},
         "ebr": {"RAMB18E1": 0.5, "RAMB36E1": 1}},
        None, None, None, None, None, True, None, None, None, "wide"),
    "cyclonev": Family(
        "Intel Cyclone V", "synth_intel_alm -family cyclonev -noiopad -noclkbuf -top {top}; write_json {json}",
        {"lut4": {"MISTRAL_(ALUT[2-6]|NOT)": 1}, "carry": {"MISTRAL_ALUT_ARITH": 1}, "ff": {"MISTRAL_FF": 1},
         "dsp": {"MISTRAL_MUL9X9": 0.33, "MISTRAL_MUL18X18": 0.5, "MISTRAL_MUL27X27": 1}, "ebr": {"MISTRAL_M10K": 1}},
        None, None, None, None, None, True, None, None, None, "wide"),
}

# more    arguments of the placer that say which device
# grades  speed grades: the first ones are those of `make sizes`. 0: it has one
# has     how much of each figure it has (data sheets: Lattice FPGA-DS-02012, FPGA-DS-02008, FPGA-DS-02049, Gowin DS226)
# sites   of clk_i, in_i, out_o
Device = namedtuple("Device", "family more package grades has sites")

DEVICES = {
    "LFE5U-25F": Device("ecp5", "--25k --package CABGA381", "CABGA381", (6, 8, 7), {"lut4": 24288, "ff": 24288, "dsp": 28, "ebr": 56}, None),
    "LFE5U-85F": Device("ecp5", "--85k --package CABGA381", "CABGA381", (6, 8, 7), {"lut4": 83640, "ff": 83640, "dsp": 156, "ebr": 208}, None),
    "iCE40UP5K": Device("ice40", "--up5k --package sg48", "SG48", (0,), {"lut4": 5280, "ff": 5280, "dsp": 8, "ebr": 30}, ("35", "3", "4")),
    "GW2AR-18": Device("gowin", "--device GW2AR-LV18QN88C8/I7 --vopt family=GW2A-18C", "QN88", (8,),
                       {"lut4": 20736, "ff": 15552, "dsp": 48, "ebr": 46}, ("4", "76", "77")),
    "LIFCL-40": Device("nexus", "--device LIFCL-40-{grade}BG400C", "BG400", (9, 8, 7), {"lut4": 32256, "ff": 32256, "dsp": 56, "ebr": 84},
                       ("L13", "G14", "G15")),
    "7-series": Device("xc7", None, None, (0,), None, None),
    "Cyclone-V": Device("cyclonev", None, None, (0,), None, None),
}

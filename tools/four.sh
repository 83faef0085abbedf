#!/usr/bin/env bash
# Simulated boards, each driven by a rank of its own over its serial line: one world on several chips.
#
#   tools/four.sh FP3 SCENE STEPS [BOARDS]    with FP3 the command; 4 boards, of configuration `world`
#
# Prints what fp3 run prints, and ends with 1 unless the boards leave what one process with engine fast leaves.
set -eu
fp3=$1 scene=$2 steps=$3 boards=${4:-4}
folder=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$folder"' EXIT

for i in $(seq "$boards"); do
    "$fp3" board --config world >"$folder/port$i" &
done
until [ "$(cat "$folder"/port* | wc -l)" -eq "$boards" ]; do
    sleep 0.1
    [ "$(jobs -pr | wc -l)" -eq "$boards" ] || { echo "four.sh: a board has ended" >&2 && exit 1; }
done
# Open MPI starts no more ranks than there are processors, and none as root, unless it is told to.
more=
if mpirun --version | grep -q 'Open MPI\|OpenRTE'; then more=--oversubscribe; fi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
mpirun $more -n "$boards" "$fp3" run --scene "$scene" --config world --steps "$steps" --engine board \
    --port "$(cat "$folder"/port* | paste -sd,)" --output "$folder/boards.csv"
"$fp3" run --scene "$scene" --config world --steps "$steps" --engine fast --output "$folder/one.csv" >"$folder/one.txt"
cmp "$folder/boards.csv" "$folder/one.csv"
echo "$boards boards leave, bit for bit, what one process leaves"

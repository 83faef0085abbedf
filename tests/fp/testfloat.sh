#!/bin/bash
# Runs Berkeley TestFloat's vectors through the cores: testfloat.sh TESTFLOAT_GEN FP_TESTFLOAT [LEVEL ...]
# TESTFLOAT_GEN is the program testfloat_gen, built with SPECIALIZE_TYPE=RISCV, whose NaN is 7FC00000.
set -u -o pipefail

gen=${1:-} test=${2:?usage: testfloat.sh TESTFLOAT_GEN FP_TESTFLOAT [LEVEL ...]}
shift 2
if [ -z "$gen" ] || ! command -v "$gen" >/dev/null; then
    cat >&2 <<EOF
testfloat: ${gen:-no testfloat_gen}${gen:+ is not a program}.
Give its path: make testfloat TESTFLOAT_GEN=.../testfloat_gen
It is part of Berkeley TestFloat, http://www.jhauser.us/arithmetic/TestFloat.html; build SoftFloat
and TestFloat with SPECIALIZE_TYPE=RISCV, so that the default NaN is 7FC00000.
EOF
    exit 2
fi

status=0
for level in ${@:-1 2}; do
    for op in add sub mul madd; do
        printf "level %s, " "$level"
        "$gen" -rnear_even -tininessafter -level "$level" "f32_${op/madd/mulAdd}" | "$test" --op "$op" || status=1
    done
done
exit $status

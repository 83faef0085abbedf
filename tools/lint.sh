#!/usr/bin/env bash
# Lint. Silent and 0 where all is well.
#
#   tools/lint.sh rtl TOP...   Verilator and Icarus, each module TOP as the top
#   tools/lint.sh c            clang-format and cppcheck over C and C++
#   tools/lint.sh format       formats C and C++
set -eu
cd "$(dirname "$0")/.."

sources() { find sw sim tests bench examples \( -name '*.c' -o -name '*.h' -o -name '*.cpp' \) | sort; }

lint_rtl() {
    local top file said failed=0
    for top in "$@"; do
        file=$(ls "rtl/gen/$top.v" "rtl/$top.v" rtl/*/"$top.v" 2>/dev/null | head -n 1)
        if [ -z "$file" ]; then
            echo "lint.sh: there is no module $top" >&2
            failed=1
            continue
        fi
        verilator --lint-only -Wall -DFP3_CHECK -f rtl/fp3.f -y rtl/board -y rtl/gen --top-module "$top" "$file" || failed=1
        # Icarus ends with 0 after a warning; anything it says counts.
        said=$(iverilog -Wall -g2005 -t null -c rtl/fp3.f -y rtl/board -y rtl/gen -s "$top" "$file" 2>&1) || failed=1
        [ -z "$said" ] || { echo "$said" && failed=1; } >&2
    done
    return $failed
}

lint_c() {
    local failed=0
    sources | xargs -r clang-format --dry-run -Werror || failed=1
    # missingIncludeSystem: the headers of the system are the compiler's to find.
    sources | grep '\.c' | xargs -r cppcheck --quiet --error-exitcode=1 --inline-suppr --std=c11 \
        --enable=warning,performance,portability --suppress=missingIncludeSystem \
        -Isw/include -Isw -Isim || failed=1
    return $failed
}

case ${1:-} in
rtl) shift && lint_rtl "$@" ;;
c) lint_c ;;
format) sources | xargs -r clang-format -i ;;
*) echo "usage: tools/lint.sh rtl TOP... | c | format" >&2 && exit 2 ;;
esac

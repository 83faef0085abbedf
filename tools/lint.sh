#!/usr/bin/env bash
# Lint. Silent and 0 where all is well.
#
#   tools/lint.sh rtl TOP...   slang, Verible, a new Verilator and Icarus, each module TOP as the top. Debian's Verilator reads the same in the
#                              build, with the same warnings
#   tools/lint.sh c [COMMITS]  clang-format and cppcheck over C and C++; cppcheck only over what the last COMMITS changed, if there are so many
#   tools/lint.sh format       formats C and C++
set -eu
cd "$(dirname "$0")/.."

sources() { find sw sim tests bench examples \( -name '*.c' -o -name '*.h' -o -name '*.cpp' \) | sort; }

tops=${FP3_BUILD:-build}/rtl
packages=$(echo .venv/lib/python3*/site-packages)

lint_rtl() {
    local top file said files= failed=0
    for top in "$@"; do
        file=$(ls "$tops/$top.v" "rtl/$top.v" rtl/*/"$top.v" 2>/dev/null | head -n 1)
        if [ -z "$file" ]; then
            echo "lint.sh: there is no module $top" >&2
            failed=1
            continue
        fi
        files="$files $file"
        VERILATOR_ROOT=$packages/verilator "$packages/verilator/bin/verilator_bin" --lint-only --quiet -Wall -DFP3_CHECK -f rtl/fp3.f \
            -y rtl/board -y rtl/video -y "$tops" --top-module "$top" "$file" || failed=1
        # Icarus ends with 0 after a warning; anything it says counts.
        said=$(iverilog -Wall -g2005 -t null -c rtl/fp3.f -y rtl/board -y rtl/video -y "$tops" -s "$top" "$file" 2>&1) || failed=1
        [ -z "$said" ] || { echo "$said" && failed=1; } >&2
    done
    # shellcheck disable=SC2086  (one word per file)
    [ -z "$files" ] || .venv/bin/python tools/slang.py $files || failed=1
    # Verible's grammar has the keywords of Verilog-AMS, too.
    find rtl -name '*.v' -exec .venv/bin/verible-verilog-syntax {} + || failed=1
    return $failed
}

# What differs from the tree some commits ago; of a clone that does not reach so far back, everything.
recent() {
    local names
    if [ -n "$1" ] && names=$(git diff --name-only "HEAD~$1" -- 2>/dev/null && git ls-files --others --exclude-standard); then
        sources | grep -Fx "$names"
    else
        sources
    fi
}

lint_c() {
    local failed=0
    sources | xargs -r clang-format --dry-run -Werror || failed=1
    # missingIncludeSystem: the headers of the system are the compiler's to find. One set of macros a file: more take twice as long,
    # and the compiler has read those that the build uses. Twenty files at a time: all at once take twice as long, for calls between them.
    recent "${1:-}" | grep '\.c' | xargs -r -n 20 cppcheck --quiet --error-exitcode=1 --inline-suppr --std=c11 \
        --enable=warning,performance,portability --max-configs=1 --suppress=missingIncludeSystem --suppress=toomanyconfigs \
        -Isw/include -Isw -Isim || failed=1
    return $failed
}

case ${1:-} in
rtl) shift && lint_rtl "$@" ;;
c) lint_c "${2:-}" ;;
format) sources | xargs -r clang-format -i ;;
*) echo "usage: tools/lint.sh rtl TOP... | c [COMMITS] | format" >&2 && exit 2 ;;
esac

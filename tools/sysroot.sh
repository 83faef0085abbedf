#!/usr/bin/env bash
# The libraries that libfp3 and the command need, compiled for another machine from the sources of this Debian.
#
#   tools/sysroot.sh aarch64-linux-gnu DIRECTORY
#
# DIRECTORY gets include/ and lib/ with archives. Of GSL only what libfp3 uses is compiled. Debian 12 has no packages of
# riscv64, so arm64 gets its libraries in the same way.
set -eu
[ $# = 2 ] || { echo "usage: tools/sysroot.sh TRIPLET DIRECTORY" >&2 && exit 2; }
triplet=$1 directory=$2 root=$PWD
mkdir -p "$directory/work"
directory=$(cd "$directory" && pwd)
cd "$directory/work"
export CC=$triplet-gcc AR=$triplet-ar RANLIB=$triplet-ranlib CFLAGS='-O2 -fPIC -ffp-contract=off'
libraries='zlib jansson libconfig gsl'
if [ "$triplet" = wasm32-wasi ]; then # what needs the others is not there (tools/wasm.mk)
    zig="$root/.venv/bin/python -m ziglang"
    export CC="$zig cc -target $triplet" AR="$zig ar" RANLIB="$zig ranlib" CFLAGS=-O2 CHOST=$triplet
    libraries='zlib libconfig'
fi

# Debian's own sources alone, in lists of our own: the machine's stay as they are.
fetch() {
    local sources=$directory/work/apt file options
    mkdir -p "$sources/parts" "$sources/lists/partial"
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*; do
        if [ -f "$file" ] && grep -q '/debian' "$file"; then
            sed 's/^deb /deb-src /; s/^Types: deb$/Types: deb-src/' "$file" >"$sources/parts/${file##*/}"
        fi
    done
    options="-qq -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts=$sources/parts -o Dir::State::lists=$sources/lists -o APT::Sandbox::User=root"
    # shellcheck disable=SC2086  (one word per option)
    apt-get $options update && apt-get $options source --download-only $libraries
    for file in *.orig.tar.*; do tar xf "$file"; done
    # What configure knows of machines may be older than the machine.
    for file in */config.sub */*/config.sub; do
        if [ -f "$file" ]; then cp /usr/share/misc/config.sub "$file"; fi
    done
}

install_zlib() (
    cd zlib-*/
    ./configure --static
    make libz.a
    cp libz.a ../../lib/
    cp zlib.h zconf.h ../../include/
)
install_jansson() (
    cmake -S jansson-*/ -B jansson -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_C_COMPILER="$CC" -DCMAKE_INSTALL_PREFIX="$directory" \
        -DJANSSON_BUILD_DOCS=OFF -DJANSSON_WITHOUT_TESTS=ON -DJANSSON_EXAMPLES=OFF
    make -C jansson install
)
install_libconfig() (
    cd libconfig-*/
    ./configure --host="$triplet" --prefix="$directory" --disable-shared --disable-cxx --disable-examples
    make -C lib install
)
install_gsl() (
    rooms='err sys utils complex block vector matrix permutation sort cblas blas linalg eigen qrng rng ode-initval2'
    cd gsl*/
    ./configure --host="$triplet" --disable-shared
    make -C gsl
    for room in $rooms; do make -C "$room"; done
    mkdir -p ../../include/gsl
    cp -L gsl/*.h ../../include/gsl/
    rm -f ../../lib/libgsl.a ../../lib/libgslcblas.a
    # shellcheck disable=SC2046  (one word per object)
    "$AR" rcs ../../lib/libgsl.a $(for room in $rooms; do [ "$room" = cblas ] || ls "$room"/*.o; done)
    "$AR" rcs ../../lib/libgslcblas.a cblas/*.o
)

mkdir -p ../lib ../include
log=
trap '[ -z "$log" ] || tail -n 20 "$directory/work/$log" >&2' EXIT
fetch
for library in $libraries; do
    echo "sysroot.sh: $library for $triplet" >&2
    log=$library.log
    install_$library >"$log" 2>&1
done
log=
cd ..
rm -rf work
touch done

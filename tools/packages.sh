#!/usr/bin/env bash
# Makes the Debian packages, the Python wheel and the source distribution of what is built: `make packages`.
#
#   tools/packages.sh DIRECTORY
#
# Those that are in DIRECTORY are removed first. The same sources give the same bytes: every date is that of the last
# commit, or SOURCE_DATE_EPOCH.
set -euo pipefail
[ $# = 1 ] || { echo "usage: tools/packages.sh DIRECTORY" >&2 && exit 2; }
mkdir -p "$1"
output=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
root=$PWD
python=${PYTHON:-/usr/bin/python3}
version=$(sed -n 's/^#define FP3_VERSION "\(.*\)"/\1/p' sw/include/fp3/status.h)
if ! tracked=$(git ls-files) || [ -z "$tracked" ] || ! SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}; then
    echo "packages.sh: packages are made in a git checkout: it says which files are sources, and of when they are" >&2
    exit 1
fi
export SOURCE_DATE_EPOCH LC_ALL=C.UTF-8 TZ=UTC
# The makes below are no part of the one that calls this.
unset MAKEFLAGS MFLAGS MAKELEVEL
umask 022
work=$output/work log=$output/work/log
rm -rf "$work" "$output"/{fp3,libfp3,python3-fp3}*.{deb,whl,tar.gz}
mkdir -p "$work/fp3" "$work/wheel"
trap '[ ! -s "$log" ] || tail -n 20 "$log" >&2' EXIT

debian() {
    echo "  DEB  fp3 $version"
    cp -r tools/debian "$work/fp3/debian"
    ln -s "$root" "$work/fp3/source"
    {
        printf 'fp3 (%s-0fp3) unstable; urgency=medium\n\n' "$version"
        printf '  * FP3 %s, as its own changelog describes it.\n\n' "$version"
        printf ' -- %s  %s\n' "$(sed -n 's/^Maintainer: //p' tools/debian/control)" "$(date -R -d "@$SOURCE_DATE_EPOCH")"
    } >"$work/fp3/debian/changelog"
    (cd "$work/fp3" && DEB_BUILD_OPTIONS=noautodbgsym dpkg-buildpackage --build=binary --unsigned-changes) >>"$log" 2>&1
}

# auditwheel puts the libraries that it is linked with into the wheel; their licences go with them. HDF5 stays out: it
# would bring a web client and its security along. So does Nettle, which Debian's HDF5 brings.
wheel() {
    echo "  WHL  fp3 $version"
    "$python" -m pip wheel . --no-deps --no-build-isolation --no-index --wheel-dir "$work" >>"$log" 2>&1
    PATH=$root/.venv/bin:$PATH .venv/bin/python -m auditwheel repair --strip --exclude 'libhdf5*' --exclude 'libnettle*' --wheel-dir "$work/wheel" \
        "$work"/*.whl >>"$log" 2>&1
    "$python" -m wheel unpack --dest "$work/wheel" "$work"/wheel/*.whl >>"$log" 2>&1
    rm "$work"/*.whl "$work"/wheel/*.whl
    local information package
    information=$(echo "$work"/wheel/*/*.dist-info)
    mkdir "$information/licenses"
    grep -o 'pkg:deb/debian/[^@"]*' "$information/sboms/auditwheel.cdx.json" | sort -u | while read -r package; do
        cp "/usr/share/doc/${package##*/}/copyright" "$information/licenses/${package##*/}"
    done
    "$python" -m wheel pack --dest-dir "$work" "$work"/wheel/* >>"$log" 2>&1
}

# What git tracks, and what pip wants to know beforehand.
sources() {
    echo "  TAR  fp3 $version"
    echo "$tracked" | tar -c --mode=u=rwX,go=rX --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" \
        --transform="s,^,fp3-$version/,S" --files-from=- --directory=build/python/fp3.egg-info PKG-INFO |
        gzip -9n >"$work/fp3-$version.tar.gz"
}

debian
wheel
sources
mv "$work"/*.deb "$work"/*.whl "$work"/*.tar.gz "$output"
rm -rf "$work"
ls -l "$output" | awk 'NR > 1 {printf "%9d %s\n", $5, $NF}'

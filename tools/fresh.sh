#!/usr/bin/env bash
# README's commands on a new machine: in a bare Debian, which mmdebstrap makes, on a clone of what is committed here. `make fresh`.
#
#   tools/fresh.sh                        the commands of README's section "Try it", then make setup test
#   tools/fresh.sh --command COMMAND      COMMAND instead, in the clone
#   tools/fresh.sh --root DIRECTORY ...   keeps the bare Debian there; a next run with it brings its clone to the commit and goes on in it
#
# Needs root. apt's sources and ways to them, pip's settings and certificates are this machine's; no other variable of the environment goes in.
# What the commands print also goes to build/fresh.log. All mounts are in a namespace of its own, so none is left, however this ends.
set -eu
cd "$(dirname "$0")/.."
release=bookworm root= kept= inside= commands=()
usage() { echo "usage: tools/fresh.sh [--root DIRECTORY] [--command COMMAND]" >&2 && exit 2; }
while [ $# -gt 0 ]; do
    [ $# -ge 2 ] && [ -n "$2" ] || usage
    case $1 in
    --root) root=$2 kept=1 ;;
    --command) commands=("$2") ;;
    *) usage ;;
    esac
    shift 2
done
[ "$(id -u)" = 0 ] || { echo "fresh.sh: a bare Debian is mounted and entered as root: run this as root" >&2 && exit 1; }
tools/setup.sh --check fresh
[ ${#commands[@]} -gt 0 ] || {
    mapfile -t commands < <(sed -n '/^## Try it/,/^## W/s/^    \(\(apt-get\|make\|build\/fp3\) .*\)/\1/p' README.md)
    commands+=('make setup test')
}
git diff --quiet HEAD || echo "fresh.sh: what is not committed does not take part"

end() {
    [ -z "$inside" ] || kill "$inside" 2>/dev/null || true
    wait
    rm -rf --one-file-system "$new"
    [ -n "$kept" ] || rm -rf --one-file-system "$root"
}
root=${root:-$(mktemp -d)}
new=${root%/}.tmp # a bare Debian has the name $root once it is whole, with its clone
trap end EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

if [ ! -d "$root/root/fp3" ]; then
    [ -z "$(ls -A "$root" 2>/dev/null)" ] || { echo "fresh.sh: $root is neither empty nor a bare Debian of this script" >&2 && exit 1; }
    rm -rf --one-file-system "$new"
    mapfile -t sources < <(grep -ls "/debian" /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources | xargs -r grep -l $release)
    mapfile -t ways < <(apt-config dump | sed -n 's/^\(Acquire::\(http\|https\|Check\|Retries\).*\);$/--aptopt=\1/p')
    mmdebstrap --quiet --variant=apt "${ways[@]}" $release "$new" "${sources[@]}"
    for setting in /etc/pip.conf /etc/resolv.conf /etc/hosts /usr/local/share/ca-certificates; do
        [ ! -e $setting ] || cp -rL $setting "$new${setting%/*}/"
    done
    git clone --quiet --no-hardlinks . "$new/root/fp3"
    mv -T "$new" "$root"
fi
git -C "$root/root/fp3" fetch --quiet "$PWD" HEAD
git -C "$root/root/fp3" reset --quiet --hard FETCH_HEAD

mapfile -t settings < <(env | grep -iE '^(PIP_[A-Z_]+|https?_proxy|no_proxy|TERM)=')
# shellcheck disable=SC2016  (the inner shells expand these)
enter='root=$1 && shift && mount --rbind /dev "$root/dev" && mount --rbind /sys "$root/sys" && exec chroot "$root" /usr/bin/env -i "$@"'
# shellcheck disable=SC2016
run='cd /root/fp3 && for command; do
    echo "+ $command" && SECONDS=0
    bash -c "$command" || { status=$? && echo "fresh.sh: failed after $((SECONDS / 60)) min $((SECONDS % 60)) s: $command" && exit $status; }
    echo "took $((SECONDS / 60)) min $((SECONDS % 60)) s"
done'
mkdir -p build
unshare --mount --pid --fork --kill-child --mount-proc="$root/proc" bash -ec "$enter" enter "$root" \
    HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "${settings[@]}" bash -c "$run" run "${commands[@]}" \
    > >(tee build/fresh.log) 2>&1 &
inside=$!
wait $inside

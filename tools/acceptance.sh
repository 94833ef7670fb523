#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Proves the README's commands on a fresh machine: a new minimal Debian with only git, make and python3, a clone of
# this repository's last commit, then each command, timed. The system stays for a look until the next run.
# usage: tools/acceptance.sh [bookworm|trixie] [COMMAND...]     (as root; default: bookworm, "make demo" "make test")
set -euo pipefail
project=$(realpath "$(dirname "$0")/..")
if [[ ${PLANAR_NAMESPACE:-} != "$$" ]]; then # mounts that nobody else sees, gone with this process
    "$project/tools/apt.sh" debootstrap mount
    PLANAR_NAMESPACE=$$ exec unshare --mount --propagation private "$0" "$@"
fi

release=${1:-bookworm}
commands=("${@:2}")
((${#commands[@]})) || commands=("make demo" "make test")
machine=${PLANAR_ROOMS:-/var/cache/planar-deform/rooms}/acceptance-$release

rm -rf --one-file-system "$machine"
debootstrap --variant=minbase --include=git,make,python3 "$release" "$machine" >"$machine.log" 2>&1 </dev/null
mount -t proc proc "$machine/proc"
mkdir -p "$machine/etc/ssl/certs" "$machine/repository"
cp /etc/ssl/certs/ca-certificates.crt "$machine/etc/ssl/certs/"
mount --bind -o ro "$project" "$machine/repository"

# Of this machine's environment only how the network is reached goes in.
mapfile -t network < <(env | grep -iE '^(pip_cert|ssl_cert_file|requests_ca_bundle|curl_ca_bundle|[a-z]*_proxy)=' || true)
inside() {
    chroot "$machine" /usr/bin/env -i "${network[@]}" HOME=/root TERM=dumb PATH=/usr/sbin:/usr/bin:/sbin:/bin \
        bash -c "$1" </dev/null
}
inside "git config --global --add safe.directory '*' && git clone -q /repository /root/planar-deform"
failures=0
for command in "${commands[@]}"; do
    SECONDS=0
    if inside "cd /root/planar-deform && $command"; then result=passed; else result=FAILED failures=$((failures + 1)); fi
    echo "== $release: $command: $result in $SECONDS s"
done
exit $((failures != 0))

#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs those of the given Debian packages that are missing; without root and sudo it names them instead.
# A name may be alternatives, `new|old`, of which the first that the release has is taken.
# usage: tools/apt.sh PACKAGE...
set -euo pipefail

installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' | sed -n 's/ installed$//p')
missing=()
for package in "$@"; do
    grep -qxE "${package//+/\\+}" <<<"$installed" || missing+=("$package")
done
((${#missing[@]})) || exit 0
# One at a time: who waited looks again at what is missing.
[[ -n ${PLANAR_APT_LOCKED:-} ]] || PLANAR_APT_LOCKED=yes exec flock --close /var/lib/dpkg "$0" "$@"

as_root=()
if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
        echo "These Debian packages are missing, and neither root nor sudo is here to install them:" >&2
        echo "    ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi
echo "Installing Debian packages: ${missing[*]}"

# python3-venv pulls ca-certificates in, whose installation rewrites the bundle: one that an administrator put
# there before (for a proxy that signs its own certificates) has to outlive it.
bundle=/etc/ssl/certs/ca-certificates.crt
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
[[ ! -s $bundle ]] || cp "$bundle" "$work/bundle"

# Nobody answers a question, and another apt-get at work is waited for. An interrupted run is finished first.
run() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive "$@" </dev/null >>"$work/log" 2>&1; }
first_known() {
    local name
    for name in ${1//|/ }; do
        if apt-cache show "$name" >/dev/null 2>&1; then break; fi
    done
    echo "$name"
}
if ! { run dpkg --configure -a && run apt-get -o DPkg::Lock::Timeout=600 update; }; then
    cat "$work/log" >&2
    exit 1
fi
for i in "${!missing[@]}"; do missing[i]=$(first_known "${missing[i]}"); done
if ! run apt-get -o DPkg::Lock::Timeout=600 install -y --no-install-recommends "${missing[@]}"; then
    cat "$work/log" >&2
    echo "apt-get could not install: ${missing[*]}" >&2
    exit 1
fi
if [[ -s $work/bundle ]] && ! cmp -s "$work/bundle" "$bundle"; then
    "${as_root[@]}" cp "$work/bundle" "$bundle"
fi

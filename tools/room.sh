#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a command in a Debian release other than the machine's: a chroot made once by debootstrap, where this
# checkout is /planar. Without a command it only makes the room. Rooms live in $PLANAR_ROOMS.
#   bookworm  Python 3.11, for the bpy wheels up to 5.0
#   trixie    Python 3.13, for bpy 5.2.3; Blender 4.3's window
#   sid       the newest Blender's window
# usage: tools/room.sh NAME [COMMAND...]
set -euo pipefail
project=$(realpath "$(dirname "$0")/..")
name=$1
# shellcheck source=tools/packages.sh
source "$project/tools/packages.sh"
packages=("${build_packages[@]}" "${bpy_packages[@]}")
case $name in
    bookworm) ;;
    trixie | sid) packages+=("${blender_packages[@]}" "${screen_packages[@]}") ;;
    *) echo "There is no room named $name: bookworm, trixie, sid." >&2 && exit 1 ;;
esac

# Everything is mounted in a mount namespace of this process alone: several processes and checkouts may be in one
# room at once, and nothing stays mounted however this ends.
if [[ ${PLANAR_NAMESPACE:-} != "$$" ]]; then # a process keeps its number through exec; a child's differs
    if ((EUID != 0)); then
        needs_root="The Debian room $name needs root or sudo. (Window tests also run in BLENDER=/path/to/blender.)"
        command -v sudo >/dev/null || { echo "$needs_root" >&2 && exit 1; }
        exec sudo --preserve-env env PLANAR_USER="$(id -u):$(id -g)" "$0" "$@"
    fi
    "$project/tools/apt.sh" debootstrap mount
    propagation=private # in a chroot "/" is no mount point, and its propagation cannot be changed
    unshare --mount --propagation private true 2>/dev/null || propagation=unchanged
    PLANAR_NAMESPACE=$$ exec unshare --mount --propagation $propagation "$0" "$@"
fi
shift

rooms=${PLANAR_ROOMS:-/var/cache/planar-deform/rooms}
room=$rooms/$name
mkdir -p "$rooms"
exec 9>"$room.lock"
flock 9
# debootstrap leaves its own folder in a system that it has not finished.
if [[ ! -e $room/etc/debian_version || -e $room/debootstrap ]]; then
    echo "Making the $name room in $room"
    rm -rf --one-file-system "$room"
    if ! debootstrap --variant=minbase "$name" "$room" </dev/null >"$room.log" 2>&1; then
        tail -n 20 "$room.log" >&2
        echo "debootstrap could not make the $name room." >&2
        exit 1
    fi
fi
# A mirror may serve an sid that it has not renewed for a while.
echo 'Acquire::Check-Valid-Until "false";' >"$room/etc/apt/apt.conf.d/90planar"
if [[ -s /etc/ssl/certs/ca-certificates.crt ]]; then
    mkdir -p "$room/etc/ssl/certs"
    cp /etc/ssl/certs/ca-certificates.crt "$room/etc/ssl/certs/"
fi
cp /etc/resolv.conf "$room/etc/resolv.conf"
mountpoint -q "$room/proc" || mount -t proc proc "$room/proc" || mount --rbind /proc "$room/proc"
mkdir -p "$room/planar"
mount --bind "$project" "$room/planar"
mount --bind /tmp "$room/tmp" # X servers of all rooms share one set of display numbers, so one set of locks

enter() { # enter USER COMMAND...
    local user=$1 home=/root
    shift
    [[ $user == 0:0 ]] || home=/home/planar-${user%:*}
    install -d -o "${user%:*}" "$room$home"
    chroot --userspec="$user" "$room" /usr/bin/env --chdir=/planar -u DISPLAY -u XDG_RUNTIME_DIR -u VIRTUAL_ENV \
        -u PYTHONPATH HOME="$home" LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@" 9>&-
}
enter 0:0 tools/apt.sh "${packages[@]}"
flock -u 9
(($# == 0)) || enter "${PLANAR_USER:-0:0}" "$@"

#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a Python command in a Python for Windows under wine, with one version of Windows' bpy, pytest and, unless it is
# bare, the module of the extension for Windows.
# usage: tools/wine/with_bpy.sh [--bare] BPY_VERSION ARGUMENTS_OF_PYTHON...
set -euo pipefail
cd "$(dirname "$0")/../.."
bare=
if [[ $1 == --bare ]]; then
    bare=yes
    shift
fi
version=$1
shift
case $version in
    4.2.* | 4.5.* | 5.0.*) tag=cp311 ;;
    *) tag=cp313 ;;
esac
[[ $bare ]] || make --silent extension PLATFORM=windows >&2
tools/cross/setup.sh windows-x64 >&2
site=build/wine/bpy-$version
module=build/wine/module
(
    flock 9
    build/cross/venv/bin/python tools/wine/python.py $tag >&2
    stamp=$(cat tools/wine/with_bpy.sh "tools/requirements/bpy-$version.txt" tools/requirements/{common,test}.txt | sha256sum)
    if [[ ! -f $site/.stamp || $(<"$site/.stamp") != "$stamp" ]]; then
        echo "Installing Windows' bpy $version" >&2
        rm -rf "$site"
        build/cross/venv/bin/python -m pip install -qq --disable-pip-version-check --target "$site" --no-deps \
            --ignore-requires-python --only-binary=:all: --platform win_amd64 --python-version "${tag:2:1}.${tag:3}" --abi $tag --abi abi3 --abi none \
            --requirement "tools/requirements/bpy-$version.txt" --requirement tools/requirements/test.txt
        # NumPy's mathematics are those of tools/wine/python.py.
        find "$site/numpy" -name '_multiarray_umath*.pyd' \
            -exec sed -i 's/api-ms-win-crt-math-l1-1-0/own-ms-win-crt-math-l1-1-0/g' {} +
        # From 5.0 on bpy maps files by functions that wine 8 has in name only; on a Windows without them it does otherwise.
        find "$site/bpy" -maxdepth 1 -name '*.pyd' -exec sed -i 's/MapViewOfFile3/MapViewOfFile_/g' {} +
        echo "$stamp" >"$site/.stamp"
    fi
    [[ ! $bare ]] || exit 0
    wheel=$(echo build/extension/windows-x64/*.whl)
    if [[ ! -e $module/.of || $wheel -nt $module/.of ]]; then
        rm -rf "$module"
        /usr/bin/python3 -m zipfile -e "$wheel" "$module"
        touch "$module/.of"
    fi
) 9>"$(mkdir -p build/wine && echo build/wine/lock)"
as_windows() { # a folder here as a path there
    local path
    path=Z:$(realpath "$1")
    echo "${path//\//\\}"
}
packages=$(as_windows "$site")
[[ $bare ]] || packages="$(as_windows "$module");$packages"
PYTHONPATH=$packages PYTHONDONTWRITEBYTECODE=1 PYTHONUTF8=1 \
    BLENDER_USER_RESOURCES="${BLENDER_USER_RESOURCES:-$(as_windows build/wine)\\home}" \
    exec tools/wine/run.sh build/wine/$tag/python.exe "$@"

#!/bin/sh
# three_d_tiles_tools.sh ARCHIVE.3tz [WORK_FOLDER]: unzip and the independent reader 3d-tiles-tools (npm) must accept an archive and its directory.
# The package is installed once under WORK_FOLDER (default: build/conformance beside the sources).
# Exit code 0: accepted; 1: refused; 2: wrong usage; 77: npm or the package cannot be had here.
set -u

PACKAGE=3d-tiles-tools@0.5.4

if [ $# -lt 1 ] || [ $# -gt 2 ]; then
    echo "usage: three_d_tiles_tools.sh ARCHIVE.3tz [WORK_FOLDER]" >&2
    exit 2
fi
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
archive=$(realpath -- "$1") || exit 1
work=${2:-$here/../../build/conformance}
mkdir -p "$work" && work=$(CDPATH= cd -- "$work" && pwd) || exit 1

for program in unzip node npm; do
    if ! command -v "$program" >/dev/null 2>&1; then
        echo "three_d_tiles_tools.sh: skipped: $program is not installed" >&2
        exit 77
    fi
done

tools=$work/node_modules/.bin/3d-tiles-tools
if [ ! -e "$tools" ]; then
    echo '{"private": true}' >"$work/package.json"
    if ! npm install --prefix "$work" --no-audit --no-fund --ignore-scripts "$PACKAGE" >"$work/npm.log" 2>&1; then
        echo "three_d_tiles_tools.sh: skipped: npm could not install $PACKAGE (see $work/npm.log)" >&2
        exit 77
    fi
fi

run=$(mktemp -d) || exit 1
trap 'rm -rf "$run"' EXIT INT TERM

# The tools print errors and still exit with 0, so what they say counts too.
check() {
    echo "== $*"
    if ! "$@" >"$run/log" 2>&1 || grep -Eq 'ERROR|Error:|Could not|Couldn.t|Exception' "$run/log"; then
        cat "$run/log" >&2
        echo "three_d_tiles_tools.sh: failed: $*" >&2
        exit 1
    fi
}

check unzip -tq "$archive"
check "$tools" convert -i "$archive" -o "$run/folder/"
check "$tools" convert -i "$run/folder/tileset.json" -o "$run/back.3tz"
check "$tools" convert -i "$run/back.3tz" -o "$run/again/"
check unzip -tq "$run/back.3tz"
check diff -r "$run/folder" "$run/again"
mkdir "$run/unzipped"
check unzip -q "$archive" -x "@3dtilesIndex1@" -d "$run/unzipped"
check diff -r "$run/folder" "$run/unzipped"
check "$tools" analyze -i "$archive" -o "$run/analyzed"
check env NODE_PATH="$work/node_modules" node "$here/traverse.cjs" "$archive"
tail -n 1 "$run/log"
echo "accepted: $archive"

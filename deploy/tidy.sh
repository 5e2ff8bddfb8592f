#!/usr/bin/env bash
# clang-tidy with the repository's .clang-tidy: ./deploy/tidy.sh [FILE or FOLDER]..., the whole tree without arguments.
# Prints each finding once and a count; exit code 1 when there is one, 2 when it cannot run. TIDY_JOBS (default: one a core) processes at a time;
# TIDY_BUILD (default build/tidy) is a build folder of its own, of which only the compiled shaders are built.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v clang-tidy >/dev/null || { echo "deploy/tidy.sh: no clang-tidy here (apt-get install clang-tidy)" >&2; exit 2; }
build=${TIDY_BUILD:-build/tidy}
results=$build/tidy
mkdir -p "$results"
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >"$results/configure.log" 2>&1 &&
    cmake --build "$build" --target citystream_shaders_compiled >>"$results/configure.log" 2>&1 || { cat "$results/configure.log" >&2; exit 2; }

# Findings in headers come with every source that includes them; hence the files' outputs are gathered and each line shown once.
files=$(python3 - "$build/compile_commands.json" "$@" <<'PYTHON'
import json, os, sys
wanted = [os.path.abspath(p) for p in sys.argv[2:]]
files = sorted({entry["file"] for entry in json.load(open(sys.argv[1]))})
print("\n".join(f for f in files if not wanted or any(f == w or f.startswith(w + "/") for w in wanted)))
PYTHON
)
[ -n "$files" ] || { echo "deploy/tidy.sh: no source that is compiled is named" >&2; exit 2; }

tidy_one() {  # FILE: its output, beside the others'
    local log
    log=$RESULTS/$(echo "${1#"$PWD"/}" | tr / _).log
    # The compile commands are g++'s, some of whose warnings clang does not know.
    clang-tidy -quiet -p "$BUILD" --extra-arg=-Wno-unknown-warning-option "$1" >"$log" 2>"$log.errors" ||
        grep -q ': error: ' "$log" || { echo "$1: clang-tidy failed"; cat "$log.errors"; } >>"$RESULTS/failed"
}
export -f tidy_one
export BUILD=$build RESULTS=$results
rm -f "$results"/*.cpp.log "$results"/*.cpp.log.errors "$results/failed"
echo "$files" | xargs -d '\n' -P "${TIDY_JOBS:-$(nproc)}" -n 1 bash -c 'tidy_one "$1"' tidy

if [ -s "$results/failed" ]; then cat "$results/failed" >&2; exit 2; fi
cat "$results"/*.cpp.log >"$results/all.log"
# The analyzer also ends paths within the headers of libraries: those are not ours to mend.
findings=$(grep -E "^$PWD/[^:]*:[0-9:]* (error|warning): " "$results/all.log" | sort -u || true)
if [ -n "$findings" ]; then
    sed "s|^$PWD/||" <<<"$findings"
    echo "$(wc -l <<<"$findings") findings in $(wc -l <<<"$files") sources; with their context: $results/all.log" >&2
    exit 1
fi
echo "no findings in $(wc -l <<<"$files") sources"

#!/usr/bin/env bash
# The demo: sets up, builds, makes a 1,000-building city (or takes the archive named as first argument), serves it, flies a recorded
# path over HTTP and leaves frames, a film, statistics and a report in out/.
set -euo pipefail
cd "$(dirname "$0")/.."

./deploy/setup.sh
cmake --preset release >out.cmake.log 2>&1 || { cat out.cmake.log; exit 1; }
rm -f out.cmake.log
cmake --build --preset release --target citystream-build citystream-serve citystream-fly citystream-load citystream-report
bin=build/release/bin
mkdir -p out

city=${1:-out/city.3tz}
path=${2:-deploy/demo_path.csv}
if [ ! -e "$city" ]; then
    "$bin/citystream-build" generate --buildings 1000 --seed 1 -o "$city" --reference "${city%.3tz}.glb"
fi
"$bin/citystream-build" verify "$city"

rm -f out/serve.log
"$bin/citystream-serve" "$city" --listen 127.0.0.1:0 >out/serve.log 2>&1 &
server=$!
trap 'kill "$server" 2>/dev/null || true; wait "$server" 2>/dev/null || true' EXIT
for _ in $(seq 100); do
    url=$(sed -n 's/.*listening on \(http:[^ ]*\).*/\1/p' out/serve.log | head -1)
    [ -n "$url" ] && break
    kill -0 "$server" 2>/dev/null || { cat out/serve.log >&2; exit 1; }
    sleep 0.1
done

rm -rf out/frames
"$bin/citystream-fly" "$url" --path "$path" --size 1280x720 --tolerance 1.0 --fps 6 \
    --frames out/frames --video out/flight.mp4 --stats out/stats.json
if [ -e "${city%.3tz}.glb" ]; then
    "$bin/citystream-report" "$city" --path "$path" --reference "${city%.3tz}.glb" -o out/report
    echo "report: out/report/index.html"
fi
echo "frames: out/frames ($(find out/frames -name '*.png' | wc -l) pictures); film: out/flight.mp4; statistics: out/stats.json"

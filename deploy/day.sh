#!/usr/bin/env bash
# A day in a city: sets up, builds, makes a 60-building city with the radiance layer (or takes the archive and the camera path named), and
# flies 24 hours in 24 seconds under the analytic sky, or under what the environment path names that is the third argument. Leaves frames, a
# film and statistics in out/day, and says what light costs.
set -euo pipefail
cd "$(dirname "$0")/.."

./deploy/setup.sh
mkdir -p out/day
cmake --preset release >out/day/cmake.log 2>&1 || { cat out/day/cmake.log; exit 1; }
cmake --build --preset release --target citystream-build citystream-fly
bin=build/release/bin

city=${1:-out/day/city.3tz}
path=${2:-deploy/day_path.csv}
environments=${3:-deploy/day_environments.csv}
if [ ! -e "$city" ]; then
    "$bin/citystream-build" generate --buildings 60 --seed 1 --layers mesh,facade,atlas,radiance -o "$city"
fi
rm -rf out/day/frames
"$bin/citystream-fly" "$city" --path "$path" --environment-path "$environments" --size 960x540 --fps 4 \
    --frames out/day/frames --video out/day/day.mp4 --stats out/day/stats.json
"$bin/citystream-build" info "$city" --json | python3 -c '
import json, sys
light = json.load(sys.stdin)["radiance"]
print("light: %d receivers, %.1f bytes each, %.0f %% of the bytes of tiles" %
      (light["receivers"], light["bytes_a_receiver"], light["percent_of_tile_bytes"]))'
echo "frames: out/day/frames ($(find out/day/frames -name '*.png' | wc -l) pictures); film: out/day/day.mp4; statistics: out/day/stats.json"

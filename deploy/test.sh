#!/usr/bin/env bash
# Sets up, builds and runs every test: release build (all tests), then the parsers, codecs, server and streaming client under the address and
# undefined-behaviour sanitizers and the server, streaming and load code under the thread sanitizer. Ends with a plain summary.
set -euo pipefail
cd "$(dirname "$0")/.."

./deploy/setup.sh
jobs=$(nproc)
results=build/test-results
mkdir -p "$results"
rm -f "$results"/*.xml

run_preset() {  # PRESET [TARGETS...]: without targets everything is built and run. Each test is labelled with its program's target.
    local preset=$1 labels=''
    shift
    if [ $# -gt 0 ]; then labels="^($(IFS='|'; echo "$*"))\$"; fi
    cmake --preset "$preset" >"$results/$preset-configure.log" 2>&1 || { cat "$results/$preset-configure.log"; exit 1; }
    cmake --build --preset "$preset" ${1:+--target "$@"} -- -j "$jobs"
    (cd "build/$preset" && ctest -j "$jobs" --output-on-failure --output-junit "$PWD/../../$results/$preset.xml" ${labels:+-L "$labels"}) || true
}

run_preset release
sanitized=(citystream_codec_bits_tests citystream_codec_mesh_tests citystream_codec_atlas_tests citystream_codec_facade_tests
           citystream_codec_radiance_tests citystream_tiles_radiance_tests citystream_client_light_tests citystream_tiles_city_tests citystream_tiles_tileset_tests citystream_tiles_archive_tests citystream_tiles_layers_tests
           citystream_shaders_tests citystream_server_tests citystream_client_select_tests citystream_client_stream_tests
           citystream_client_path_tests citystream_client_load_tests fuzzers)
run_preset asan "${sanitized[@]}"
run_preset tsan citystream_server_tests citystream_client_stream_tests citystream_client_load_tests

echo
echo "Summary"
python3 tests/summarise_ctest.py "$results"/*.xml

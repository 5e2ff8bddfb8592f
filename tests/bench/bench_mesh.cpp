// Claim: what the mesh layer costs on the wire, in memory and in decoding, against Draco, meshoptimizer and plain
// arrays.
#include <algorithm>
#include <chrono>

#include "tests/bench/bench_program.h"
#include "tests/bench/mesh_peers.h"
#include "tests/bench/sample_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using tiles::tileset::Layer;

constexpr const char* kClaim =
    "Leaf tiles of a city as our mesh layer, Draco (-cl 10), meshoptimizer + zstd and plain arrays + zstd, all at the "
    "same precision\n"
    "(2^-10 m grid, 8 + 8 bit normals, 16 bit texture coordinates, a chart for each triangle). wire_bytes: as sent. "
    "resident_bytes: as kept\n"
    "for drawing. *_to_ours: this representation's figure over ours. decode_ratio_to_raw_copy: time from wire bytes to "
    "checked resident\n"
    "arrays over the time to copy the raw float32 arrays. Every decoded tile is compared triangle for triangle.";
constexpr size_t kMostTiles = 16;

/// A spread-out choice of leaf tiles, decoded.
std::vector<PeerMesh> tiles_of(const SampleCity& city, BenchProgram& program) {
    auto leaves = city.leaves();
    std::erase_if(leaves, [](const auto* tile) { return tile->steps(Layer::kMesh).empty(); });
    std::vector<PeerMesh> meshes;
    const size_t count = std::min(kMostTiles, leaves.size());
    for (size_t i = 0; i < count; ++i) {
        const auto& record = *leaves[i * leaves.size() / count];
        Wire wire;
        uint64_t begin = 0;
        const auto bytes = city.layer_bytes(record, Layer::kMesh);
        for (const auto& step : record.steps(Layer::kMesh)) {
            const auto part = bytes.subspan(begin, step.end - begin);
            wire.parts.emplace_back(part.begin(), part.end());
            wire.decoded_bytes.push_back(step.decoded_bytes);
            begin = step.end;
        }
        wire.charts = ~uint32_t{0};
        Resident resident;
        if (!program.check(mesh_representations().front().decode(wire, resident), "a tile of the archive decodes"))
            continue;
        const auto tile = codec::mesh::decode_mesh(resident.words, resident.step_words, wire.charts);
        if (!program.check(tile.ok(), "a tile of the archive decodes to arrays")) continue;
        PeerMesh mesh = make_peer_mesh(*tile);
        if (!mesh.indices.empty()) meshes.push_back(std::move(mesh));
    }
    return meshes;
}

struct Case {
    Representation representation;
    std::vector<Wire> wires;
    uint64_t wire_bytes = 0, resident_bytes = 0;
    double encode_seconds = 0;
};

Case encode_all(const Representation& representation, const std::vector<PeerMesh>& meshes, BenchProgram& program) {
    Case result{representation, {}, 0, 0, 0};
    const auto begin = std::chrono::steady_clock::now();
    for (const PeerMesh& mesh : meshes) result.wires.push_back(representation.encode(mesh));
    result.encode_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (size_t i = 0; i < meshes.size(); ++i) {
        Resident resident;
        const bool same = representation.decode(result.wires[i], resident) &&
                          triangles_of(resident, meshes[i]) == triangles_of(meshes[i]);
        program.check(same, representation.name + ": tile " + std::to_string(i) + " decodes to the same triangles");
        result.wire_bytes += result.wires[i].bytes();
        result.resident_bytes += resident.bytes();
    }
    return result;
}

/// Copies the raw arrays of all tiles: the baseline of decoding.
void copy_raw(const std::vector<PeerMesh>& meshes) {
    for (const PeerMesh& mesh : meshes) {
        Resident copy;
        copy.raw = mesh.raw;
        copy.indices = mesh.indices;
        keep(copy);
    }
}

void measure(const std::string& file, const std::vector<PeerMesh>& meshes, int repetitions, BenchProgram& program) {
    uint64_t triangles = 0, vertices = 0;
    for (const PeerMesh& mesh : meshes) {
        triangles += mesh.indices.size() / 3;
        vertices += mesh.vertices.size();
    }
    std::vector<Case> cases;
    for (const auto& representation : mesh_representations())
        cases.push_back(encode_all(representation, meshes, program));
    std::vector<std::function<void()>> work;
    for (const Case& one : cases) {
        work.emplace_back([&one] {
            for (const Wire& wire : one.wires) {
                Resident resident;
                keep(one.representation.decode(wire, resident));
            }
        });
    }
    work.emplace_back([&meshes] { copy_raw(meshes); });
    const auto seconds = time_in_turn(work, repetitions);
    const auto ratio = [](uint64_t a, uint64_t b) { return rounded(static_cast<double>(a) / static_cast<double>(b)); };
    for (size_t i = 0; i < cases.size(); ++i) {
        const Case& one = cases[i];
        program.print({{"file", file},
                       {"representation", one.representation.name},
                       {"tiles", meshes.size()},
                       {"triangles", triangles},
                       {"vertices", vertices},
                       {"wire_bytes", one.wire_bytes},
                       {"resident_bytes", one.resident_bytes},
                       {"bits_per_triangle", ratio(8 * one.wire_bytes, triangles)},
                       {"wire_to_ours", ratio(one.wire_bytes, cases[0].wire_bytes)},
                       {"resident_to_ours", ratio(one.resident_bytes, cases[0].resident_bytes)},
                       {"encode_s", rounded(one.encode_seconds)},
                       {"encode_to_ours", rounded(one.encode_seconds / cases[0].encode_seconds)},
                       {"decode_ratio_to_raw_copy", to_json(ratio_of(seconds[i], seconds.back()))},
                       {"decode_to_ours", to_json(ratio_of(seconds[i], seconds[0]))}});
    }
}

void measure_city(const std::string& name, const Result<SampleCity>& city, int repetitions, BenchProgram& program) {
    if (!program.check(city.ok(), city.ok() ? "" : city.error().text())) return;
    const auto meshes = tiles_of(*city, program);
    if (!program.check(!meshes.empty(), name + " has triangles")) return;
    measure(name, meshes, repetitions, program);
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_mesh", kClaim, "city.city.jsonl"});
    BenchOptions options;
    options.repetitions = 5;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const TemporaryFolder folder;
    if (options.files.empty()) {
        const std::string archive = folder / "generated.3tz";
        const Status built = build_generated(options.buildings, options.seed, kAllLayers, archive);
        if (program.check(built.ok(), built.ok() ? "" : built.error().text())) {
            measure_city("generated:" + std::to_string(options.buildings), open_city(archive), options.repetitions,
                         program);
        }
    }
    for (const auto& file : options.files)
        measure_city(std::filesystem::path(file).filename().string(), city_of_file(file, kAllLayers, folder),
                     options.repetitions, program);
    return program.exit_code();
}

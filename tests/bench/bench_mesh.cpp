// Claim: what meshes cost on the wire, in memory and in decoding, against Draco, meshoptimizer and plain arrays: whole
// files in one layer, and leaf tiles of a city.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>

#include "tests/bench/bench_program.h"
#include "tests/bench/mesh_codecs.h"
#include "tests/bench/mesh_files.h"
#include "tests/bench/mesh_peers.h"
#include "tests/bench/sample_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using tiles::tileset::Layer;

constexpr const char* kClaim =
    "Each FILE, or the generated city, as one mesh without floors: triangles and positions on 14, 16 and 18 bits of "
    "its longest side,\n"
    "by our mesh layer in one step, with a normal and a colour for each triangle (default), and without these by "
    "Draco -cl 10 (draco),\n"
    "meshoptimizer's vertex and index codec + zstd -19 (meshopt), and float32 positions with indices + zstd -19 "
    "(raw). wire_bytes: all\n"
    "that travels. resident_bytes: as kept for drawing (default: the layer's words, triangles as local strips).\n"
    "max_error_m: of the grid, in the file's unit. Seconds are processor time. bits_per_triangle has what is known of "
    "where they go.\n"
    "Every decoded mesh is compared triangle for triangle.\n"
    "With --tiles yes: leaf tiles of a city as our mesh layer, Draco (-cl 10), meshoptimizer + zstd and plain arrays + "
    "zstd, all at the "
    "same precision\n"
    "(2^-10 m grid, 8 + 8 bit normals, 16 bit texture coordinates, a chart for each triangle). wire_bytes: as sent. "
    "resident_bytes: as kept\n"
    "for drawing. *_to_ours: this representation's figure over ours. decode_ratio_to_raw_copy: time from wire bytes to "
    "checked resident\n"
    "arrays over the time to copy the raw float32 arrays. Every decoded tile is compared triangle for triangle.";
constexpr size_t kMostTiles = 16;
constexpr std::array<uint32_t, 3> kBits = {14, 16, 18};

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
        PeerMesh mesh = make_peer_mesh(resident.tile);
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

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Least processor time of so many calls.
double least_seconds(int repetitions, const std::function<void()>& work) {
    double least = HUGE_VAL;
    for (int i = 0; i < repetitions; ++i) {
        const double begin = processor_seconds();
        work();
        least = std::min(least, processor_seconds() - begin);
    }
    return least;
}

Json bits_per_triangle(const CodedMesh& coded, double triangles) {
    Json bits;
    for (const auto& [name, count] : coded.bits_of) bits[name] = rounded(count / triangles);
    for (const auto& part : coded.parts) {
        if (coded.parts.size() > 1) bits[part.name] = rounded(8.0 * static_cast<double>(part.bytes.size()) / triangles);
    }
    bits["all"] = rounded(8.0 * static_cast<double>(coded.wire_bytes()) / triangles);
    return bits;
}

void measure_codec(const std::string& file, const SourceMesh& source, const QuantisedMesh& quantised, uint32_t bits,
                   const MeshCodec& codec, int repetitions, BenchProgram& program) {
    CodedMesh coded;
    const double encode = least_seconds(1, [&] { coded = codec.encode(quantised, bits); });
    codec::mesh::GridMesh decoded;
    bool right = true;
    const double decode = least_seconds(repetitions, [&] {
        decoded = {};
        right = codec.decode(coded, decoded);
    });
    program.check(right && same_triangles(decoded, quantised.mesh),
                  fmt::format("{}: {} at {} bits decodes to the same triangles", file, codec.name, bits));
    program.print(
        {{"file", file},
         {"codec", codec.name},
         {"bits", bits},
         {"triangles", quantised.mesh.triangles.size()},
         {"vertices", quantised.mesh.points.size()},
         {"buildings", source.buildings},
         {"wire_bytes", coded.wire_bytes()},
         {"resident_bytes", codec.resident_bytes(coded, decoded)},
         {"encode_s", rounded(encode)},
         {"decode_s", rounded(decode)},
         {"max_error_m", rounded(quantised.max_error)},
         {"bits_per_triangle", bits_per_triangle(coded, static_cast<double>(quantised.mesh.triangles.size()))}});
}

void measure_file(const std::string& name, const Result<SourceMesh>& source, int repetitions, BenchProgram& program) {
    if (!program.check(source.ok(), source.ok() ? "" : source.error().text())) return;
    for (const uint32_t bits : kBits) {
        const QuantisedMesh quantised = quantise(*source, bits);
        for (const MeshCodec& codec : mesh_codecs())
            measure_codec(name, *source, quantised, bits, codec, repetitions, program);
    }
}

void measure_files(const BenchOptions& options, BenchProgram& program) {
    if (options.files.empty())
        measure_file("generated:" + std::to_string(options.buildings), generated_mesh(options.buildings, options.seed),
                     options.repetitions, program);
    for (const auto& file : options.files)
        measure_file(std::filesystem::path(file).filename().string(), read_mesh_file(file), options.repetitions,
                     program);
}

void measure_tiles(const BenchOptions& options, BenchProgram& program) {
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
}

}  // namespace

int main(int argc, char** argv) {
    bool tiles = false;
    BenchDescription description{"bench_mesh", kClaim, "city.city.jsonl"};
    description.options = {{"--tiles", "yes: leaf tiles by the mesh layer; no: whole files (the default)",
                            [&tiles](const std::string& text) {
                                tiles = text == "yes";
                                return tiles || text == "no";
                            }}};
    BenchProgram program(description);
    BenchOptions options;
    options.repetitions = 3;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    if (tiles)
        measure_tiles(options, program);
    else
        measure_files(options, program);
    return program.exit_code();
}

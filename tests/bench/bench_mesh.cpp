// Claim: what meshes cost on the wire, in memory and in decoding, against Draco, meshoptimizer and plain arrays: whole
// files in one layer, and leaf tiles of a city.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <ctime>
#include <sstream>

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
    "Each FILE, or the generated city, as one mesh without floors: triangles and positions on so many bits of its "
    "longest side,\n"
    "by our mesh layer in one step, with a normal and a colour for each triangle (default), and without these by "
    "Draco -cl 10 (draco),\n"
    "meshoptimizer's vertex and index codec + zstd -19 (meshopt), and as .glb files + zstd -19: with "
    "EXT_meshopt_compression and\n"
    "KHR_mesh_quantization (glb-meshopt), and with float32 positions (glb). wire_bytes: all that travels. "
    "resident_bytes: as kept for\n"
    "drawing (default: the layer's words, triangles as local strips). resident_to_explicit: over float32 positions, "
    "normals and 32-bit\n"
    "indices. max_error_m: of the grid, in the file's unit. Seconds are processor time. bits_per_triangle, "
    "bytes_per_building: what\n"
    "is known of where they go, and all; attributes: colours, charts, texture coordinates; prisms have positions and "
    "topology in one.\n"
    "Every decoded mesh is compared triangle for triangle.\n"
    "With --tiles yes (all): 16 leaf tiles of a city (all) as our mesh layer, Draco (-cl 10), meshoptimizer + zstd, "
    "20-byte vertices +\n"
    "zstd (packed) and plain arrays + zstd (raw), all at the same precision (2^-10 m grid, 8 + 8 bit normals, 16 bit "
    "texture coordinates,\n"
    "a chart for each triangle). wire_bytes: as sent. resident_bytes: as kept for drawing. *_to_ours: this codec's "
    "figure over ours.\n"
    "decode_ratio_to_raw_copy: time from wire bytes to checked resident arrays over the time to copy the raw float32 "
    "arrays. Every decoded\n"
    "tile is compared triangle for triangle.";
constexpr size_t kFewTiles = 16;
constexpr uint32_t kLeastBits = 1, kMostBits = 24;  // floats of the peers hold all of them

/// A spread-out choice of leaf tiles, decoded.
std::vector<PeerMesh> tiles_of(const SampleCity& city, size_t most_tiles, BenchProgram& program) {
    auto leaves = city.leaves();
    std::erase_if(leaves, [](const auto* tile) { return tile->steps(Layer::kMesh).empty(); });
    std::vector<PeerMesh> meshes;
    const size_t count = std::min(most_tiles, leaves.size());
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

struct Case {
    Representation representation;
    std::vector<Wire> wires{};
    uint64_t wire_bytes = 0, resident_bytes = 0;
    double encode_seconds = 0;
    PartBits bits_of{};
};

void add_to(PartBits& sum, const PartBits& bits) {
    if (sum.empty()) sum.resize(bits.size());
    for (size_t i = 0; i < bits.size(); ++i) sum[i] = {bits[i].first, sum[i].second + bits[i].second};
}

/// Of each part and of all: so many of its bits per `unit`.
Json bits_per(const PartBits& parts, uint64_t wire_bytes, double unit) {
    Json bits;
    for (const auto& [name, count] : parts) bits[name] = rounded(count / unit);
    bits["all"] = rounded(8.0 * static_cast<double>(wire_bytes) / unit);
    return bits;
}

/// Null where it is not known how many buildings there are.
Json bytes_per_building(const PartBits& parts, uint64_t wire_bytes, uint64_t buildings) {
    return buildings == 0 ? Json() : bits_per(parts, wire_bytes, 8.0 * static_cast<double>(buildings));
}

Case encode_all(const Representation& representation, const std::vector<PeerMesh>& meshes, BenchProgram& program) {
    Case result{representation};
    result.encode_seconds = least_seconds(1, [&] {
        for (const PeerMesh& mesh : meshes) result.wires.push_back(representation.encode(mesh));
    });
    for (size_t i = 0; i < meshes.size(); ++i) {
        Resident resident;
        const bool same = representation.decode(result.wires[i], resident) &&
                          triangles_of(resident, meshes[i]) == triangles_of(meshes[i]);
        program.check(same, representation.name + ": tile " + std::to_string(i) + " decodes to the same triangles");
        result.wire_bytes += result.wires[i].bytes();
        result.resident_bytes += resident.bytes();
        add_to(result.bits_of, result.wires[i].bits_of);
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

void measure(const std::string& file, const std::vector<PeerMesh>& meshes, uint64_t buildings, int repetitions,
             BenchProgram& program) {
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
                       {"codec", one.representation.name},
                       {"tiles", meshes.size()},
                       {"triangles", triangles},
                       {"vertices", vertices},
                       {"buildings", buildings == 0 ? Json() : Json(buildings)},
                       {"wire_bytes", one.wire_bytes},
                       {"resident_bytes", one.resident_bytes},
                       {"bits_per_triangle", bits_per(one.bits_of, one.wire_bytes, static_cast<double>(triangles))},
                       {"bytes_per_building", bytes_per_building(one.bits_of, one.wire_bytes, buildings)},
                       {"wire_to_ours", ratio(one.wire_bytes, cases[0].wire_bytes)},
                       {"resident_to_ours", ratio(one.resident_bytes, cases[0].resident_bytes)},
                       {"encode_s", rounded(one.encode_seconds)},
                       {"decode_s", rounded(least_seconds(repetitions, work[i]))},
                       {"encode_to_ours", rounded(one.encode_seconds / cases[0].encode_seconds)},
                       {"decode_ratio_to_raw_copy", to_json(ratio_of(seconds[i], seconds.back()))},
                       {"decode_to_ours", to_json(ratio_of(seconds[i], seconds[0]))}});
    }
}

void measure_city(const std::string& name, const Result<SampleCity>& city, size_t most_tiles, int repetitions,
                  BenchProgram& program) {
    if (!program.check(city.ok(), city.ok() ? "" : city.error().text())) return;
    const auto meshes = tiles_of(*city, most_tiles, program);
    if (!program.check(!meshes.empty(), name + " has triangles")) return;
    const bool all = meshes.size() < most_tiles;
    measure(name, meshes, all ? city->manifest.buildings : 0, repetitions, program);
}

/// What a codec knows of where its bits go, or what travels on its own.
PartBits parts_of(const CodedMesh& coded) {
    PartBits bits = coded.bits_of;
    for (const auto& part : coded.parts) {
        if (coded.parts.size() > 1) bits.emplace_back(part.name, 8.0 * static_cast<double>(part.bytes.size()));
    }
    return bits;
}

/// Three float32 of position and of normal a vertex, 32-bit indices.
double explicit_bytes(const codec::mesh::GridMesh& mesh) {
    return static_cast<double>(24 * mesh.points.size() + 12 * mesh.triangles.size());
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
    program.print({{"file", file},
                   {"codec", codec.name},
                   {"bits", bits},
                   {"triangles", quantised.mesh.triangles.size()},
                   {"vertices", quantised.mesh.points.size()},
                   {"buildings", source.buildings},
                   {"wire_bytes", coded.wire_bytes()},
                   {"resident_bytes", codec.resident_bytes(coded, decoded)},
                   {"resident_to_explicit", rounded(static_cast<double>(codec.resident_bytes(coded, decoded)) /
                                                    explicit_bytes(quantised.mesh))},
                   {"encode_s", rounded(encode)},
                   {"decode_s", rounded(decode)},
                   {"max_error_m", rounded(quantised.max_error)},
                   {"bits_per_triangle", bits_per(parts_of(coded), coded.wire_bytes(),
                                                  static_cast<double>(quantised.mesh.triangles.size()))},
                   {"bytes_per_building", bytes_per_building(parts_of(coded), coded.wire_bytes(), source.buildings)}});
}

/// What the options of this program say.
struct Measures {
    std::vector<uint32_t> bits = {14, 16, 18};
    size_t tiles = 0;  ///< 0: whole files
};

void measure_file(const std::string& name, const Result<SourceMesh>& source, const Measures& measures, int repetitions,
                  BenchProgram& program) {
    if (!program.check(source.ok(), source.ok() ? "" : source.error().text())) return;
    for (const uint32_t bits : measures.bits) {
        const QuantisedMesh quantised = quantise(*source, bits);
        for (const MeshCodec& codec : mesh_codecs())
            measure_codec(name, *source, quantised, bits, codec, repetitions, program);
    }
}

void measure_files(const BenchOptions& options, const Measures& measures, BenchProgram& program) {
    if (options.files.empty())
        measure_file("generated:" + std::to_string(options.buildings), generated_mesh(options.buildings, options.seed),
                     measures, options.repetitions, program);
    for (const auto& file : options.files)
        measure_file(std::filesystem::path(file).filename().string(), read_mesh_file(file), measures,
                     options.repetitions, program);
}

void measure_tiles(const BenchOptions& options, size_t most_tiles, BenchProgram& program) {
    const TemporaryFolder folder;
    if (options.files.empty()) {
        const std::string archive = folder / "generated.3tz";
        const Status built = build_generated(options.buildings, options.seed, kAllLayers, archive);
        if (program.check(built.ok(), built.ok() ? "" : built.error().text())) {
            measure_city("generated:" + std::to_string(options.buildings), open_city(archive), most_tiles,
                         options.repetitions, program);
        }
    }
    for (const auto& file : options.files)
        measure_city(std::filesystem::path(file).filename().string(), city_of_file(file, kAllLayers, folder),
                     most_tiles, options.repetitions, program);
}

/// Numbers with commas between them.
bool read_bits(const std::string& text, std::vector<uint32_t>& bits) {
    bits.clear();
    std::istringstream numbers(text);
    for (std::string number; std::getline(numbers, number, ',');) {
        uint32_t value = 0;
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
        if (error != std::errc() || end != number.data() + number.size() || value < kLeastBits || value > kMostBits)
            return false;
        bits.push_back(value);
    }
    return !bits.empty();
}

}  // namespace

int main(int argc, char** argv) {
    Measures measures;
    BenchDescription description{"bench_mesh", kClaim, "city.city.jsonl"};
    description.options = {
        {"--tiles", "yes, all: leaf tiles by the mesh layer; no: whole files (the default)",
         [&measures](const std::string& text) {
             measures.tiles = text == "yes" ? kFewTiles : text == "all" ? SIZE_MAX : 0;
             return measures.tiles > 0 || text == "no";
         }},
        {"--bits", "of the longest side of whole files, 1 to 24 each, with commas between them (default 14,16,18)",
         [&measures](const std::string& text) { return read_bits(text, measures.bits); }}};
    BenchProgram program(description);
    BenchOptions options;
    options.repetitions = 3;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    if (measures.tiles > 0)
        measure_tiles(options, measures.tiles, program);
    else
        measure_files(options, measures, program);
    return program.exit_code();
}

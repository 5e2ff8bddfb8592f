// Claim: what the topology of a mesh costs as strip codes, resident and on the wire, beside the thesis's table and
// others' codecs.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "codec/bits/bit_stream.h"
#include "codec/mesh/local_strips.h"
#include "codec/mesh/strip_code.h"
#include "codec/mesh/strip_layout.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/mesh_files.h"
#include "tests/bench/topology_peers.h"
#include "tests/codec/mesh/topology_meshes.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::mesh;

constexpr const char* kClaim =
    "Bits per triangle of the topology alone: vertices welded by position on a 16-bit grid, floors of buildings left "
    "out.\n"
    "table 5.3: rows of the thesis, as printed there. strips: ours in each mode (r: restarts, deg: triangles put in), "
    "by "
    "the belts of\n"
    "the paper (differences predicted as 0) and by pivots; stages as in its table 5.4; local_strips is the variant "
    "with "
    "random access.\n"
    "variants: the explicit references in other word codes, and strips with a thread a chunk. wire: what travels, with "
    "the time to\n"
    "decode it over ours.";

struct ThesisRow {
    const char* mesh;
    uint32_t triangles, restarts;
    double regular, r, deg;
};
/// Meyer 2012, table 5.3.
constexpr ThesisRow kThesis[] = {
    {"Fan Disk", 12'946, 193, 0.80, 4.92, 4.16},           {"Bunny", 69'664, 1'146, 0.75, 5.02, 4.36},
    {"Rocker Arm", 80'354, 1'637, 0.65, 5.27, 4.61},       {"Horse", 96'966, 1'930, 0.66, 5.22, 4.65},
    {"Dinosaur", 112'384, 3'235, 0.58, 5.88, 5.42},        {"Igea", 268'686, 4'429, 0.66, 5.03, 4.35},
    {"Armadillo", 345'944, 9'620, 0.53, 5.63, 5.19},       {"Isis", 374'309, 3'877, 0.64, 4.66, 3.84},
    {"Angel", 474'048, 15'669, 0.60, 6.04, 5.74},          {"Hand", 654'666, 24'704, 0.53, 6.23, 6.00},
    {"Dragon", 869'928, 49'744, 0.33, 7.40, 7.59},         {"Buddha", 1'087'436, 61'873, 0.32, 7.42, 7.61},
    {"Welsh Dragon", 2'210'673, 19'823, 0.87, 4.53, 3.72}, {"Neptun", 3'316'916, 40'800, 0.84, 4.76, 4.01},
    {"Asian Dragon", 7'219'045, 66'286, 0.89, 4.67, 3.87}};

double per_triangle(uint64_t bits, const Topology& mesh) {
    return rounded(static_cast<double>(bits) / static_cast<double>(mesh.triangles.size()));
}

double regular_share(const Topology& mesh) {
    std::vector<uint32_t> valence(mesh.vertices, 0);
    for (const auto& corners : mesh.triangles) {
        for (const uint32_t vertex : corners) ++valence[vertex];
    }
    const auto used = mesh.vertices - std::count(valence.begin(), valence.end(), 0u);
    return rounded(static_cast<double>(std::count(valence.begin(), valence.end(), 6u)) / static_cast<double>(used));
}

/// Bits per triangle after each stage of the code: indices, strips, new vertices, Simple-9.
Json stages(std::span<const uint32_t> words, const Topology& mesh) {
    const StripHeader header = *read_strip_header(words);
    const uint64_t width = codec::bits::bits_for(std::max(header.vertices, 1u) - 1);
    const uint64_t steps = uint64_t{header.triangles} * (header.mode == STRIP_MODE_RESTARTS ? 2 : 1);
    return {{"explicit", per_triangle(3 * header.triangles * width, mesh)},
            {"strips", per_triangle(header.references * width + steps, mesh)},
            {"increments", per_triangle(header.explicit_references * width + header.references + steps, mesh)},
            {"simple9", per_triangle(32 * words.size(), mesh)}};
}

void print_strips(const std::string& name, const Topology& mesh, const StripCode& code, BenchProgram& program) {
    const auto bits = [&](const StripCodeOptions& options) {
        return per_triangle(32 * encode_strips(mesh.triangles, mesh.vertices, options)->words.size(), mesh);
    };
    const auto restarts = [&](StripTraversal traversal) {
        const auto order = order_strips(mesh.triangles, mesh.vertices, traversal);
        return std::count_if(order.triangles.begin(), order.triangles.end(),
                             [](const auto& place) { return place.step == StripStep::kRestart; });
    };
    const StripHeader header = *read_strip_header(code.words);
    const auto local = encode_local_strips(mesh.triangles, mesh.vertices);
    program.print({{"mesh", name},
                   {"what", "strips"},
                   {"triangles", mesh.triangles.size()},
                   {"regular_vertices", regular_share(mesh)},
                   {"restarts_belts", restarts(StripTraversal::kBelts)},
                   {"restarts_pivots", restarts(StripTraversal::kPivots)},
                   {"belts_r", bits({STRIP_MODE_RESTARTS, 0u, StripTraversal::kBelts})},
                   {"belts_deg", bits({STRIP_MODE_DEGENERATES, 0u, StripTraversal::kBelts})},
                   {"pivots_r", bits({STRIP_MODE_RESTARTS, {}, StripTraversal::kPivots})},
                   {"pivots_deg", bits({STRIP_MODE_DEGENERATES, {}, StripTraversal::kPivots})},
                   {"newest_pivots_r", bits({STRIP_MODE_RESTARTS, {}, StripTraversal::kNewestPivots})},
                   {"newest_pivots_deg", bits({STRIP_MODE_DEGENERATES, {}, StripTraversal::kNewestPivots})},
                   {"strips", per_triangle(32 * code.words.size(), mesh)},
                   {"mode", header.mode == STRIP_MODE_RESTARTS ? "r" : "deg"},
                   {"prediction", header.prediction},
                   {"stages", stages(code.words, mesh)},
                   {"local_strips", per_triangle(32 * local->words.size(), mesh)},
                   {"meshoptimizer_meshlets", per_triangle(8 * meshlet_bytes(mesh.triangles, mesh.vertices), mesh)}});
}

void print_variants(const std::string& name, const Topology& mesh, const StripCode& code, BenchProgram& program) {
    const WordCodeBits bits = word_code_bits(code.words);
    program.print(
        {{"mesh", name},
         {"what", "variants"},
         {"references_simple9", per_triangle(bits.simple9, mesh)},
         {"references_simple9_greedy", per_triangle(bits.simple9_greedy, mesh)},
         {"references_separate_selectors", per_triangle(bits.separate_selectors, mesh)},
         {"references_64_bit_words", per_triangle(bits.words_of_64, mesh)},
         {"references_fixed_width", per_triangle(bits.fixed_width, mesh)},
         {"strips_thread_a_chunk_of_64", per_triangle(chunked_bits(mesh.triangles, mesh.vertices, 64), mesh)}});
}

/// Sorted numbers of triangles at the vertices: the same for the same topology under any numbering.
std::vector<uint32_t> valences(const TriangleList& triangles) {
    uint32_t vertices = 0;
    for (const auto& corners : triangles)
        vertices = std::max(vertices, *std::max_element(corners.begin(), corners.end()) + 1);
    std::vector<uint32_t> valence(vertices, 0);
    for (const auto& corners : triangles) {
        for (const uint32_t vertex : corners) ++valence[vertex];
    }
    std::sort(valence.begin(), valence.end());
    valence.erase(valence.begin(), std::upper_bound(valence.begin(), valence.end(), 0u));
    return valence;
}

void print_wire(const std::string& name, const Topology& mesh, int repetitions, BenchProgram& program) {
    const auto peers = topology_peers();
    std::vector<std::vector<std::byte>> wires;
    std::vector<double> encode_seconds;
    std::vector<std::function<void()>> work;
    for (const TopologyPeer& peer : peers) {
        auto& wire = wires.emplace_back();
        encode_seconds.push_back(seconds_of([&] { wire = peer.encode(mesh.triangles, mesh.vertices); }));
    }
    std::vector<bool> is_same;
    for (size_t i = 0; i < peers.size(); ++i) {
        TriangleList back;
        const bool decodes = peers[i].decode(wires[i], back);
        std::erase_if(back, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
        // Draco cuts what is not manifold: its triangles are the same, its vertices are not.
        is_same.push_back(decodes && valences(back) == valences(mesh.triangles));
        program.check(decodes && back.size() == mesh.triangles.size() && (is_same[i] || i == 2),
                      name + ": " + peers[i].name + " decodes to the same triangles");
        work.emplace_back([&, i] {
            TriangleList out;
            keep(peers[i].decode(wires[i], out));
            keep(out);
        });
    }
    const auto seconds = time_in_turn(work, repetitions);
    for (size_t i = 0; i < peers.size(); ++i) {
        program.print({{"mesh", name},
                       {"what", "wire"},
                       {"codec", peers[i].name},
                       {"wire_bytes", wires[i].size()},
                       {"bits_per_triangle", per_triangle(8 * wires[i].size(), mesh)},
                       {"keeps_the_vertices", bool{is_same[i]}},
                       {"encode_to_ours", rounded(encode_seconds[i] / encode_seconds[0])},
                       {"decode_to_ours", to_json(ratio_of(seconds[i], seconds[0]))}});
    }
}

void measure(const std::string& name, const Topology& mesh, int repetitions, BenchProgram& program) {
    const auto code = encode_strips(mesh.triangles, mesh.vertices);
    if (!program.check(code.ok() && !mesh.triangles.empty(), name + " has triangles that can be coded")) return;
    print_strips(name, mesh, *code, program);
    print_variants(name, mesh, *code, program);
    print_wire(name, mesh, repetitions, program);
}

void measure_synthetic(int repetitions, BenchProgram& program) {
    const Topology sphere = icosphere(7);
    measure("icosphere 8", icosphere(8), repetitions, program);
    measure("torus 700 x 700", quad_grid(700, 700, true), repetitions, program);
    measure("grid 600 x 600", quad_grid(600, 600, false), repetitions, program);
    for (const size_t flips : {9'700, 24'400, 50'000, 90'000})
        measure("icosphere 7, " + std::to_string(flips) + " flips", with_edges_flipped(sphere, flips), repetitions,
                program);
    measure("separate quads", separate_quads(100'000), repetitions, program);
    measure("welded boxes", welded_boxes(20'000), repetitions, program);
}

void measure_file(const std::string& file, int repetitions, BenchProgram& program) {
    const auto source = read_mesh_file(file);
    if (!program.check(source.ok(), source.ok() ? "" : source.error().text())) return;
    const QuantisedMesh quantised = quantise(*source, 16);
    const Topology mesh{quantised.mesh.triangles, static_cast<uint32_t>(quantised.mesh.points.size())};
    measure(std::filesystem::path(file).filename().string(), mesh, repetitions, program);
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program(
        {.name = "bench_topology", .claim = kClaim, .files = "city.city.jsonl or mesh.obj.xz", .generates = false});
    BenchOptions options;
    options.repetitions = 5;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    for (const ThesisRow& row : kThesis) {
        program.print({{"mesh", row.mesh},
                       {"what", "table 5.3"},
                       {"triangles", row.triangles},
                       {"regular_vertices", row.regular},
                       {"restarts_belts", row.restarts},
                       {"belts_r", row.r},
                       {"belts_deg", row.deg}});
    }
    if (options.files.empty()) measure_synthetic(options.repetitions, program);
    for (const auto& file : options.files) measure_file(file, options.repetitions, program);
    return program.exit_code();
}

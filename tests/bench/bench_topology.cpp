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
    "table 5.3, 5.4: rows of the thesis, as printed there (times on a GeForce GTX 580). strips: ours in each mode (r: "
    "restarts, deg:\n"
    "triangles put in), by the belts of the paper (differences predicted as 0) and by pivots; stages as in table 5.4, "
    "of the code chosen\n"
    "and of the paper's; with_64_bit_vertices_to_explicit: code and 64 bits a vertex over floats and 32-bit indices; "
    "decode_ns: of the code chosen, on the processor, a triangle; local_strips is the variant with "
    "random access.\n"
    "variants: the explicit references in other word codes, and strips with a thread a chunk. wire: what travels, with "
    "the time to\n"
    "decode it over ours.";

struct ThesisRow {
    const char* mesh;
    uint32_t triangles, restarts;
    double regular, r, deg, r_ms, deg_ms, gigatriangles, render_ms;
};
/// Meyer 2012, table 5.3 (GeForce GTX 580): times of the whole decode, of the faster mode's triangles a second, of a
/// frame.
constexpr ThesisRow kThesis[] = {{"Fan Disk", 12'946, 193, 0.80, 4.92, 4.16, 0.33, 0.26, 0.05, 3.83},
                                 {"Bunny", 69'664, 1'146, 0.75, 5.02, 4.36, 0.36, 0.32, 0.22, 3.31},
                                 {"Rocker Arm", 80'354, 1'637, 0.65, 5.27, 4.61, 0.38, 0.35, 0.23, 4.71},
                                 {"Horse", 96'966, 1'930, 0.66, 5.22, 4.65, 0.24, 0.30, 0.33, 2.17},
                                 {"Dinosaur", 112'384, 3'235, 0.58, 5.88, 5.42, 0.34, 0.34, 0.33, 2.21},
                                 {"Igea", 268'686, 4'429, 0.66, 5.03, 4.35, 0.53, 0.38, 0.71, 4.18},
                                 {"Armadillo", 345'944, 9'620, 0.53, 5.63, 5.19, 0.60, 0.54, 0.64, 2.76},
                                 {"Isis", 374'309, 3'877, 0.64, 4.66, 3.84, 0.47, 0.42, 0.89, 2.25},
                                 {"Angel", 474'048, 15'669, 0.60, 6.04, 5.74, 0.68, 0.62, 0.76, 4.28},
                                 {"Hand", 654'666, 24'704, 0.53, 6.23, 6.00, 0.78, 0.64, 1.03, 3.07},
                                 {"Dragon", 869'928, 49'744, 0.33, 7.40, 7.59, 0.98, 0.93, 0.94, 6.07},
                                 {"Buddha", 1'087'436, 61'873, 0.32, 7.42, 7.61, 1.12, 0.98, 1.11, 3.24},
                                 {"Welsh Dragon", 2'210'673, 19'823, 0.87, 4.53, 3.72, 1.81, 1.56, 1.42, 6.49},
                                 {"Neptun", 3'316'916, 40'800, 0.84, 4.76, 4.01, 2.52, 2.13, 1.56, 4.86},
                                 {"Asian Dragon", 7'219'045, 66'286, 0.89, 4.67, 3.87, 5.05, 4.20, 1.72, 11.1}};

/// Bits per triangle after each stage of the code.
struct Stages {
    double indices, strips, increments, simple9;
};
struct ThesisStages {
    const char* mesh;
    Stages r, deg;
};
/// Meyer 2012, table 5.4.
constexpr ThesisStages kThesisStages[] = {{"Armadillo", {54, 21.0, 13.1, 5.6}, {60, 21.1, 13.2, 5.2}},
                                          {"Buddha", {60, 24.3, 15.4, 7.4}, {73.7, 25.8, 17.0, 7.6}},
                                          {"Welsh Dragon", {66.0, 24.4, 14.4, 4.5}, {68.4, 23.8, 13.9, 3.7}}};

Json to_json(const Stages& stages) {
    return {{"explicit", stages.indices},
            {"strips", stages.strips},
            {"increments", stages.increments},
            {"simple9", stages.simple9}};
}

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

/// Indices, strips, new vertices, Simple-9. Where triangles are put in, their indices count as well.
Stages stages(std::span<const uint32_t> words, const Topology& mesh) {
    const StripHeader header = *read_strip_header(words);
    const uint64_t width = codec::bits::bits_for(std::max(header.vertices, 1u) - 1);
    const uint64_t steps = uint64_t{header.triangles} * (header.mode == STRIP_MODE_RESTARTS ? 2 : 1);
    return {per_triangle(3 * header.triangles * width, mesh), per_triangle(header.references * width + steps, mesh),
            per_triangle(header.explicit_references * width + header.references + steps, mesh),
            per_triangle(32 * words.size(), mesh)};
}

/// The code with positions of 3 x 16 and normals of 2 x 8 bits a vertex, to three float32 of each and 32-bit indices.
double share_of_explicit(std::span<const uint32_t> words, const Topology& mesh) {
    const double vertices = mesh.vertices;
    return rounded((static_cast<double>(4 * words.size()) + 8 * vertices) /
                   (static_cast<double>(12 * mesh.triangles.size()) + 24 * vertices));
}

/// What the processor needs for a triangle; the GPU's times are bench_strip_decoder's.
double decode_nanoseconds(std::span<const uint32_t> words, const Topology& mesh, int repetitions) {
    const std::function<void()> decode = [&] { keep(decode_strips(words)); };
    const auto seconds = time_in_turn({&decode, 1}, repetitions)[0];
    return rounded(1e9 * *std::min_element(seconds.begin(), seconds.end()) /
                   static_cast<double>(mesh.triangles.size()));
}

void print_strips(const std::string& name, const Topology& mesh, const StripCode& code, int repetitions,
                  BenchProgram& program) {
    const auto bits = [&](const StripCodeOptions& options) {
        return per_triangle(32 * encode_strips(mesh.triangles, mesh.vertices, options)->words.size(), mesh);
    };
    const auto stages_of_belts = [&](uint32_t mode) {
        const StripCodeOptions options{mode, 0u, StripTraversal::kBelts};
        return to_json(stages(encode_strips(mesh.triangles, mesh.vertices, options)->words, mesh));
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
                   {"stages", to_json(stages(code.words, mesh))},
                   {"stages_belts_r", stages_of_belts(STRIP_MODE_RESTARTS)},
                   {"stages_belts_deg", stages_of_belts(STRIP_MODE_DEGENERATES)},
                   {"with_64_bit_vertices_to_explicit", share_of_explicit(code.words, mesh)},
                   {"decode_ns", decode_nanoseconds(code.words, mesh, repetitions)},
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
    print_strips(name, mesh, *code, repetitions, program);
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
                       {"belts_deg", row.deg},
                       {"decode_r_ms", row.r_ms},
                       {"decode_deg_ms", row.deg_ms},
                       {"decode_gigatriangles_a_second", row.gigatriangles},
                       {"render_ms", row.render_ms}});
    }
    for (const ThesisStages& row : kThesisStages) {
        program.print({{"mesh", row.mesh},
                       {"what", "table 5.4"},
                       {"stages_belts_r", to_json(row.r)},
                       {"stages_belts_deg", to_json(row.deg)}});
    }
    if (options.files.empty()) measure_synthetic(options.repetitions, program);
    for (const auto& file : options.files) measure_file(file, options.repetitions, program);
    return program.exit_code();
}

// The radiance layer of tiles by every transport: bytes on the wire, and time until they are words in GPU memory.
#include <algorithm>
#include <filesystem>

#include "codec/radiance/radiance_layer.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/measure.h"
#include "tests/bench/number_option.h"
#include "tests/bench/radiance_samples.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::radiance;

constexpr const char* kClaim =
    "The layer of tiles of 128 m, as it travels by each --radiance-transport of citystream-build: of box cities, or of "
    "FILEs (CityJSONSeq).\n"
    "wire_bytes: of all steps; first_step_bytes: of the first. rows_ms, biclusters_ms: processor time from wire to "
    "words in GPU memory, a receiver, in either form (of a tile the median of the repetitions). words_bytes: in "
    "either form; to_visibility: wire bytes over those of visibility. encode_ms: a receiver.\n"
    "Checked: words are the same whatever the transport.";

struct Options {
    SampleOptions sample;
    uint32_t local_side = 8;
    int repetitions = 3;
};

/// Sums over a set's tiles.
struct TransportFigures {
    uint64_t wire_bytes = 0, first_step_bytes = 0, rows_bytes = 0, biclusters_bytes = 0;
    double encode_seconds = 0, rows_seconds = 0, biclusters_seconds = 0;
};

/// A layer as it is received.
struct Wire {
    std::vector<std::span<const std::byte>> steps;
    uint64_t decoded_bytes = 0;
};

/// The words, and the median time they take; none: the layer cannot be read.
std::vector<uint32_t> decode(const Wire& wire, MatrixForm form, int repetitions, double& seconds) {
    std::vector<double> times;
    Result<std::vector<uint32_t>> words = Error{};
    for (int i = 0; i < repetitions; ++i) {
        times.push_back(
            processor_seconds_of([&] { words = decode_radiance_layer(wire.steps, wire.decoded_bytes, form); }));
    }
    seconds += spread_of(times).median;
    return words ? std::move(*words) : std::vector<uint32_t>();
}

/// Words of one tile in both forms.
struct TileWords {
    std::vector<uint32_t> rows, biclusters;
    friend bool operator==(const TileWords&, const TileWords&) = default;
};

TileWords measure_tile(const RadianceTile& tile, RadianceTransport transport, const Options& options,
                       TransportFigures& figures) {
    Result<std::vector<RadianceLayerStep>> steps = Error{};
    figures.encode_seconds +=
        processor_seconds_of([&] { steps = encode_radiance_layer(tile, options.local_side, 0, 0, transport); });
    if (!steps) return {};
    Wire wire;
    for (const RadianceLayerStep& step : *steps) {
        wire.steps.emplace_back(step.wire);
        wire.decoded_bytes += step.decoded_bytes;
        figures.wire_bytes += step.wire.size();
    }
    figures.first_step_bytes += wire.steps.front().size();
    TileWords words;
    words.rows = decode(wire, MatrixForm::kRows, options.repetitions, figures.rows_seconds);
    words.biclusters = decode(wire, MatrixForm::kBiclusters, options.repetitions, figures.biclusters_seconds);
    figures.rows_bytes += sizeof(uint32_t) * words.rows.size();
    figures.biclusters_bytes += sizeof(uint32_t) * words.biclusters.size();
    return words;
}

void print_figures(const RadianceSet& set, RadianceTransport transport, const TransportFigures& figures,
                   uint64_t visibility_bytes, const BenchProgram& program) {
    const auto receivers = static_cast<double>(set.receivers());
    const auto each = [&](double sum) { return rounded(sum / receivers); };
    program.print({{"file", set.name},
                   {"transport", name_of(transport)},
                   {"receivers", set.receivers()},
                   {"wire_bytes", figures.wire_bytes},
                   {"wire_bytes_a_receiver", each(static_cast<double>(figures.wire_bytes))},
                   {"first_step_bytes", figures.first_step_bytes},
                   {"to_visibility", rounded(static_cast<double>(figures.wire_bytes) /
                                             static_cast<double>(std::max<uint64_t>(1, visibility_bytes)))},
                   {"encode_ms_a_receiver", each(1e3 * figures.encode_seconds)},
                   {"rows_ms_a_receiver", each(1e3 * figures.rows_seconds)},
                   {"biclusters_ms_a_receiver", each(1e3 * figures.biclusters_seconds)},
                   {"rows_words_bytes", figures.rows_bytes},
                   {"biclusters_words_bytes", figures.biclusters_bytes}});
}

void measure_set(const RadianceSet& set, const Options& options, BenchProgram& program) {
    uint64_t visibility_bytes = 0;
    std::vector<TileWords> wanted(set.samples.size());
    for (size_t i = 0; i < kRadianceTransportNames.size(); ++i) {
        const auto transport = static_cast<RadianceTransport>(i);
        TransportFigures figures;
        for (size_t at = 0; at < set.samples.size(); ++at) {
            const RadianceSample& sample = set.samples[at];
            const RadianceTile tile{sample.spacing_log2, sample.places, sample.visibility};
            TileWords words = measure_tile(tile, transport, options, figures);
            if (transport == RadianceTransport::kVisibility)
                wanted[at] = std::move(words);
            else
                program.check(words == wanted[at], set.name + ": words of " + std::string(name_of(transport)));
            program.check(!wanted[at].rows.empty(), set.name + ": there are words");
        }
        if (transport == RadianceTransport::kVisibility) visibility_bytes = figures.wire_bytes;
        print_figures(set, transport, figures, visibility_bytes, program);
    }
}

void measure_file(const std::string& path, const Options& options, BenchProgram& program) {
    const std::string name = std::filesystem::path(path).filename().string();
    const auto source = read_mesh_file(path);
    if (!program.check(source.ok(), source.ok() ? "" : source.error().text())) return;
    if (!program.check(source->buildings > 0, name + " is no city")) return;
    auto samples = bake_city_tiles(*source, options.sample);
    if (!program.check(samples.ok(), samples.ok() ? "" : name + ": " + samples.error().text())) return;
    measure_set({name, std::move(*samples)}, options, program);
}

void measure_made_up(const Options& options, BenchProgram& program) {
    for (const bool turned : {false, true}) {
        auto sample = bake_box_city(turned, options.sample);
        if (!program.check(sample.ok(), sample.ok() ? "" : sample.error().text())) return;
        RadianceSet set{turned ? "box-city-turned" : "box-city", {}};
        set.samples.push_back(std::move(*sample));
        measure_set(set, options, program);
    }
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    BenchDescription description{"bench_radiance_transport", kClaim, "city.city.jsonl"};
    description.generates = false;
    description.options = {
        {"--lattice", "metres between receivers, a power of two from 1 to 16 (default 4)",
         [&](const std::string& text) {
             return take_number(text, 1.0, 16.0, options.sample.lattice_metres) &&
                    (text == "1" || text == "2" || text == "4" || text == "8" || text == "16");
         }},
        {"--directions", "texels on a side of the source's cube, 1 to 64 (default 32)",
         [&](const std::string& text) { return take_number(text, 1U, kMostCubeSide, options.sample.texels_across); }},
        {"--local-directions", "on a side of a receiver's square of directions, 1 to 32 (default 8)",
         [&](const std::string& text) { return take_number(text, 1U, kMostLocalSide, options.local_side); }},
        {"--tiles", "of a city, 1 to 10000 (default 4)",
         [&](const std::string& text) { return take_number(text, 1U, 10000U, options.sample.tiles); }}};
    BenchProgram program(description);
    BenchOptions given;
    given.repetitions = options.repetitions;
    if (!program.read_arguments(argc, argv, given)) return program.exit_code();
    options.repetitions = std::max(1, given.repetitions);
    if (given.files.empty()) measure_made_up(options, program);
    for (const std::string& file : given.files) measure_file(file, options, program);
    return program.exit_code();
}

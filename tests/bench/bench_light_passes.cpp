// Claim: when the light changes, the GPU lights resident tiles by biclusters faster than by sparse rows or by the bits.
#include <time.h>

#include <array>
#include <functional>
#include <memory>

#include "client/render/device_choice.h"
#include "client/render/radiance_passes.h"
#include "codec/radiance/irradiance.h"
#include "codec/radiance/local_directions.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/light_peers.h"
#include "tests/bench/number_option.h"
#include "tests/bench/radiance_samples.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;
using namespace codec::radiance;

constexpr const char* kClaim =
    "Tiles of the box city in GPU memory, lit anew at each change of light: from the light's texels to the irradiance "
    "of all receivers.\n"
    "Methods: biclusters and rows (the light passes over layers as the client holds them, clusters of distinct rows, "
    "or distinct rows themselves;\nwith receivers' places), csr (all rows of the matrix, 4 bytes an entry), "
    "csr-one-row (a row a receiver: what it sees, in whatever\nlocal direction, which irradiance needs no more of) and "
    "bits (brute force, an addition a visible sample), these with\na workgroup a receiver. cpu_ms: processor time of "
    "all "
    "threads for one change, which on a software device is the work; wall_ms; times_biclusters:\nthat time over the "
    "biclusters', median over median, of the processor on a software device, else of the wall. mismatches: words that "
    "are not the processor's.";

struct Options {
    uint32_t tiles = 64, distinct = 4;
    bool turned = false;
    SampleOptions sample;
};

constexpr uint32_t kLocalSide = 8;

/// Bright above, with a glow from one side that `turn` moves.
WholeLight sky(uint32_t texels_across, double turn) {
    std::vector<Rgb> radiance(texel_count(texels_across));
    for (uint32_t k = 0; k < radiance.size(); ++k) {
        const GridDirection d = cell_direction(texels_across, k);
        const double x = d[0], y = d[1], z = d[2], length = std::sqrt(x * x + y * y + z * z);
        const double glow =
            std::exp(8 * ((0.8 * std::cos(turn) * x + 0.8 * std::sin(turn) * y + 0.6 * z) / length - 1));
        const auto up = static_cast<float>(std::max(0.0, z / length)), bright = static_cast<float>(3 * glow);
        radiance[k] = {0.1F + 0.4F * up + bright, 0.1F + 0.6F * up + bright, 0.1F + 0.9F * up};
    }
    return whole_light(weighted_light(radiance, texels_across));
}

/// A tile in all its forms.
struct TileData {
    RadianceSample sample;
    Transfer transfer, one_row;            ///< by local directions, and by one that takes all
    std::vector<uint32_t> clusters, rows;  ///< words of its layer
};

Result<std::vector<uint32_t>> layer_words(const RadianceSample& sample, MatrixForm form) {
    const RadianceTile tile{sample.spacing_log2, sample.places, sample.visibility};
    const auto steps = encode_radiance_layer(tile, kLocalSide, 0);
    if (!steps) return steps.error();
    std::vector<std::span<const std::byte>> wire;
    uint64_t bytes = 0;
    for (const auto& step : *steps) {
        wire.emplace_back(step.wire);
        bytes += step.decoded_bytes;
    }
    return decode_radiance_layer(wire, bytes, form);
}

Result<TileData> tile_data(const Options& options, uint32_t number) {
    auto sample = bake_box_city(options.turned, options.sample, {number, 0});
    if (!sample) return sample.error();
    auto clusters = layer_words(*sample, MatrixForm::kBiclusters), rows = layer_words(*sample, MatrixForm::kRows);
    if (!clusters) return clusters.error();
    if (!rows) return rows.error();
    Transfer transfer = make_transfer(sample->visibility, LocalDirections(kLocalSide));
    Transfer one_row = make_transfer(sample->visibility, LocalDirections(1));
    return TileData{std::move(*sample), std::move(transfer), std::move(one_row), std::move(*clusters),
                    std::move(*rows)};
}

/// The words that the processor gives a tile's receivers.
std::vector<uint32_t> expected_words(const TileData& tile, const WholeLight& light) {
    return irradiance_words(*RadianceLayerView::create(tile.clusters), light);
}

/// A way to light the tiles.
class Method {
  public:
    virtual ~Method() = default;
    /// One change of light, to the end.
    virtual void light_up(const WholeLight& light, uint64_t number) = 0;
    /// Words of a tile's receivers as irradiance_words has them.
    virtual std::vector<uint32_t> words(size_t tile) const = 0;
    virtual uint64_t resident_bytes() const = 0;
};

class Passes : public Method {
  public:
    Passes(const Device& device, std::span<const TileData> tiles, uint32_t count, MatrixForm form) : device_(device) {
        const auto words_of = [&](uint32_t i) -> const std::vector<uint32_t>& {
            const TileData& tile = tiles[i % tiles.size()];
            return form == MatrixForm::kRows ? tile.rows : tile.clusters;
        };
        for (uint32_t i = 0; i < count; ++i) bytes_ += 4 * words_of(i).size();
        pool_ = create_slot_pool(device, bytes_ + uint64_t{count} * kSlotBytes + kChunkBytes);
        for (uint32_t i = 0; i < count; ++i) {
            const auto view = RadianceLayerView::create(words_of(i));
            parts_.push_back({create_layer(pool_), view->irradiance_word(), view->irradiance().size()});
            layers_.push_back(parts_.back().layer);
            if (!append_words(pool_, layers_.back(), words_of(i)).ok()) throw VulkanError("the pool is full");
        }
        passes_ = std::make_unique<RadiancePasses>(device, pool_);
    }
    ~Passes() override {
        passes_.reset();
        destroy_slot_pool(pool_);
    }
    Passes(const Passes&) = delete;
    Passes& operator=(const Passes&) = delete;

    void light_up(const WholeLight& light, uint64_t number) override {
        FrameLight frame;
        frame.number = number;
        frame.texels_across = texels_across_of(light.values.size());
        frame.sky = light;
        passes_->set_light(frame);
        if (!passes_->plan(layers_).ok()) throw VulkanError("the layers cannot be lit");
        submit_and_wait(device_, [&](VkCommandBuffer commands) { passes_->record(commands); });
        passes_->finish();
    }
    std::vector<uint32_t> words(size_t tile) const override {
        return read_words(pool_, parts_[tile].layer, parts_[tile].words, parts_[tile].first);
    }
    uint64_t resident_bytes() const override { return bytes_; }

  private:
    struct Part {
        LayerId layer;
        uint32_t first;
        size_t words;
    };
    const Device& device_;
    SlotPool pool_;
    std::unique_ptr<RadiancePasses> passes_;
    std::vector<Part> parts_;
    std::vector<LayerId> layers_;
    uint64_t bytes_ = 0;
};

class Peer : public Method {
  public:
    enum class Form : uint8_t { kRows, kOneRow, kBits };
    Peer(const Device& device, std::span<const TileData> tiles, uint32_t count, Form form)
        : device_(device),
          tiles_(tiles),
          peer_(device, form == Form::kBits ? LightPeerKind::kBits : LightPeerKind::kCsr) {
        directions_ = texel_directions(tiles[0].sample.visibility.side);
        for (uint32_t i = 0; i < count; ++i) {
            const TileData& tile = tiles[i % tiles.size()];
            if (form == Form::kRows)
                peer_.add_rows(tile.transfer, kLocalSide * kLocalSide);
            else if (form == Form::kOneRow)
                peer_.add_rows(tile.one_row, 1);
            else
                peer_.add_bits(tile.sample.visibility);
        }
    }

    void light_up(const WholeLight& light, uint64_t /*number*/) override {
        peer_.set_light(light_vectors(light, directions_));
        submit_and_wait(device_, [&](VkCommandBuffer commands) { peer_.record(commands); });
    }
    std::vector<uint32_t> words(size_t tile) const override {
        std::vector<uint32_t> words;
        const auto sums = peer_.sums(tile);
        const auto& places = tiles_[tile % tiles_.size()].sample.places;
        for (size_t r = 0; r < places.size(); ++r) {
            const uint32_t* const sum = &sums[LIGHT_PEER_SUM_WORDS * r];
            const WholeNormal normal = whole_normal(places[r].surface_class, places[r].tilt);
            const auto half = [&](size_t c) {
                return irradiance_half(part_along(normal, {sum[c], sum[3 + c], sum[6 + c]}));
            };
            words.push_back(half(0) | half(1) << 16);
            words.push_back(half(2) | IRRADIANCE_LIT << 16);
        }
        return words;
    }
    uint64_t resident_bytes() const override { return peer_.resident_bytes(); }

  private:
    const Device& device_;
    std::span<const TileData> tiles_;
    std::vector<std::array<double, 3>> directions_;
    LightPeer peer_;
};

double seconds_now(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class Bench {
  public:
    Bench(BenchProgram& program, const Device& device, const Options& options, int repetitions)
        : program_(program), device_(device), options_(options), repetitions_(repetitions) {}

    void run() {
        for (uint32_t i = 0; i < std::min(options_.distinct, options_.tiles); ++i) {
            auto tile = tile_data(options_, i);
            if (!program_.check(tile.ok(), tile.ok() ? "" : tile.error().text())) return;
            tiles_.push_back(std::move(*tile));
        }
        for (uint32_t i = 0; i < options_.tiles; ++i) receivers_ += tiles_[i % tiles_.size()].sample.places.size();
        const auto make_passes = [&](MatrixForm form) {
            return std::make_unique<Passes>(device_, tiles_, options_.tiles, form);
        };
        const auto make_peer = [&](Peer::Form form) {
            return std::make_unique<Peer>(device_, tiles_, options_.tiles, form);
        };
        // One after the other: together they take gigabytes.
        measure("biclusters", *make_passes(MatrixForm::kBiclusters));
        measure("rows", *make_passes(MatrixForm::kRows));
        measure("csr", *make_peer(Peer::Form::kRows));
        measure("csr-one-row", *make_peer(Peer::Form::kOneRow));
        measure("bits", *make_peer(Peer::Form::kBits));
    }

  private:
    void measure(const std::string& name, Method& method) {
        const uint32_t side = options_.sample.texels_across;
        std::vector<double> wall, processor;
        constexpr double kTurn = 0.3;
        uint64_t number = 0;
        for (int repetition = -1; repetition < repetitions_; ++repetition) {
            const WholeLight light = sky(side, kTurn * repetition);
            const double wall_begin = seconds_now(CLOCK_MONOTONIC);
            const double processor_begin = seconds_now(CLOCK_PROCESS_CPUTIME_ID);
            method.light_up(light, ++number);
            if (repetition < 0) continue;  // pipelines are compiled
            processor.push_back(1e3 * (seconds_now(CLOCK_PROCESS_CPUTIME_ID) - processor_begin));
            wall.push_back(1e3 * (seconds_now(CLOCK_MONOTONIC) - wall_begin));
        }
        const uint64_t mismatches = differing_words(method, sky(side, kTurn * (repetitions_ - 1)));
        const double median = spread_of(device_.is_cpu ? processor : wall).median;
        if (first_median_ == 0) first_median_ = median;
        program_.print({{"method", name},
                        {"device", device_.name},
                        {"city", options_.turned ? "turned" : "along the axes"},
                        {"lattice", options_.sample.lattice_metres},
                        {"tiles", options_.tiles},
                        {"receivers", receivers_},
                        {"resident_bytes", method.resident_bytes()},
                        {"cpu_ms", to_json(spread_of(processor))},
                        {"wall_ms", to_json(spread_of(wall))},
                        {"times_biclusters", rounded(median / first_median_)},
                        {"mismatches", mismatches}});
        program_.check(mismatches == 0, name + " gives the processor's words");
    }

    uint64_t differing_words(const Method& method, const WholeLight& light) const {
        std::vector<std::vector<uint32_t>> expected;
        for (const TileData& tile : tiles_) expected.push_back(expected_words(tile, light));
        uint64_t differ = 0;
        for (size_t i = 0; i < options_.tiles; ++i) {
            const auto words = method.words(i);
            const auto& wanted = expected[i % expected.size()];
            if (words.size() != wanted.size()) return wanted.size();
            for (size_t w = 0; w < words.size(); ++w) differ += words[w] == wanted[w] ? 0 : 1;
        }
        return differ;
    }

    BenchProgram& program_;
    const Device& device_;
    const Options& options_;
    int repetitions_;
    std::vector<TileData> tiles_;
    uint64_t receivers_ = 0;
    double first_median_ = 0;
};

std::vector<BenchOption> options_of(Options& options) {
    return {{"--tiles", "in GPU memory, 1 to 1000 (64)",
             [&](const std::string& text) { return take_number(text, 1U, 1000U, options.tiles); }},
            {"--distinct", "of them are different, 1 to 100; the others are copies (4)",
             [&](const std::string& text) { return take_number(text, 1U, 100U, options.distinct); }},
            {"--lattice", "metres between receivers: 1, 2, 4, 8 or 16 (4)",
             [&](const std::string& text) {
                 double& metres = options.sample.lattice_metres;
                 return take_number(text, 1.0, 16.0, metres) && std::exp2(std::round(std::log2(metres))) == metres;
             }},
            {"--turned", "yes: each tower is turned; no (the default)", [&](const std::string& text) {
                 options.turned = text == "yes";
                 return options.turned || text == "no";
             }}};
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    BenchDescription description{"bench_light_passes", kClaim, ""};
    description.generates = false;
    description.options = options_of(options);
    BenchProgram program(description);
    BenchOptions given;
    if (!program.read_arguments(argc, argv, given)) return program.exit_code();
    try {
        Instance instance = create_instance(false);
        const Result<VkPhysicalDevice> physical = choose_device(instance, "", enumerate_egl_devices());
        if (!physical) throw VulkanError(physical.error().text());
        Device device = create_device(*physical);
        Bench(program, device, options, given.repetitions).run();
        destroy_device(device);
        destroy_instance(instance);
    } catch (const VulkanError& error) {
        program.print_skipped(error.what());
    }
    return program.exit_code();
}

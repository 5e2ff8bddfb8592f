// Claim: strip streams are decoded by the GPU in a fraction of the time that their triangles take to be drawn, many
// small meshes in one batch nearly as fast as one large one.
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "client/render/device_choice.h"
#include "client/render/strip_decoder.h"
#include "client/render/strip_rounds.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/number_option.h"
#include "tests/client/render/strip_view.h"
#include "tests/codec/mesh/topology_meshes.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;
using codec::mesh::Topology;

constexpr const char* kClaim =
    "Strip streams decoded to index lists by the GPU: one large mesh (grid), the same with half as many edges turned "
    "at "
    "random as it has triangles\n(irregular), and thousands of tiles of some boxes each in one batch (tiles). Ways: "
    "passes and look-back (one pass a scan), each with lanes that\nshuffle in subgroups where the device has them; cpu "
    "(decode_strips on one core); draw (the decoded triangles, all in view, 1280x720); rounds\n(decoded and drawn with "
    "an eighth of the memory of the decoded triangles, nothing kept; of the tiles alone).\nmtri_per_s: median; "
    "share_of_draw: this / drawing; of_grid: rate / the grid's by the same way; times_cpu: rate / the processor's.\n"
    "Times are the GPU's own (timestamps); of a software device the process's CPU time. The thesis's table 5.3: up to "
    "1,720 Mtri/s on a GTX 580,\n6 to 30 % of the time to draw.";

constexpr uint32_t kWidth = 1280, kHeight = 720;

struct Set {
    std::string name;
    std::vector<std::vector<uint32_t>> streams;
    std::vector<uint32_t> vertices;  ///< two words each
    std::vector<uint32_t> first_vertex;
};

using Place = std::array<uint32_t, 3>;

/// `place`: where an input vertex lies on a grid of 2^16 steps.
void add_mesh(Set& set, const Topology& mesh, const std::function<Place(uint32_t)>& place) {
    const auto code = codec::mesh::encode_strips(mesh.triangles, mesh.vertices);
    set.streams.push_back(code->words);
    set.first_vertex.push_back(static_cast<uint32_t>(set.vertices.size() / 2));
    for (const uint32_t vertex : code->vertices) {
        const auto [x, y, z] = place(vertex);
        set.vertices.insert(set.vertices.end(), {x | y << 16, z});
    }
}

/// One mesh of about so many triangles, `turned` of its edges per triangle turned.
Set landscape(const std::string& name, uint32_t triangles, double turned) {
    const auto side = static_cast<uint32_t>(std::sqrt(triangles / 2));
    Topology mesh = codec::mesh::quad_grid(side, side, false);
    if (turned > 0) mesh = with_edges_flipped(std::move(mesh), static_cast<size_t>(turned * triangles));
    Set set{name, {}, {}, {}};
    add_mesh(set, mesh, [&](uint32_t vertex) {
        const uint32_t x = vertex % (side + 1), y = vertex / (side + 1);
        const double height = 3000 + 1500 * std::sin(20.0 * x / side) + 1500 * std::cos(16.0 * y / side);
        return Place{x * 65535 / side, y * 65535 / side, static_cast<uint32_t>(height)};
    });
    return set;
}

/// Tiles of 1 to 39 boxes.
Set city_tiles(uint32_t tiles) {
    const auto side = static_cast<uint32_t>(std::ceil(std::sqrt(tiles)));
    std::mt19937 random(1);
    Set set{"tiles", {}, {}, {}};
    for (uint32_t tile = 0; tile < tiles; ++tile) {
        const uint32_t boxes = 1 + static_cast<uint32_t>(random() % 39);
        const uint32_t step = 65535 / side;
        add_mesh(set, codec::mesh::welded_boxes(boxes), [&](uint32_t vertex) {
            const uint32_t box = vertex / 8, corner = vertex % 4;
            const uint32_t x = tile % side * step + box % 7 * step / 7, y = tile / side * step + box / 7 * step / 7;
            const bool east = corner == 1 || corner == 2, north = corner >= 2, top = vertex % 8 >= 4;
            return Place{x + (east ? step / 9 : 0), y + (north ? step / 9 : 0), top ? 300 + 37 * box : 0};
        });
    }
    return set;
}

/// The device and what measures its work.
class Stopwatch {
  public:
    explicit Stopwatch(const Device& device) : device_(device) {
        if (!by_timestamps()) return;
        auto info = vk_struct<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
        info.queryType = VK_QUERY_TYPE_TIMESTAMP;
        info.queryCount = 2;
        vk_check(vkCreateQueryPool(device.handle, &info, nullptr, &queries_), "vkCreateQueryPool");
    }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;
    ~Stopwatch() { vkDestroyQueryPool(device_.handle, queries_, nullptr); }

    bool by_timestamps() const { return !device_.is_cpu && device_.timestamp_nanoseconds > 0; }

    double seconds(const std::function<void(VkCommandBuffer)>& record) const {
        if (!by_timestamps()) return processor_seconds([&] { submit_and_wait(device_, record); });
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            vkCmdResetQueryPool(commands, queries_, 0, 2);
            vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, queries_, 0);
            record(commands);
            vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, 1);
        });
        uint64_t ticks[2];
        vk_check(vkGetQueryPoolResults(device_.handle, queries_, 0, 2, sizeof ticks, ticks, 8,
                                       VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
                 "vkGetQueryPoolResults");
        return static_cast<double>(ticks[1] - ticks[0]) * device_.timestamp_nanoseconds * 1e-9;
    }

    /// Of all threads.
    static double processor_seconds(const std::function<void()>& work) {
        const double begin = processor_now();
        work();
        return processor_now() - begin;
    }

  private:
    static double processor_now() {
        timespec now{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
        return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    }

    const Device& device_;
    VkQueryPool queries_ = VK_NULL_HANDLE;
};

/// A set in GPU memory.
struct Resident {
    std::vector<StripStream> streams;
    StripPlan plan;
    std::vector<StripDraw> draws;
    Buffer words, records, vertices, temporary, corners;
    StripRounds rounds;  ///< empty where a mesh does not fit one
    Buffer round_memory, round_records;
};

/// Rounds with an eighth of the memory.
void add_rounds(const Device& device, const StripDecoder& decoder, Resident& resident) {
    Result<StripRounds> rounds = plan_strip_rounds(decoder, resident.streams, 4 * resident.plan.sizes.corner_words / 8);
    if (!rounds) return;
    resident.rounds = std::move(*rounds);
    resident.round_memory = create_buffer(device, 2 * resident.rounds.half_bytes, BufferPlace::kDevice);
    resident.round_records = create_buffer(device, resident.rounds.records_bytes, BufferPlace::kUpload);
    write_records(resident.rounds, resident.round_records.mapped);
}

Resident upload(const Device& device, const Set& set, std::span<const StripDecoder> decoders) {
    Resident resident;
    size_t words = 0;
    for (const auto& stream : set.streams) words += stream.size();
    resident.words = create_buffer(device, 4 * words, BufferPlace::kUpload);
    size_t at = 0;
    for (const auto& stream : set.streams) {
        std::memcpy(static_cast<uint32_t*>(resident.words.mapped) + at, stream.data(), 4 * stream.size());
        resident.streams.push_back({resident.words.address | LAYER_REF_DIRECT, static_cast<uint32_t>(at),
                                    *codec::mesh::read_strip_header(stream)});
        at += stream.size();
    }
    resident.plan = *plan_strips(resident.streams);
    for (size_t i = 0; i < set.streams.size(); ++i) {
        const uint32_t corners = 3 * resident.streams[i].header.triangles;
        resident.draws.push_back({resident.plan.corners_at[i], corners, set.first_vertex[i]});
    }
    uint64_t temporary = 0;
    for (const StripDecoder& decoder : decoders)
        temporary = std::max(temporary, strip_temporary_words(decoder, resident.plan.sizes));
    const auto& records = resident.plan.records;
    resident.records = create_buffer(device, records.size() * sizeof records[0], BufferPlace::kUpload);
    std::memcpy(resident.records.mapped, records.data(), records.size() * sizeof records[0]);
    resident.vertices = create_buffer(device, 4 * set.vertices.size(), BufferPlace::kUpload);
    std::memcpy(resident.vertices.mapped, set.vertices.data(), 4 * set.vertices.size());
    resident.temporary = create_buffer(device, 4 * temporary, BufferPlace::kDevice);
    resident.corners = create_buffer(device, 4 * resident.plan.sizes.corner_words, BufferPlace::kDevice);
    add_rounds(device, decoders.back(), resident);
    return resident;
}

void forget(const Device& device, Resident& resident) {
    for (Buffer* buffer : {&resident.words, &resident.records, &resident.vertices, &resident.temporary,
                           &resident.corners, &resident.round_memory, &resident.round_records})
        destroy_buffer(device, *buffer);
}

void decode(VkCommandBuffer commands, const StripDecoder& decoder, const Resident& resident) {
    record_strip_decode(commands, decoder, resident.plan,
                        {{&resident.records, 0}, {&resident.temporary, 0}, {&resident.corners, 0}});
}

StripViewConstants view_of(const Resident& resident) {
    constexpr float kStep = 2.0f / 65536;
    StripViewConstants constants{
        {{kStep, 0, 0, -1}, {0, -0.8f * kStep, -kStep, 0.9f}, {0, -0.4f * kStep, 0, 0.9f}, {0, 0, 0, 1}}, {}};
    std::memcpy(constants.vertices, &resident.vertices.address, 8);
    return constants;
}

void draw(VkCommandBuffer commands, const StripView& view, const Resident& resident) {
    record_strip_view(commands, view, view_of(resident), {&resident.corners, 0}, resident.draws, true);
}

void draw_in_rounds(VkCommandBuffer commands, const StripDecoder& decoder, const StripView& view,
                    const Resident& resident) {
    const StripViewConstants constants = view_of(resident);
    const auto draw_round = [&](VkCommandBuffer, const StripRound& round, const BufferRange& corners) {
        std::vector<StripDraw> draws(resident.draws.begin() + static_cast<ptrdiff_t>(round.first),
                                     resident.draws.begin() + static_cast<ptrdiff_t>(round.first + round.count));
        for (size_t i = 0; i < draws.size(); ++i) draws[i].first_corner = round.plan.corners_at[i];
        record_strip_view(commands, view, constants, corners, draws, round.first == 0);
    };
    record_strip_rounds(commands, decoder, resident.rounds, resident.round_memory, resident.round_records, draw_round);
}

/// Whether the decoder's corners are decode_strips's.
bool decodes_right(const Device& device, const StripDecoder& decoder, const Set& set, const Resident& resident) {
    Buffer copy = create_buffer(device, resident.corners.bytes, BufferPlace::kReadback);
    submit_and_wait(device, [&](VkCommandBuffer commands) {
        vkCmdFillBuffer(commands, resident.corners.handle, 0, VK_WHOLE_SIZE, ~0u);
        memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT);
        decode(commands, decoder, resident);
        memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                       VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT);
        const VkBufferCopy all{0, 0, copy.bytes};
        vkCmdCopyBuffer(commands, resident.corners.handle, copy.handle, 1, &all);
        memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    });
    bool right = true;
    for (size_t i = 0; i < set.streams.size() && right; ++i) {
        const auto want = *codec::mesh::decode_strips(set.streams[i]);
        const uint32_t* got = static_cast<const uint32_t*>(copy.mapped) + resident.plan.corners_at[i];
        right = std::memcmp(want.data(), got, want.size() * sizeof want[0]) == 0;
    }
    destroy_buffer(device, copy);
    return right;
}

struct Way {
    std::string name;
    std::function<double()> seconds;  ///< of one run
    const StripDecoder* decoder = nullptr;
};

std::string name_of(const ScanTuning& tuning) {
    const std::string path = tuning.path == ScanPath::kLookBack ? "look-back" : "passes";
    return tuning.subgroups ? path + ", subgroups" : path;
}

std::vector<Way> ways_of(const Stopwatch& watch, std::span<const StripDecoder> decoders, const StripView& view,
                         const Set& set, const Resident& resident) {
    std::vector<Way> ways;
    for (const StripDecoder& each : decoders) {
        const auto run = [&] {
            return watch.seconds([&](VkCommandBuffer commands) { decode(commands, each, resident); });
        };
        ways.push_back({name_of(each.tuning), run, &each});
    }
    ways.push_back({"cpu", [&] {
                        return Stopwatch::processor_seconds([&] {
                            for (const auto& stream : set.streams) keep(codec::mesh::decode_strips(stream));
                        });
                    }});
    const StripDecoder& decoder = decoders.back();
    const auto draw_rounds = [&] {
        return watch.seconds([&](VkCommandBuffer commands) { draw_in_rounds(commands, decoder, view, resident); });
    };
    if (!resident.rounds.rounds.empty()) ways.push_back({"rounds", draw_rounds});
    ways.push_back(
        {"draw", [&] { return watch.seconds([&](VkCommandBuffer commands) { draw(commands, view, resident); }); }});
    return ways;
}

class Bench {
  public:
    Bench(BenchProgram& program, const Device& device, int repetitions)
        : program_(program), device_(device), watch_(device), repetitions_(repetitions) {
        for (const ScanPath path : {ScanPath::kPasses, ScanPath::kLookBack}) {
            decoders_.push_back(create_strip_decoder(device, {path, false}));
            if (subgroups_fit_scans(device)) decoders_.push_back(create_strip_decoder(device, {path, true}));
        }
        view_ = create_strip_view(device, kWidth, kHeight);
    }
    Bench(const Bench&) = delete;
    Bench& operator=(const Bench&) = delete;
    ~Bench() {
        destroy_strip_view(device_, view_);
        for (StripDecoder& decoder : decoders_) destroy_strip_decoder(device_, decoder);
    }

    void run(const Set& set) {
        Resident resident = upload(device_, set, decoders_);
        for (const StripDecoder& decoder : decoders_) {
            program_.check(decodes_right(device_, decoder, set, resident),
                           set.name + " by " + name_of(decoder.tuning) + " is what the processor decodes");
        }
        const std::vector<Way> ways = ways_of(watch_, decoders_, view_, set, resident);
        std::vector<std::vector<double>> seconds(ways.size());
        for (int repetition = -1; repetition < repetitions_; ++repetition) {
            for (size_t way = 0; way < ways.size(); ++way) {
                const double one = ways[way].seconds();
                if (repetition >= 0) seconds[way].push_back(one);  // the first compiles
            }
        }
        print_set(set, resident);
        for (size_t way = 0; way < ways.size(); ++way) print_way(set, resident, ways, seconds, way);
        forget(device_, resident);
    }

  private:
    void print_set(const Set& set, const Resident& resident) {
        const double triangles = static_cast<double>(resident.plan.sizes.corner_words) / 3;
        program_.print({{"set", set.name},
                        {"device", device_.name},
                        {"clock", watch_.by_timestamps() ? "GPU" : "processor"},
                        {"meshes", set.streams.size()},
                        {"triangles", resident.plan.sizes.corner_words / 3},
                        {"bits_per_triangle", rounded(8 * static_cast<double>(resident.words.bytes) / triangles)}});
    }

    void print_way(const Set& set, const Resident& resident, const std::vector<Way>& ways,
                   const std::vector<std::vector<double>>& seconds, size_t way) {
        const StripSizes& sizes = resident.plan.sizes;
        const double triangles = static_cast<double>(sizes.corner_words) / 3;
        const double rate = triangles * 1e-6 / spread_of(seconds[way]).median;
        if (set.name == "grid") grid_rates_[way] = rate;
        Json line = {{"set", set.name}, {"way", ways[way].name}, {"mtri_per_s", rounded(rate)}};
        const std::string& name = ways[way].name;
        if (name != "draw") line["share_of_draw"] = to_json(ratio_of(seconds[way], seconds.back()));
        if (name == "draw" || name == "rounds") {
            program_.print(line);
            return;
        }
        line["of_grid"] = rounded(rate / grid_rates_[way]);
        line["times_cpu"] = to_json(ratio_of(seconds[decoders_.size()], seconds[way]));
        if (ways[way].decoder != nullptr) {
            const double temporary = static_cast<double>(strip_temporary_words(*ways[way].decoder, sizes));
            line["temporary_words_per_reference"] = rounded(temporary / static_cast<double>(sizes.references));
        }
        program_.print(line);
    }

    BenchProgram& program_;
    const Device& device_;
    Stopwatch watch_;
    int repetitions_;
    std::vector<StripDecoder> decoders_;
    StripView view_;
    std::array<double, 8> grid_rates_{};
};

}  // namespace

int main(int argc, char** argv) {
    uint32_t triangles = 1'000'000, tiles = 10'000;
    BenchProgram program({"bench_strip_decoder",
                          kClaim,
                          "",
                          false,
                          {},
                          {{"--triangles", "of the large mesh (1000000)",
                            [&](const std::string& text) { return take_number(text, 2u, 100'000'000u, triangles); }},
                           {"--tiles", "number of tiles (10000)",
                            [&](const std::string& text) { return take_number(text, 1u, 1'000'000u, tiles); }}}});
    BenchOptions options;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    try {
        Instance instance = create_instance(false);
        const Result<VkPhysicalDevice> physical = choose_device(instance, "", enumerate_egl_devices());
        if (!physical) throw VulkanError(physical.error().text());
        Device device = create_device(*physical);
        {
            Bench bench(program, device, options.repetitions);
            bench.run(landscape("grid", triangles, 0));
            bench.run(landscape("irregular", triangles / 4, 0.5));
            bench.run(city_tiles(tiles));
        }
        destroy_device(device);
        destroy_instance(instance);
    } catch (const VulkanError& error) {
        program.print_skipped(error.what());
    }
    return program.exit_code();
}

#include "tiles/radiance/visibility_bake.h"

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <mutex>
#include <string>

#include "codec/radiance/frames.h"
#include "codec/radiance/source_directions.h"
#include "tiles/radiance/in_parallel.h"

namespace citystream::tiles::radiance {

namespace {

using codec::radiance::Frame;
using codec::radiance::GridDirection;

/// Of receivers: a thread's turn.
constexpr size_t kTurn = 8;
constexpr int64_t kRulesVersion = 4;

/// Sample directions in squares of 4 x 4 cells, whose rays go much the same way: a bundle.
struct SampleOrder {
    std::vector<uint32_t> sample;
    std::vector<GridDirection> exact;
    std::vector<RayDirection> direction;

    explicit SampleOrder(uint32_t texels_across) {
        constexpr uint32_t kSquare = 4;
        static_assert(kSquare * kSquare == OccluderScene::kBundle);
        const uint32_t side = codec::radiance::kSamplesAcross * texels_across;
        for (uint32_t face = 0; face < codec::radiance::kCubeFaces; ++face) {
            for (uint32_t square = 0; square < (side + kSquare - 1) / kSquare * side; ++square) {
                const uint32_t row = square / side * kSquare, column = square % side;
                for (uint32_t i = row; i < std::min(row + kSquare, side); ++i) add(face, i, column, side);
            }
        }
    }

  private:
    void add(uint32_t face, uint32_t row, uint32_t column, uint32_t side) {
        sample.push_back((face * side + row) * side + column);
        exact.push_back(codec::radiance::cell_direction(side, sample.back()));
        direction.push_back(ray_direction(exact.back()));
    }
};

/// The samples above one frame's plane, kept from receiver to receiver as long as the frame is the same.
class FrameSamples {
  public:
    explicit FrameSamples(const SampleOrder& order) : order_(order) {}

    void use(uint32_t frame_code) {
        if (used_ && frame_code == code_) return;
        used_ = true;
        code_ = frame_code;
        samples_.clear();
        directions_.clear();
        const Frame frame = codec::radiance::unpack_frame(frame_code);
        for (size_t i = 0; i < order_.sample.size(); ++i) {
            if (!frame.sees(order_.exact[i])) continue;
            samples_.push_back(order_.sample[i]);
            directions_.push_back(order_.direction[i]);
        }
        blocked_.resize((samples_.size() + 63) / 64);
    }

    void cast(const GridPoint& from, const OccluderScene& scene, std::span<uint32_t> words) {
        scene.blocked(from, directions_, blocked_);
        for (size_t i = 0; i < samples_.size(); ++i) {
            if ((blocked_[i / 64] >> i % 64 & 1) == 0) words[samples_[i] / 32] |= 1U << samples_[i] % 32;
        }
    }
    size_t rays() const { return directions_.size(); }

  private:
    const SampleOrder& order_;
    bool used_ = false;
    uint32_t code_ = 0;
    std::vector<uint32_t> samples_;
    std::vector<RayDirection> directions_;
    std::vector<uint64_t> blocked_;
};

bool cancelled(const BakeOptions& options) {
    return options.cancel != nullptr && options.cancel->load();
}

void add_to(StartBox& box, const GridPoint& point) {
    box.low = {std::min(box.low.x, point.x), std::min(box.low.y, point.y), std::min(box.low.z, point.z)};
    box.high = {std::max(box.high.x, point.x), std::max(box.high.y, point.y), std::max(box.high.z, point.z)};
}

StartBox box_of(std::span<const SurfaceTriangle> triangles) {
    StartBox box{{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN, INT64_MIN}};
    for (const SurfaceTriangle& triangle : triangles) {
        for (const GridPoint& corner : triangle.corners) add_to(box, corner);
    }
    return box;
}

/// Where rays of a tile may begin: a receiver stands near its tile's surfaces, but perhaps on a neighbour's.
StartBox start_box(std::span<const SurfaceTriangle> own, int64_t spacing) {
    StartBox box = box_of(own);
    const int64_t margin = kDecisiveSpacings * spacing + kLiftOff;
    box.low = {box.low.x - margin, box.low.y - margin, box.low.z - margin};
    box.high = {box.high.x + margin, box.high.y + margin, box.high.z + margin};
    return box;
}

using TriangleKey = std::array<int64_t, 9>;

/// Appends the triangles that meet a box, in an order of their own.
void append_triangles(std::vector<int64_t>& numbers, std::span<const SurfaceTriangle> triangles,
                      const GridPoint& corner, const StartBox& box) {
    std::vector<TriangleKey> keys;
    for (const SurfaceTriangle& triangle : triangles) {
        if (!meets(triangle, box)) continue;
        TriangleKey key{};
        for (size_t i = 0; i < 3; ++i) {
            const GridPoint& point = triangle.corners[i];
            key[3 * i] = point.x - corner.x;
            key[3 * i + 1] = point.y - corner.y;
            key[3 * i + 2] = point.z;
        }
        keys.push_back(key);
    }
    std::sort(keys.begin(), keys.end());
    numbers.push_back(static_cast<int64_t>(keys.size()));
    for (const TriangleKey& key : keys) numbers.insert(numbers.end(), key.begin(), key.end());
}

void append_heights(std::vector<int64_t>& numbers, const HeightGrid& heights, const StartBox& box) {
    const HeightCell low = height_cell_of(box.low.x, box.low.y), high = height_cell_of(box.high.x, box.high.y);
    for (int64_t y = low.y; y <= high.y; ++y) {
        for (int64_t x = low.x; x <= high.x; ++x) numbers.push_back(heights.height({x, y}).value_or(INT64_MIN));
    }
}

int64_t remainder_of(int64_t value, int64_t divisor) {
    return (value % divisor + divisor) % divisor;
}

}  // namespace

uint32_t frame_of(const Receiver& receiver) {
    return codec::radiance::pack_frame(receiver_normal(receiver.surface_class, receiver.tilt));
}

bool cast_visibility(std::span<const Receiver> receivers, const OccluderScene& scene, const BakeOptions& options,
                     BakedTile& result) {
    auto& visibility = result.visibility;
    visibility = {.side = options.texels_across, .frames = {}, .frame_of = {}, .words = {}};
    for (const Receiver& receiver : receivers) visibility.add_receiver(frame_of(receiver));

    const SampleOrder order(options.texels_across);
    const size_t words = visibility.words_a_receiver();
    std::mutex mutex;
    uint64_t done = 0;
    return in_parallel((receivers.size() + kTurn - 1) / kTurn, options.lattice.jobs, [&](size_t turn) {
        if (cancelled(options)) return false;
        FrameSamples samples(order);
        const size_t end = std::min(receivers.size(), (turn + 1) * kTurn);
        uint64_t rays = 0;
        for (size_t i = turn * kTurn; i < end; ++i) {
            const Receiver& receiver = receivers[i];
            samples.use(visibility.frames[visibility.frame_of[i]]);
            samples.cast(lifted(receiver.point, receiver_normal(receiver.surface_class, receiver.tilt)), scene,
                         std::span(visibility.words).subspan(i * words, words));
            rays += samples.rays();
        }
        const std::lock_guard lock(mutex);
        result.rays += rays;
        done += end - turn * kTurn;
        if (options.progress) options.progress(done, receivers.size());
        return true;
    });
}

Result<BakedTile> bake_tile(const BakeInput& input, const BakeOptions& options) {
    BakedTile result;
    result.visibility.side = options.texels_across;
    if (input.own.empty()) return result;
    std::vector<SurfaceTriangle> all(input.own.begin(), input.own.end());
    all.insert(all.end(), input.around.begin(), input.around.end());
    const auto scene =
        OccluderScene::create(all, input.heights, start_box(input.own, options.lattice.spacing), options.reach);
    if (!scene) return scene.error();
    if (cancelled(options)) return Error{"interrupted"};
    result.receivers = place_receivers(input.own, input.around, *scene, options.lattice);
    if (result.receivers.size() > codec::radiance::kMostReceivers) {
        return Error{"a tile's lattice has " + std::to_string(result.receivers.size()) + " receivers, " +
                     std::to_string(codec::radiance::kMostReceivers) + " are possible: a wider lattice has fewer"};
    }
    if (options.placed) options.placed(result.receivers.size());
    if (!cast_visibility(result.receivers, *scene, options, result)) return Error{"interrupted"};
    return result;
}

uint64_t bake_hash(const BakeInput& input, const BakeOptions& options, const GridPoint& corner) {
    std::vector<int64_t> numbers = {kRulesVersion,
                                    options.lattice.spacing,
                                    std::bit_cast<int64_t>(options.lattice.least_share),
                                    options.texels_across,
                                    to_grid(options.reach.triangles),
                                    to_grid(options.reach.horizon),
                                    remainder_of(corner.x, options.lattice.spacing),
                                    remainder_of(corner.y, options.lattice.spacing),
                                    remainder_of(corner.x, kHeightCell),
                                    remainder_of(corner.y, kHeightCell)};
    if (!input.own.empty()) {
        const StartBox start = start_box(input.own, options.lattice.spacing);
        append_triangles(numbers, input.own, corner, start);
        append_triangles(numbers, input.around, corner, widened(start, options.reach.triangles));
        if (input.heights != nullptr) append_heights(numbers, *input.heights, widened(start, options.reach.horizon));
    }
    return XXH3_64bits(numbers.data(), numbers.size() * sizeof(int64_t));
}

}  // namespace citystream::tiles::radiance

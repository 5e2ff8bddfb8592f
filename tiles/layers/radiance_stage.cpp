#include "tiles/layers/radiance_stage.h"

#ifdef CITYSTREAM_HAS_EMBREE

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/visibility_smoothing.h"
#include "codec/radiance/visibility_wire.h"
#include "tiles/layers/build_stage.h"
#include "tiles/layers/earlier_radiance.h"
#include "tiles/layers/memory_pass.h"
#include "tiles/layers/tile_surface.h"
#include "tiles/radiance/city_heights.h"
#include "tiles/radiance/visibility_bake.h"

#endif

namespace citystream::tiles::layers {

#ifdef CITYSTREAM_HAS_EMBREE

namespace {

using quadtree::GridBox;
using quadtree::TileNode;
using radiance::BakeInput;
using radiance::BakeOptions;
using tileset::Layer;

/// Of what the layers of equal tiles depend on besides their surfaces: raised with whatever changes their bytes.
constexpr uint64_t kLayerVersion = 2;

// What a tile takes while it is baked, in bytes.
constexpr uint64_t kBytesPerTile = 4 << 20;
constexpr uint64_t kBytesPerTriangle = 600;   // of its own and those around: read, copied, and in Embree's scene
constexpr uint64_t kBytesPerCandidate = 100;  // columns under a triangle
constexpr uint64_t kBytesPerCell = 1000;      // of the horizon, in Embree's scene
constexpr uint64_t kBytesPerReceiver = 256;
constexpr uint64_t kBytesPerTexel = 5;  // of the source, for each receiver: bits, and its rows while it is encoded

class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

  private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

bool overlap(const GridBox& a, const GridBox& b) {
    return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y;
}

/// How far from a tile's surface what is there may count: metres.
double halo_metres(double spacing_metres, double reach_metres) {
    return static_cast<double>(radiance::kDecisiveSpacings) * spacing_metres + reach_metres + 1;
}

GridBox widened(const GridBox& box, double metres) {
    const int64_t margin = to_grid(metres);
    GridBox wide = box;
    wide.lo.x -= margin;
    wide.lo.y -= margin;
    wide.hi.x += margin;
    wide.hi.y += margin;
    return wide;
}

/// At most so many columns of a lattice have a part of the surface in their squares.
uint64_t candidates_of(std::span<const radiance::SurfaceTriangle> surface, double spacing) {
    double columns = 0;
    for (const radiance::SurfaceTriangle& triangle : surface) {
        const auto normal = radiance::exact_normal(triangle);
        const auto x = static_cast<double>(normal[0]), y = static_cast<double>(normal[1]),
                   z = static_cast<double>(normal[2]);
        const double area = std::sqrt(x * x + y * y + z * z) / 2;
        columns += area / (spacing * spacing) + 4 * std::sqrt(area) / spacing + 4;
    }
    return static_cast<uint64_t>(columns);
}

/// A node's place among all, and what is known of it without reading its surface.
struct NodeSurface {
    quadtree::SpoolRange range;
    GridBox box;    ///< of its surface
    GridBox below;  ///< of its surface and of all below it
    uint64_t triangles() const { return range.size / sizeof(radiance::SurfaceTriangle); }
};

class BakingStage final : public RadianceStage {
  public:
    BakingStage(const RadianceInput& input, std::unique_ptr<quadtree::SpoolFile> spool)
        : in_(input), form_(input.options.radiance), spool_(std::move(spool)), heights_(input.lowest) {
        report_.transport = form_.transport;
        surfaces_.resize(in_.tree.nodes.size());
        candidates_.resize(in_.tree.nodes.size());
    }

    Status add(size_t node, std::span<const quadtree::BuildObject> objects) override {
        const Surface surface = surface_of(objects);
        auto range = append_surface(*spool_, surface);
        if (!range) return range.error();
        surfaces_[node] = {*range, box_of(surface), {}};
        const uint32_t metres = lattice_of(node);
        if (metres > 0) candidates_[node] = candidates_of(surface, metres * kGridUnitsPerMetre);
        if (in_.tree.nodes[node].leaf) add_heights(surface);
        return Done{};
    }

    Status run(std::span<BuiltTile> tiles) override {
        const Stopwatch watch;
        join_boxes();
        open_earlier();
        report_.horizon_bytes = heights_.bytes();
        gate_.emplace(std::max(in_.work_bytes - std::min(in_.work_bytes, report_.horizon_bytes), in_.work_bytes / 4));
        BuildStage stage(in_.options, "radiance", tiles.size());
        Status status = stage.run(tiles.size(), [&](size_t at) { return make(at, tiles[at]); });
        if (!status) return status;
        if (earlier_ && earlier_->damaged() > 0)
            note(in_.options.output, fmt::format("{} radiance layers of the archive that was there are damaged, and "
                                                 "were baked again",
                                                 earlier_->damaged()));
        report_.seconds = watch.seconds();
        return Done{};
    }

    const RadianceReport& report() const override { return report_; }

    std::vector<city::Defect> take_defects() override {
        std::sort(defects_.begin(), defects_.end(),
                  [](const city::Defect& a, const city::Defect& b) { return a.feature < b.feature; });
        return std::move(defects_);
    }

  private:
    uint64_t side_metres(size_t node) const {
        return static_cast<uint64_t>(in_.tree.side(in_.tree.nodes[node].address.level)) >> kGridBits;
    }

    uint32_t lattice_of(size_t node) const {
        return lattice_of_tile(form_, side_metres(node), in_.tree.nodes[node].leaf);
    }

    /// Heights are 32 bits above the city's lowest point.
    void add_heights(const Surface& surface) {
        constexpr int64_t kHighest = INT32_MAX;
        Surface held;
        std::copy_if(surface.begin(), surface.end(), std::back_inserter(held), [&](const auto& triangle) {
            return std::all_of(triangle.corners.begin(), triangle.corners.end(),
                               [&](const GridPoint& corner) { return corner.z - in_.lowest < kHighest; });
        });
        heights_.add(held);
    }

    void join_boxes() {
        // Children come after their parent.
        for (size_t at = surfaces_.size(); at-- > 0;) {
            surfaces_[at].below.add(surfaces_[at].box);
            for (const int32_t child : in_.tree.nodes[at].children)
                if (child >= 0) surfaces_[at].below.add(surfaces_[static_cast<size_t>(child)].below);
        }
    }

    void open_earlier() {
        if (!form_.reuse) return;
        auto earlier = EarlierRadiance::open(in_.options.output);
        if (earlier) {
            earlier_ = std::move(earlier).value();
        } else {
            note(in_.options.output,
                 "nothing of the file that was there is used again: it is no whole archive of a city (" +
                     earlier.error().text() + ")");
        }
    }

    void note(std::string feature, std::string what) {
        const std::lock_guard lock(mutex_);
        defects_.push_back({std::move(feature), std::move(what), "", false});
    }

    /// The nodes whose surfaces meet a box, of those that are drawn beside a node, without itself.
    std::vector<size_t> beside(size_t node, const GridBox& box) const {
        const TileNode& self = in_.tree.nodes[node];
        std::vector<size_t> found, open = {0};
        while (!open.empty()) {
            const size_t at = open.back();
            open.pop_back();
            const TileNode& other = in_.tree.nodes[at];
            if (!overlap(surfaces_[at].below, box)) continue;
            if (other.leaf || (!self.leaf && other.address.level == self.address.level)) {
                if (at != node && overlap(surfaces_[at].box, box)) found.push_back(at);
                continue;
            }
            for (const int32_t child : other.children)
                if (child >= 0) open.push_back(static_cast<size_t>(child));
        }
        std::sort(found.begin(), found.end());
        return found;
    }

    /// What of the neighbours' surfaces is within a box.
    Result<Surface> surface_around(size_t node, const GridBox& box) {
        const radiance::StartBox bounds{box.lo, box.hi};
        Surface around;
        for (const size_t other : beside(node, box)) {
            const auto surface = read_surface(*spool_, surfaces_[other].range);
            if (!surface) return surface.error();
            std::copy_if(surface->begin(), surface->end(), std::back_inserter(around),
                         [&](const auto& triangle) { return radiance::meets(triangle, bounds); });
        }
        return around;
    }

    radiance::HeightGrid heights_around(const GridBox& box) const {
        return heights_.part(radiance::height_cell_of(box.lo.x, box.lo.y),
                             radiance::height_cell_of(box.hi.x, box.hi.y));
    }

    BakeOptions bake_options(size_t node, uint32_t metres) const {
        BakeOptions bake;
        bake.lattice.spacing = int64_t{metres} << kGridBits;
        bake.lattice.jobs = jobs_a_tile();
        bake.lattice.least_share = in_.tree.nodes[node].leaf ? kLeastShareOfLeaf : kLeastShareOfInner;
        bake.texels_across = form_.texels_across;
        bake.cancel = in_.options.cancel;
        return bake;
    }

    /// Threads within a tile, where there are fewer tiles than threads.
    uint32_t jobs_a_tile() const {
        const uint32_t jobs =
            in_.options.jobs != 0 ? in_.options.jobs : std::max(1U, std::thread::hardware_concurrency());
        return std::max<uint32_t>(1, jobs / static_cast<uint32_t>(std::max<size_t>(1, surfaces_.size())));
    }

    /// Before its receivers are known.
    uint64_t scene_bytes(size_t node, const BakeOptions& bake) const {
        const NodeSurface& own = surfaces_[node];
        const double spacing = to_metres(bake.lattice.spacing);
        uint64_t triangles = own.triangles();
        for (const size_t other : beside(node, widened(own.box, halo_metres(spacing, bake.reach.triangles))))
            triangles += surfaces_[other].triangles();
        const GridBox far = widened(own.box, halo_metres(spacing, bake.reach.horizon));
        const auto cells = [](int64_t length) { return static_cast<uint64_t>(length / radiance::kHeightCell) + 2; };
        return kBytesPerTile + kBytesPerTriangle * triangles + kBytesPerCandidate * candidates_[node] +
               kBytesPerCell * cells(far.hi.x - far.lo.x) * cells(far.hi.y - far.lo.y);
    }

    uint64_t receiver_bytes(uint64_t receivers) const {
        return receivers * (kBytesPerReceiver + kBytesPerTexel * codec::radiance::texel_count(form_.texels_across));
    }

    /// The bake's number with what the layer depends on besides.
    uint64_t layer_hash(const BakeInput& input, const BakeOptions& bake, const GridPoint& corner) const {
        const std::array<uint64_t, 4> parts = {kLayerVersion, form_.local_across, static_cast<uint64_t>(corner.z),
                                               radiance::bake_hash(input, bake, {corner.x, corner.y, 0})};
        const uint64_t exact = tileset::checksum_of(parts.data(), sizeof(parts));
        if (form_.error == 0) return exact;
        const std::array<uint64_t, 2> with_error = {exact, std::bit_cast<uint64_t>(form_.error)};
        return tileset::checksum_of(with_error.data(), sizeof(with_error));
    }

    /// What came of one lattice: with a fault there is no layer, and a wider lattice may have one.
    struct Attempt {
        bool layer = false;
        std::string fault{};
    };

    Status make(size_t node, BuiltTile& tile) {
        if (surfaces_[node].range.size == 0) return Done{};
        const uint32_t asked = lattice_of(node);
        std::string fault = fmt::format("it is wider than {} m", kWidestRadianceTileMetres);
        for (uint32_t metres = asked; metres > 0 && metres <= kWidestLatticeMetres; metres *= 2) {
            const auto made = make_on(node, bake_options(node, metres), tile);
            if (!made) return made.error();
            fault = made->fault;
            if (!fault.empty()) continue;
            const std::lock_guard lock(mutex_);
            report_.tiles += made->layer ? 1 : 0;
            report_.widened += made->layer && metres > asked ? 1 : 0;
            return Done{};
        }
        const auto& [level, x, y] = tile.record.address;
        note(fmt::format("tile {}/{}/{}", level, x, y), "it has no radiance layer: " + fault);
        const std::lock_guard lock(mutex_);
        ++report_.left_out;
        return Done{};
    }

    Result<Attempt> make_on(size_t node, const BakeOptions& options, BuiltTile& tile) {
        const uint64_t scene = scene_bytes(node, options);
        MemoryPass pass(*gate_, scene);
        const auto own = read_surface(*spool_, surfaces_[node].range);
        if (!own) return own.error();
        const GridBox& box = surfaces_[node].box;
        const double spacing = to_metres(options.lattice.spacing);
        const auto around = surface_around(node, widened(box, halo_metres(spacing, options.reach.triangles)));
        if (!around) return around.error();
        const radiance::HeightGrid heights = heights_around(widened(box, halo_metres(spacing, options.reach.horizon)));
        const BakeInput input{*own, *around, &heights};
        const GridPoint corner = in_.tree.corner(in_.tree.nodes[node].address);
        const GridPoint origin = {corner.x, corner.y, tile.record.base_height};
        const uint64_t hash = layer_hash(input, options, origin);
        if (earlier_) {
            const auto layer = earlier_->find(hash);
            if (layer && layer->transport == form_.transport) return reuse(*layer, tile);
            const auto steps = layer ? recode(*layer, hash, scene, pass) : std::nullopt;
            if (steps) return reuse_recoded(*steps, tile);
        }
        BakeOptions bake = options;
        bake.placed = [&](uint64_t receivers) { pass.change(scene + receiver_bytes(receivers)); };
        const Stopwatch watch;
        auto baked = radiance::bake_tile(input, bake);
        if (cancelled()) return Error{"interrupted"};
        if (!baked) return Attempt{false, baked.error().text()};
        return encode(std::move(*baked), options, origin, hash, watch.seconds(), tile);
    }

    bool cancelled() const { return in_.options.cancel != nullptr && in_.options.cancel->load(); }

    Result<Attempt> encode(radiance::BakedTile baked, const BakeOptions& bake, const GridPoint& origin, uint64_t hash,
                           double bake_seconds, BuiltTile& tile) {
        const Stopwatch watch;
        const uint64_t receivers = baked.receivers.size();
        if (receivers > 0) {
            codec::radiance::RadianceTile layer;
            layer.spacing_log2 = static_cast<uint32_t>(std::countr_zero(static_cast<uint64_t>(bake.lattice.spacing)));
            layer.places = radiance::places_of(baked.receivers, origin, bake.lattice.spacing);
            layer.visibility = std::move(baked.visibility);
            const double error = codec::radiance::smooth_visibility(layer.visibility, form_.error);
            const auto steps =
                codec::radiance::encode_radiance_layer(layer, form_.local_across, hash, error, form_.transport);
            if (!steps) return Attempt{false, steps.error().text()};
            if (Status kept = keep(*steps, tile); !kept) return kept.error();
        }
        const std::lock_guard lock(mutex_);
        report_.baked += receivers > 0 ? 1 : 0;
        report_.receivers += receivers;
        report_.rays += baked.rays;
        report_.bake_seconds += bake_seconds;
        report_.encode_seconds += watch.seconds();
        return Attempt{receivers > 0};
    }

    Status keep(std::span<const codec::radiance::RadianceLayerStep> steps, BuiltTile& tile) {
        std::vector<std::byte> bytes;
        std::vector<tileset::StepRecord> records;
        for (const auto& step : steps) {
            bytes.insert(bytes.end(), step.wire.begin(), step.wire.end());
            records.push_back({bytes.size(), step.decoded_bytes, step.error,
                               tileset::checksum_of(step.wire.data(), step.wire.size())});
        }
        return keep(bytes, std::move(records), tile);
    }

    Status keep(std::span<const std::byte> bytes, std::vector<tileset::StepRecord> steps, BuiltTile& tile) {
        auto range = in_.layer_spool.append(bytes);
        if (!range) return range.error();
        tile.layers[static_cast<size_t>(Layer::kRadiance)] = *range;
        tile.record.steps(Layer::kRadiance) = std::move(steps);
        return Done{};
    }

    Result<Attempt> reuse(const EarlierRadiance::Layer& layer, BuiltTile& tile) {
        if (Status kept = keep(layer.bytes, layer.steps, tile); !kept) return kept.error();
        const std::lock_guard lock(mutex_);
        ++report_.reused;
        return Attempt{true};
    }

    /// A layer that travelled as visibility in the transport that is asked for: of all its bits, the bytes that a bake
    /// would give. Nothing: it did not, or it cannot be read.
    std::optional<std::vector<codec::radiance::RadianceLayerStep>> recode(const EarlierRadiance::Layer& layer,
                                                                          uint64_t hash, uint64_t scene,
                                                                          MemoryPass& pass) {
        if (layer.transport != codec::radiance::RadianceTransport::kVisibility ||
            layer.steps.size() != codec::radiance::kVisibilitySteps)
            return std::nullopt;
        const Stopwatch watch;
        std::vector<std::span<const std::byte>> wire;
        uint64_t begin = 0, decoded_bytes = 0;
        for (const tileset::StepRecord& step : layer.steps) {
            wire.push_back(layer.bytes.subspan(begin, step.end - begin));
            begin = step.end;
            decoded_bytes += step.decoded_bytes;
        }
        const auto receivers = codec::radiance::read_receiver_count(wire[0], decoded_bytes);
        if (!receivers) return std::nullopt;
        pass.change(scene + receiver_bytes(*receivers));
        const auto bits = codec::radiance::decode_radiance_tile(wire, decoded_bytes);
        if (!bits) return std::nullopt;
        auto steps = codec::radiance::encode_radiance_layer(*bits, form_.local_across, hash, layer.steps.back().error,
                                                            form_.transport);
        if (!steps) return std::nullopt;
        const std::lock_guard lock(mutex_);
        report_.encode_seconds += watch.seconds();
        return std::move(*steps);
    }

    Result<Attempt> reuse_recoded(std::span<const codec::radiance::RadianceLayerStep> steps, BuiltTile& tile) {
        if (Status kept = keep(steps, tile); !kept) return kept.error();
        const std::lock_guard lock(mutex_);
        ++report_.reused;
        ++report_.recoded;
        return Attempt{true};
    }

    const RadianceInput in_;
    const RadianceForm form_;
    std::unique_ptr<quadtree::SpoolFile> spool_;
    radiance::CityHeights heights_;
    std::vector<NodeSurface> surfaces_;  // by node
    std::vector<uint64_t> candidates_;   // by node: columns under its triangles
    std::unique_ptr<EarlierRadiance> earlier_;
    std::optional<MemoryGate> gate_;
    std::mutex mutex_;
    RadianceReport report_;
    std::vector<city::Defect> defects_;
};

}  // namespace

Result<std::unique_ptr<RadianceStage>> RadianceStage::create(const RadianceInput& input) {
    auto spool = quadtree::SpoolFile::create(input.folder + "/surfaces");
    if (!spool) return spool.error();
    return std::unique_ptr<RadianceStage>(std::make_unique<BakingStage>(input, std::move(spool).value()));
}

#else

Result<std::unique_ptr<RadianceStage>> RadianceStage::create(const RadianceInput& input) {
    return check_radiance_form(input.options.radiance).error();
}

#endif

}  // namespace citystream::tiles::layers

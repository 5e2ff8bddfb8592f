#include "tiles/layers/tile_pipeline.h"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <iterator>
#include <mutex>
#include <optional>
#include <thread>

#include "tiles/layers/coarsen.h"
#include "tiles/layers/flat_ground.h"
#include "tiles/layers/hidden_faces.h"
#include "tiles/layers/party_walls.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::TileNode;

constexpr double kLeafTexel = 0.02;
constexpr double kPixelsAcrossTile = 512;  // an inner tile's error is its side over this
// The decimated ground keeps its border, so beside a tile of another level a gap is no deeper than their errors, and
// no wider than the tolerance on the screen. A skirt that hangs deeper shows where a city ends at a tile's border.
constexpr double kSkirtErrors = 1, kPictureSkirtErrors = 2, kSkirtLeastMetres = 0.25;
constexpr uint64_t kInnerTriangles = 49152;
constexpr uint64_t kBytesPerTriangle = 2000;  // estimate of what a tile takes while it is coarsened and encoded
constexpr uint64_t kBytesPerTile = 16 << 20;

/// Lets threads into work while the sum of what they announced fits; one may always go on.
class MemoryGate {
  public:
    explicit MemoryGate(uint64_t budget) : budget_(budget) {}
    void enter(uint64_t bytes) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return used_ == 0 || used_ + bytes <= budget_; });
        used_ += bytes;
    }
    void leave(uint64_t bytes) {
        const std::lock_guard lock(mutex_);
        used_ -= bytes;
        changed_.notify_all();
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    uint64_t budget_, used_ = 0;
};

/// Pictures (count, then width, height, metres a texel and texels of each), then objects.
std::vector<std::byte> serialise_content(const TileContent& content) {
    std::vector<std::byte> bytes;
    const auto put = [&bytes](const void* data, size_t size) {
        const auto* begin = static_cast<const std::byte*>(data);
        bytes.insert(bytes.end(), begin, begin + size);
    };
    const auto count = static_cast<uint32_t>(content.ground_pictures.size());
    put(&count, sizeof(count));
    for (const ChartImage& picture : content.ground_pictures) {
        put(&picture.width, sizeof(picture.width));
        put(&picture.height, sizeof(picture.height));
        put(&picture.metres_per_texel, sizeof(picture.metres_per_texel));
        put(picture.rgb.data(), picture.rgb.size());
    }
    for (const BuildObject& object : content.objects) serialise(object, bytes);
    return bytes;
}

Result<TileContent> deserialise_content(std::span<const std::byte> bytes) {
    const Error damaged{"temporary content file is damaged"};
    const auto take = [&bytes](void* data, size_t size) {
        if (bytes.size() < size) return false;
        std::memcpy(data, bytes.data(), size);
        bytes = bytes.subspan(size);
        return true;
    };
    TileContent content;
    uint32_t count = 0;
    if (!take(&count, sizeof(count))) return damaged;
    for (uint32_t i = 0; i < count; ++i) {
        ChartImage picture;
        if (!take(&picture.width, 4) || !take(&picture.height, 4) || !take(&picture.metres_per_texel, 4))
            return damaged;
        const size_t size = size_t{3} * picture.width * picture.height;
        if (size > bytes.size()) return damaged;
        picture.rgb.resize(size);
        if (!take(picture.rgb.data(), size)) return damaged;
        content.ground_pictures.push_back(std::move(picture));
    }
    auto objects = quadtree::deserialise_all(bytes);
    if (!objects) return objects.error();
    content.objects = std::move(objects).value();
    return content;
}

class Pipeline {
  public:
    explicit Pipeline(const PipelineInput& input)
        : in_(input), gate_(input.options.memory_limit / 2), built_(input.tree.nodes.size()) {}

    Result<std::vector<BuiltTile>> run() {
        for (uint32_t level = in_.tree.levels(); level-- > 0;) {
            std::vector<size_t> nodes;
            for (size_t i = 0; i < in_.tree.nodes.size(); ++i) {
                if (in_.tree.nodes[i].address.level == level) nodes.push_back(i);
            }
            run_level(nodes);
            if (error_) return *error_;
        }
        return std::move(built_);
    }

  private:
    void run_level(const std::vector<size_t>& nodes) {
        std::atomic<size_t> next = 0;
        const auto work = [&] {
            for (size_t i = next++; i < nodes.size() && !stopped(); i = next++) {
                const TileNode& node = in_.tree.nodes[nodes[i]];
                const uint64_t bytes = kBytesPerTile + kBytesPerTriangle * std::min(node.weight, 4 * kInnerTriangles);
                gate_.enter(bytes);
                const Status status = node.leaf ? build_leaf(nodes[i]) : build_inner(nodes[i]);
                gate_.leave(bytes);
                finish_one(status);
            }
        };
        const uint32_t jobs =
            in_.options.jobs != 0 ? in_.options.jobs : std::max(1U, std::thread::hardware_concurrency());
        std::vector<std::jthread> threads;
        for (uint32_t i = 1; i < std::min<size_t>(jobs, nodes.size()); ++i) threads.emplace_back(work);
        work();
    }

    bool stopped() {
        const std::lock_guard lock(mutex_);
        if (!error_ && in_.options.cancel != nullptr && in_.options.cancel->load()) error_ = Error{"interrupted"};
        return error_.has_value();
    }

    void finish_one(const Status& status) {
        const std::lock_guard lock(mutex_);
        if (!status && !error_) error_ = status.error();
        ++done_;
        if (in_.options.progress) in_.options.progress("tiles", done_, in_.tree.nodes.size());
    }

    double side_metres(const TileNode& node) const { return to_metres(in_.tree.side(node.address.level)); }

    TileSpec spec_of(const TileNode& node) const {
        TileSpec spec;
        spec.address = node.address;
        spec.corner = in_.tree.corner(node.address);
        spec.side = in_.tree.side(node.address.level);
        spec.texel = kLeafTexel;
        if (node.address.level > 0) spec.parent_error = level_error(2 * side_metres(node));
        spec.skirt_metres = kSkirtErrors * level_error(2 * side_metres(node)) + kSkirtLeastMetres;
        return spec;
    }

    /// What lies in a leaf. Neighbours are looked at within it: a party wall on a tile's border stays dressed.
    Result<std::vector<BuildObject>> leaf_objects(size_t at) {
        const TileNode& node = in_.tree.nodes[at];
        auto objects = in_.objects.load(node.begin, node.end);
        if (!objects) return objects;
        for (BuildObject& object : *objects) {
            for (quadtree::BuildFacade& facade : object.facades) facade.map = in_.workshop.numbers.shown[facade.map];
        }
        if (in_.options.dress_seed) built_[at].hidden_facades = hide_party_walls(*objects, in_.workshop.facades);
        if (in_.made_up_ground) {
            objects->push_back(flat_ground_of_tile(in_.objects.extent(), in_.tree.corner(node.address),
                                                   in_.tree.side(node.address.level)));
        }
        return objects;
    }

    Status build_leaf(size_t at) {
        const TileNode& node = in_.tree.nodes[at];
        auto content = content_of(at);
        if (!content) return content.error();
        in_.preview.draw(content->objects);
        return keep(at, encode_tile(spec_of(node), *content, in_.workshop));
    }

    Result<TileContent> child_content(const TileNode& node) {
        TileContent all;
        for (int32_t child : node.children) {
            if (child < 0) continue;
            auto content = content_of(static_cast<size_t>(child));
            if (!content) return content.error();
            const auto first_picture = static_cast<uint32_t>(all.ground_pictures.size());
            for (BuildObject& object : content->objects) {
                for (quadtree::Paint& paint : object.paints) {
                    if (paint.kind == quadtree::PaintKind::kGroundPicture) paint.a += first_picture;
                }
                all.objects.push_back(std::move(object));
            }
            std::move(content->ground_pictures.begin(), content->ground_pictures.end(),
                      std::back_inserter(all.ground_pictures));
        }
        return all;
    }

    /// What a tile holds: a leaf's from the object spool, an inner tile's from the content spool.
    Result<TileContent> content_of(size_t at) {
        const TileNode& node = in_.tree.nodes[at];
        TileContent content;
        if (node.leaf) {
            auto objects = leaf_objects(at);
            if (!objects) return objects.error();
            content.objects = std::move(objects).value();
            for (BuildObject& object : content.objects) drop_hidden_faces(object);
            return content;
        }
        std::vector<std::byte> bytes;
        if (Status status = in_.content_spool.read(built_[at].content, bytes); !status) return status.error();
        return deserialise_content(bytes);
    }

    Status build_inner(size_t at) {
        const TileNode& node = in_.tree.nodes[at];
        auto children = child_content(node);
        if (!children) return children.error();
        TileSpec spec = spec_of(node);
        CoarsenSpec coarse_spec;
        coarse_spec.corner = spec.corner;
        coarse_spec.side = spec.side;
        coarse_spec.error_metres = level_error(side_metres(node));
        spec.texel = std::max(kLeafTexel, coarse_spec.error_metres / 2);
        coarse_spec.triangle_limit = kInnerTriangles;
        CoarseContent coarse = coarsen(std::move(children).value(), coarse_spec, in_.workshop);
        if (Status status = store_content(at, coarse.content); !status) return status;
        spec.facade_texel = std::max(kLeafTexel, coarse.allowed_error);
        spec.geometric_error = coarse.error;
        spec.inner = true;
        for (const BuildObject& object : coarse.content.objects) {
            if (!object.ground()) continue;
            spec.skirt_metres = std::max(spec.skirt_metres,
                                         kPictureSkirtErrors * static_cast<double>(object.error) + kSkirtLeastMetres);
        }
        EncodedTile tile = encode_tile(spec, coarse.content, in_.workshop);
        include_children(node, tile.record);
        return keep(at, std::move(tile));
    }

    Status store_content(size_t at, const TileContent& content) {
        if (at == 0) return Done{};  // nobody reads the root's
        auto range = in_.content_spool.append(serialise_content(content));
        if (!range) return range.error();
        built_[at].content = *range;
        return Done{};
    }

    void include_children(const TileNode& node, tileset::TileRecord& record) const {
        for (int32_t child : node.children) {
            if (child < 0) continue;
            const tileset::TileRecord& below = built_[static_cast<size_t>(child)].record;
            record.geometric_error = std::max(record.geometric_error, below.geometric_error);
            for (size_t axis = 0; axis < 3; ++axis) {
                record.bounds.min[axis] = std::min(record.bounds.min[axis], below.bounds.min[axis]);
                record.bounds.max[axis] = std::max(record.bounds.max[axis], below.bounds.max[axis]);
            }
        }
    }

    Status keep(size_t at, EncodedTile tile) {
        BuiltTile& built = built_[at];
        for (size_t layer = 0; layer < tileset::kLayerCount; ++layer) {
            auto range = in_.layer_spool.append(tile.bytes[layer]);
            if (!range) return range.error();
            built.layers[layer] = *range;
        }
        built.record = std::move(tile.record);
        built.triangles = tile.triangles;
        return Done{};
    }

    const PipelineInput& in_;
    MemoryGate gate_;
    std::vector<BuiltTile> built_;
    std::mutex mutex_;
    std::optional<Error> error_;
    uint64_t done_ = 0;
};

}  // namespace

double level_error(double side_metres) {
    return side_metres / kPixelsAcrossTile;
}

Result<std::vector<BuiltTile>> build_tiles(const PipelineInput& input) {
    return Pipeline(input).run();
}

}  // namespace citystream::tiles::layers

#include "tiles/layers/tile_pipeline.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "tiles/layers/build_stage.h"
#include "tiles/layers/coarsen.h"
#include "tiles/layers/flat_ground.h"
#include "tiles/layers/hidden_faces.h"
#include "tiles/layers/image_uses.h"
#include "tiles/layers/memory_pass.h"
#include "tiles/layers/party_walls.h"
#include "tiles/layers/radiance_stage.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::TileNode;

constexpr double kPixelsAcrossTile = 512;  // an inner tile's error is its side over this
// The decimated ground keeps its border, so beside a tile of another level a gap is no deeper than their errors, and
// no wider than the tolerance on the screen. A skirt that hangs deeper shows where a city ends at a tile's border.
constexpr double kSkirtErrors = 1, kPictureSkirtErrors = 2, kSkirtLeastMetres = 0.25;
constexpr uint64_t kInnerTriangles = 49152;
constexpr uint64_t kBytesPerTriangle = 2000;  // estimate of what a tile takes while it is coarsened and encoded
constexpr uint64_t kBytesPerTile = 16 << 20;
constexpr uint64_t kBytesPerTexel = 12;  // of the tile's own charts, all held at a time

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

/// Of every node above the deepest leaf below it.
std::vector<uint32_t> heights_of(const quadtree::TileTree& tree) {
    std::vector<uint32_t> heights(tree.nodes.size(), 0);
    // Children come after their parent.
    for (size_t at = tree.nodes.size(); at-- > 0;) {
        for (const int32_t child : tree.nodes[at].children)
            if (child >= 0) heights[at] = std::max(heights[at], heights[static_cast<size_t>(child)] + 1);
    }
    return heights;
}

class Pipeline {
  public:
    explicit Pipeline(const PipelineInput& input)
        : in_(input),
          gate_(input.work_bytes),
          built_(input.tree.nodes.size()),
          specs_(input.tree.nodes.size()),
          heights_(heights_of(input.tree)),
          workshop_(input.workshop) {}

    Result<std::vector<BuiltTile>> run() {
        if (Status status = prepare_all(); !status) return status.error();
        in_.clock.lap("coarsen");
        if (shares_charts()) {
            auto made = ChartDictionary::make(wishes_, {workshop_.images, workshop_.facades, workshop_.atlas},
                                              in_.options, gate_, in_.chart_spool);
            if (!made) return made.error();
            in_.charts = std::move(made).value();
            workshop_.charts = &in_.charts;
            in_.clock.lap("charts");
        }
        BuildStage stage(in_.options, "tiles", built_.size());
        const Status status = stage.run(built_.size(), [this](size_t at) {
            MemoryPass pass(gate_, bytes_of(at));
            return encode(at, pass);
        });
        if (!status) return status.error();
        in_.clock.lap("tiles");
        if (in_.radiance != nullptr) {
            if (Status baked = in_.radiance->run(built_); !baked) return baked.error();
            in_.clock.lap("radiance");
        }
        include_children();
        return std::move(built_);
    }

  private:
    bool shares_charts() const {
        return in_.options.shared_charts && in_.options.layers[static_cast<size_t>(tileset::Layer::kAtlas)];
    }

    /// Nodes by level.
    std::vector<std::vector<size_t>> levels() const {
        std::vector<std::vector<size_t>> levels(in_.tree.levels());
        for (size_t i = 0; i < in_.tree.nodes.size(); ++i) levels[in_.tree.nodes[i].address.level].push_back(i);
        return levels;
    }

    /// Coarsens what inner tiles hold, deepest level first, and notes which charts tiles could share.
    Status prepare_all() {
        BuildStage stage(in_.options, "coarsen", built_.size());
        const auto by_level = levels();
        for (auto nodes = by_level.rbegin(); nodes != by_level.rend(); ++nodes) {
            const Status status = stage.run(nodes->size(), [&](size_t i) {
                const size_t at = (*nodes)[i];
                const MemoryPass pass(gate_, bytes_of(at));
                return in_.tree.nodes[at].leaf ? prepare_leaf(at) : prepare_inner(at);
            });
            if (!status) return status;
        }
        return Done{};
    }

    uint64_t bytes_of(size_t at) const {
        return kBytesPerTile + kBytesPerTriangle * std::min(in_.tree.nodes[at].weight, 4 * kInnerTriangles);
    }

    double side_metres(const TileNode& node) const { return to_metres(in_.tree.side(node.address.level)); }

    TileSpec spec_of(const TileNode& node) const {
        TileSpec spec;
        spec.address = node.address;
        spec.corner = in_.tree.corner(node.address);
        spec.side = in_.tree.side(node.address.level);
        spec.texel = in_.options.texture_law.finest;
        if (node.address.level > 0) spec.parent_error = level_error(2 * side_metres(node));
        spec.skirt_metres = kSkirtErrors * level_error(2 * side_metres(node)) + kSkirtLeastMetres;
        return spec;
    }

    /// Of a tile this high above the deepest leaf below it.
    std::optional<codec::atlas::PageOptions> pages_at(uint32_t height) const {
        const BuildOptions& options = in_.options;
        if (options.atlas_form != codec::atlas::AtlasForm::kPages) return std::nullopt;
        codec::atlas::PageOptions pages;
        pages.mips = options.page_mips ? *options.page_mips : options.texture_law.mips(height);
        pages.rate_distortion = options.rate_distortion;
        pages.shape = options.page_shape;
        return pages;
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

    /// Leaves first, along the Morton curve, then inner tiles.
    uint64_t rank(size_t at) const { return in_.tree.nodes[at].leaf ? at : built_.size() + at; }

    void note_wishes(size_t at, const TileContent& content) {
        if (shares_charts()) wishes_.add(rank(at), wishes_of(specs_[at], content, workshop_));
    }

    Status prepare_leaf(size_t at) {
        specs_[at] = spec_of(in_.tree.nodes[at]);
        specs_[at].pages = pages_at(0);
        if (!shares_charts()) return Done{};
        const auto content = content_of(at);
        if (!content) return content.error();
        note_wishes(at, *content);
        return Done{};
    }

    Status encode(size_t at, MemoryPass& pass) {
        const auto content = content_of(at);
        if (!content) return content.error();
        pass.change(bytes_of(at) + kBytesPerTexel * own_texels_of(specs_[at], *content, workshop_));
        if (in_.tree.nodes[at].leaf) in_.preview.draw(content->objects);
        if (in_.radiance != nullptr) {
            if (Status added = in_.radiance->add(at, content->objects); !added) return added;
        }
        return keep(at, encode_tile(specs_[at], *content, workshop_));
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

    Status prepare_inner(size_t at) {
        const TileNode& node = in_.tree.nodes[at];
        auto children = child_content(node);
        if (!children) return children.error();
        TileSpec& spec = specs_[at];
        spec = spec_of(node);
        CoarsenSpec coarse_spec;
        coarse_spec.corner = spec.corner;
        coarse_spec.side = spec.side;
        coarse_spec.error_metres = level_error(side_metres(node));
        spec.texel = in_.options.texture_law.inner_texel(heights_[at], coarse_spec.error_metres);
        spec.pages = pages_at(heights_[at]);
        coarse_spec.triangle_limit = kInnerTriangles;
        const CoarseContent coarse = coarsen(std::move(children).value(), coarse_spec, workshop_);
        spec.facade_texel = std::max(in_.options.texture_law.finest, coarse.allowed_error);
        spec.geometric_error = coarse.error;
        spec.inner = true;
        for (const BuildObject& object : coarse.content.objects) {
            if (!object.ground()) continue;
            spec.skirt_metres = std::max(spec.skirt_metres,
                                         kPictureSkirtErrors * static_cast<double>(object.error) + kSkirtLeastMetres);
        }
        note_wishes(at, coarse.content);
        auto range = in_.content_spool.append(serialise_content(coarse.content));
        if (!range) return range.error();
        built_[at].content = *range;
        return Done{};
    }

    /// Bounds and errors hold for everything below a tile.
    void include_children() {
        const auto by_level = levels();
        for (auto nodes = by_level.rbegin(); nodes != by_level.rend(); ++nodes) {
            for (const size_t at : *nodes) include_children(in_.tree.nodes[at], built_[at].record);
        }
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
        built.pages_or_alpha = tile.pages_or_alpha;
        built.kept_in_charts = tile.kept_in_charts;
        return Done{};
    }

    const PipelineInput& in_;
    MemoryGate gate_;
    std::vector<BuiltTile> built_;
    std::vector<TileSpec> specs_;    // by node
    std::vector<uint32_t> heights_;  // by node: above the deepest leaf below it
    CityWishes wishes_;
    TileWorkshop workshop_;
};

}  // namespace

double level_error(double side_metres) {
    return side_metres / kPixelsAcrossTile;
}

Result<std::vector<BuiltTile>> build_tiles(const PipelineInput& input) {
    return Pipeline(input).run();
}

}  // namespace citystream::tiles::layers

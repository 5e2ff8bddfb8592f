#include "tiles/layers/tile_encoder.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "codec/atlas/atlas_layer.h"
#include "codec/atlas/shared_chart.h"
#include "codec/chart_word.h"
#include "codec/facade/facade_layer.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/step_wire.h"
#include "tiles/layers/page_places.h"
#include "tiles/layers/skirts.h"
#include "tiles/layers/tile_charts.h"

namespace citystream::tiles::layers {
namespace {

using codec::mesh::MeshTile;
using codec::mesh::MeshVertex;
using quadtree::BuildFacade;
using quadtree::BuildObject;
using quadtree::BuildTriangle;
using tileset::Layer;

// zstd. The 800 frames of a generated city of 1,000 buildings take 7.16 MB at level 6, 7.02 at 9, 6.93 at 12, 6.65 at
// 15 and 6.31 at 19, in 0.13, 0.22, 0.45, 0.96 and 2.67 s: a city is built once and sent often.
constexpr int kStepLevel = 19;
constexpr double kOneRepeat = 65536;  // of texture coordinates
constexpr int kBaseHeightBits = 16;   // coarser than every bit that a mesh step drops, so that neighbours round alike
// Pictures that relief is drawn over are placeholders until the tile is so far away that flat facades do; without
// relief they are all there is of windows.
constexpr ChartUse kNoChart = {CHART_WORD_UNTEXTURED, {}, {0, 0}};  // of a city without pictures
constexpr double kFinestFacadeTexel = 0.1, kCoarsestFacadeTexel = 0.8, kCoarsestOnlyTexel = 0.4;

void append_step(EncodedTile& tile, Layer layer, std::span<const std::byte> wire, uint32_t decoded_bytes, float error) {
    std::vector<std::byte>& bytes = tile.bytes[static_cast<size_t>(layer)];
    bytes.insert(bytes.end(), wire.begin(), wire.end());
    tileset::StepRecord record;
    record.end = bytes.size();
    record.decoded_bytes = decoded_bytes;
    record.error = error;
    record.checksum = tileset::checksum_of(wire.data(), wire.size());
    tile.record.steps(layer).push_back(record);
}

void append_layer(EncodedTile& tile, Layer layer, const LayerSteps& steps) {
    const auto frames = codec::encode_steps(steps, layer == Layer::kAtlas ? codec::atlas::kBlockZstdLevel : kStepLevel);
    for (size_t i = 0; i < steps.size(); ++i)
        append_step(tile, layer, frames[i], static_cast<uint32_t>(4 * steps[i].words.size()), steps[i].error);
}

/// Builds the arrays of a tile in the order: triangles of objects, skirts, then the flat stand-ins of facades.
class TileAssembly {
  public:
    TileAssembly(const TileSpec& spec, const TileContent& content, const TileWorkshop& workshop, ChartShelf* shelf)
        : spec_(spec),
          content_(content),
          workshop_(workshop),
          charts_(workshop.catalog, workshop.images, workshop.facades, spec.texel, spec.facade_texel, shelf) {
        for (const BuildObject& object : content.objects) {
            for (const BuildFacade& facade : object.facades)
                relief_ = std::max(relief_, workshop.facades.facts(facade.map).flat_loss());
        }
    }

    /// Asks for the charts that run() asks for, but for ground pictures, which no other tile has.
    void ask_for_charts() {
        for (uint32_t i = 0; i < content_.objects.size(); ++i) charts_.note(i, content_.objects[i]);
        charts_.settle();
        for (const BuildObject& object : content_.objects) {
            for (const BuildFacade& facade : object.facades) {
                const FacadeFacts& facts = workshop_.facades.facts(facade.map);
                stand_in_chart(facade, facts);
                if (wants(Layer::kFacade)) note_palette(facade, facts);
            }
        }
        add_palettes();
    }

    EncodedTile run() {
        place();
        note_charts();
        add_triangles();
        add_facades();
        if (in_pages_) {
            pages_ = *spec_.pages;
            pages_.mips = codec::atlas::affordable_mips(charts_.own_charts(), pages_.mips);
        }
        EncodedTile tile;
        tile.triangles = mesh_.triangle_chart.size();
        write_record(tile.record);
        encode(tile);
        return tile;
    }

  private:
    bool wants(Layer layer) const { return workshop_.layers[static_cast<size_t>(layer)]; }

    void place() {
        skirts_ = make_skirts(content_.objects, spec_.corner, spec_.side,
                              static_cast<int64_t>(std::ceil(spec_.skirt_metres * kGridUnitsPerMetre)));
        for (const BuildObject& object : content_.objects) {
            box_.add(object.box());
            for (const BuildFacade& facade : object.facades) {
                const FacadeFacts& facts = workshop_.facades.facts(facade.map);
                const auto reach = static_cast<int64_t>(std::ceil(facts.depth_metres * kGridUnitsPerMetre));
                for (const GridPoint& p : facade.corners()) {
                    box_.add(GridPoint{p.x - reach, p.y - reach, p.z});
                    box_.add(GridPoint{p.x + reach, p.y + reach, p.z});
                }
            }
        }
        for (const SkirtQuad& skirt : skirts_) {
            for (const GridPoint& corner : skirt.corners) box_.add(corner);
        }
        base_height_ = box_.empty() ? 0 : (box_.lo.z >> kBaseHeightBits) << kBaseHeightBits;
    }

    void note_charts() {
        if (!wants(Layer::kAtlas)) return;
        for (uint32_t i = 0; i < content_.ground_pictures.size(); ++i)
            charts_.add_ground_picture(i, content_.ground_pictures[i]);
        for (uint32_t i = 0; i < content_.objects.size(); ++i) charts_.note(i, content_.objects[i]);
        charts_.settle();
        // No facade's chart has alpha.
        in_pages_ = spec_.pages.has_value() && !has_alpha();
    }

    /// Where the corners of a polygon lie in its chart, in repeats.
    template <size_t kCorners>
    std::array<ChartPlaceOfCorner, kCorners> places_of(const std::array<std::array<int64_t, 2>, kCorners>& texcoords,
                                                       const ChartUse& use) const {
        std::array<ChartPlaceOfCorner, kCorners> places;
        for (size_t i = 0; i < kCorners; ++i) {
            for (size_t k = 0; k < 2; ++k)
                places[i][k] = (static_cast<double>(texcoords[i][k]) - use.offset[k]) * use.scale[k] / kOneRepeat;
        }
        if (in_pages_ && !codec::names_colour(use.chart)) fit_page_places(places, charts_.own_charts()[use.chart]);
        return places;
    }

    ChartUse use_of(uint32_t object, const quadtree::Paint& paint) const {
        return wants(Layer::kAtlas) ? charts_.use(object, paint) : kNoChart;
    }

    void add_corner(const GridPoint& point, const std::array<float, 3>& normal, const ChartPlaceOfCorner& place) {
        MeshVertex vertex{};
        vertex.position[0] = static_cast<int32_t>(point.x - spec_.corner.x);
        vertex.position[1] = static_cast<int32_t>(point.y - spec_.corner.y);
        vertex.position[2] = static_cast<int32_t>(point.z - base_height_);
        for (size_t k = 0; k < 3; ++k) vertex.normal[k] = normal[k];
        for (size_t k = 0; k < 2; ++k) {
            vertex.texcoord[k] =
                static_cast<int32_t>(std::clamp(std::round(place[k] * kOneRepeat), -2147483648.0, 2147483647.0));
        }
        mesh_.indices.push_back(static_cast<uint32_t>(mesh_.vertices.size()));
        mesh_.vertices.push_back(vertex);
    }

    void add_triangles() {
        for (uint32_t i = 0; i < content_.objects.size(); ++i) {
            const BuildObject& object = content_.objects[i];
            for (const BuildTriangle& triangle : object.triangles) {
                const auto& v = triangle.vertex;
                const auto normal = unit_normal(object.vertices[v[0]], object.vertices[v[1]], object.vertices[v[2]]);
                const ChartUse use = use_of(i, object.paints[triangle.paint]);
                const auto places = places_of(triangle.texcoord, use);
                for (size_t k = 0; k < 3; ++k) add_corner(object.vertices[v[k]], normal, places[k]);
                mesh_.triangle_chart.push_back(use.chart);
            }
        }
        for (const SkirtQuad& skirt : skirts_) {
            const ChartUse use = use_of(skirt.object, content_.objects[skirt.object].paints[skirt.paint]);
            add_quad(skirt.corners, skirt.normal, skirt.texcoords, use);
        }
        mesh_.dressed_begin = static_cast<uint32_t>(mesh_.triangle_chart.size());
    }

    void add_quad(const std::array<GridPoint, 4>& corners, const std::array<float, 3>& normal,
                  const std::array<std::array<int64_t, 2>, 4>& texcoords, const ChartUse& use) {
        constexpr std::array<size_t, 6> kOrder = {0, 1, 2, 0, 2, 3};
        const auto places = places_of(texcoords, use);
        for (size_t k : kOrder) add_corner(corners[k], normal, places[k]);
        mesh_.triangle_chart.push_back(use.chart);
        mesh_.triangle_chart.push_back(use.chart);
    }

    void add_facades() {
        for (const BuildObject& object : content_.objects) {
            for (const BuildFacade& facade : object.facades) {
                const FacadeFacts& facts = workshop_.facades.facts(facade.map);
                const ChartUse use = stand_in_chart(facade, facts);
                const auto corners = facade.corners();
                const auto normal = unit_normal(corners[0], corners[1], corners[2]);
                for (const FacadePanel& panel : facts.flat.panels) {
                    const FlatQuad quad = flat_quad(facade, panel);
                    add_quad(quad.corners, normal, quad.texcoords, use);
                }
                if (wants(Layer::kFacade)) add_placement(facade, facts);
            }
        }
        if (!wants(Layer::kFacade)) mesh_.dressed_begin = static_cast<uint32_t>(mesh_.triangle_chart.size());
        add_palettes();
    }

    void add_palettes() {
        facade_tile_.palettes.resize(palettes_.size());
        for (const auto& [palette, use] : palettes_) {
            for (uint32_t slot = 0; slot < FACADE_PALETTE_SLOTS; ++slot) {
                facade_tile_.palettes[use.index].slots[slot] = {codec::colour_word({}), 1};
                if (((use.slots >> slot) & 1U) == 0) continue;
                const uint32_t material = workshop_.catalog.palettes[palette].material[slot];
                const city::Material& m = workshop_.catalog.materials[material];
                facade_tile_.palettes[use.index].slots[slot] = {
                    wants(Layer::kAtlas) ? charts_.facade_material(material) : kNoChart.chart,
                    m.metres_per_repeat > 0 ? m.metres_per_repeat : 1.0F};
            }
        }
    }

    /// A palette of the catalog as the tile has it.
    struct PaletteUse {
        uint32_t index = 0, slots = 0;  ///< slots: bits
    };
    uint32_t note_palette(const BuildFacade& facade, const FacadeFacts& facts) {
        const auto index = static_cast<uint32_t>(palettes_.size());
        PaletteUse& use = palettes_.try_emplace(facade.palette, PaletteUse{index, 0}).first->second;
        use.slots |= facts.slots;
        return use.index;
    }

    /// What the flat stand-in of a facade shows: its picture, or its mean colour where it only waits for the relief,
    /// because the tile above is drawn before facades are flat. (In a city whose every wall is dressed, pictures of
    /// leaves would take most of the atlas.)
    ChartUse stand_in_chart(const BuildFacade& facade, const FacadeFacts& facts) {
        if (!wants(Layer::kAtlas)) return kNoChart;
        if (wants(Layer::kFacade) && kReliefWeight * relief_ >= spec_.parent_error)
            return charts_.use_of_whole(
                codec::colour_word(rounded_colour(workshop_.facades.mean_colour(facade.map, facade.palette))));
        return charts_.use_of_whole(charts_.facade_picture(facade.map, facade.palette, picture_texel(facts)));
    }

    /// Metres a texel of a facade seen flat. Tiles with relief are drawn flat from where its error, which goes by the
    /// deepest facade, is below the tolerance: a texel is never larger than that error.
    double picture_texel(const FacadeFacts& facts) const {
        const double texel = wants(Layer::kFacade)
                                 ? std::clamp(kReliefWeight * relief_, kFinestFacadeTexel, kCoarsestFacadeTexel)
                                 : std::clamp(facts.depth_metres, kFinestFacadeTexel, kCoarsestOnlyTexel);
        return std::max(spec_.facade_texel, texel);
    }

    void add_placement(const BuildFacade& facade, const FacadeFacts& facts) {
        codec::facade::Placement placement{};
        placement.origin[0] = static_cast<int32_t>(facade.origin.x - spec_.corner.x);
        placement.origin[1] = static_cast<int32_t>(facade.origin.y - spec_.corner.y);
        placement.origin[2] = static_cast<int32_t>(facade.origin.z - base_height_);
        placement.along[0] = facade.along[0];
        placement.along[1] = facade.along[1];
        placement.height = facade.height;
        placement.map = workshop_.numbers.number[facade.map];
        placement.palette = note_palette(facade, facts);
        facade_tile_.placements.push_back(placement);
        maps_.push_back(facade.map);
    }

    void write_record(tileset::TileRecord& record) {
        record.address = spec_.address;
        record.geometric_error = spec_.geometric_error;
        if (spec_.inner && wants(Layer::kAtlas))
            record.geometric_error = std::max(record.geometric_error, static_cast<float>(blur()));
        record.base_height = base_height_;
        if (wants(Layer::kFacade)) {
            record.flat_facade_error =
                facade_tile_.placements.empty() ? 0 : static_cast<float>(kReliefWeight * relief_);
        } else {
            record.geometric_error = std::max(record.geometric_error, static_cast<float>(relief_));
        }
        std::sort(maps_.begin(), maps_.end());
        record.facade_maps = static_cast<uint32_t>(std::unique(maps_.begin(), maps_.end()) - maps_.begin());
        const GridPoint& o = workshop_.city_origin;
        record.bounds.min = {to_metres(box_.lo.x - o.x), to_metres(box_.lo.y - o.y), to_metres(box_.lo.z)};
        record.bounds.max = {to_metres(box_.hi.x - o.x), to_metres(box_.hi.y - o.y), to_metres(box_.hi.z)};
    }

    void encode(EncodedTile& tile) {
        append_mesh(tile);
        mesh_ = {};
        if (!facade_tile_.placements.empty()) {
            append_layer(tile, Layer::kFacade, codec::facade::encode_facades(facade_tile_));
        }
        if (!charts_.own_charts().empty() || !charts_.shared_charts().empty())
            append_layer(tile, Layer::kAtlas, encode_atlas(tile));
    }

    void append_mesh(EncodedTile& tile) const {
        const auto options = workshop_.mesh.layer_options(tile.record.geometric_error, spec_.side,
                                                          [this](uint32_t chart) { return charts_.size_of(chart); });
        for (const auto& step : codec::mesh::encode_mesh_layer(mesh_, options))
            append_step(tile, Layer::kMesh, step.wire, step.decoded_bytes, step.error);
    }

    bool has_alpha() const {
        const auto own = charts_.own_charts();
        return std::any_of(own.begin(), own.end(), [](const ChartImage& chart) { return !chart.alpha.empty(); });
    }

    /// Metres that pictures are blurred by, also because pages hold no longer charts, or none finer than asked for.
    double blur() const {
        double blur = charts_.blur();
        if (!in_pages_) return blur;
        const uint32_t longest = codec::atlas::longest_page_chart(pages_.mips);
        for (const ChartImage& chart : charts_.own_charts()) {
            const double shrunk = static_cast<double>(std::max(chart.width, chart.height)) / longest;
            if (shrunk > 1) blur = std::max(blur, static_cast<double>(chart.metres_per_texel) * shrunk);
        }
        if (pages_.shape == codec::atlas::PageShape::kTight) return blur;
        const auto asked = charts_.asked_texels();
        for (size_t i = 0; i < asked.size(); ++i) {
            const float own = charts_.own_charts()[i].metres_per_texel;
            if (own > 0 && asked[i] > own) blur = std::max(blur, double{asked[i]});
        }
        return blur;
    }

    /// In pages where those are asked for and hold this tile's charts.
    LayerSteps encode_atlas(EncodedTile& tile) const {
        tile.pages_or_alpha = has_alpha();
        if (in_pages_) {
            auto pages = codec::atlas::encode_pages(charts_.own_charts(), pages_, charts_.asked_texels());
            tile.pages_or_alpha = pages.ok();
            if (pages) return std::move(pages).value();
        }
        tile.kept_in_charts = spec_.pages.has_value();
        return codec::atlas::encode_atlas(charts_.own_charts(), workshop_.atlas, charts_.shared_charts());
    }

    const TileSpec& spec_;
    const TileContent& content_;
    const TileWorkshop& workshop_;
    TileCharts charts_;
    bool in_pages_ = false;            ///< asked for, and there is no chart with alpha, which pages do not hold
    codec::atlas::PageOptions pages_;  ///< then: with mips that the charts are large enough for
    std::vector<SkirtQuad> skirts_;
    quadtree::GridBox box_;
    int64_t base_height_ = 0;
    double relief_ = 0;
    MeshTile mesh_;
    codec::facade::FacadeTile facade_tile_;
    std::map<uint32_t, PaletteUse> palettes_;  // by palette of the catalog
    std::vector<uint32_t> maps_;
};

}  // namespace

TileWishes wishes_of(const TileSpec& spec, const TileContent& content, const TileWorkshop& workshop) {
    TileWishes wishes;
    TileAssembly(spec, content, workshop, &wishes).ask_for_charts();
    return wishes;
}

uint64_t own_texels_of(const TileSpec& spec, const TileContent& content, const TileWorkshop& workshop) {
    if (!workshop.layers[static_cast<size_t>(Layer::kAtlas)]) return 0;
    OwnTexels own(workshop.charts);
    TileAssembly(spec, content, workshop, &own).ask_for_charts();
    uint64_t texels = own.count();
    for (const ChartImage& picture : content.ground_pictures) texels += uint64_t{picture.width} * picture.height;
    return texels;
}

EncodedTile encode_tile(const TileSpec& spec, const TileContent& content, const TileWorkshop& workshop) {
    return TileAssembly(spec, content, workshop, workshop.charts).run();
}

}  // namespace citystream::tiles::layers

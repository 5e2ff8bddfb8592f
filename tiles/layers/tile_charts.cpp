#include "tiles/layers/tile_charts.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "codec/atlas/alpha_mask.h"
#include "codec/chart_word.h"
#include "tiles/layers/image_uses.h"
#include "tiles/layers/texture_law.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::BuildTriangle;
using quadtree::Paint;
using quadtree::PaintKind;

constexpr int64_t kOneRepeat = 65536;
constexpr int64_t kEdgeSlack = 64;  // a thousandth of a repeat outside 0..1 still counts as inside
constexpr uint32_t kGreatestChart = 8192;
constexpr double kMarginTexels = 1;
// Metres, of the materials of facades. Where every tile with facades carries their pictures, finer ones cost much in a
// large city.
constexpr double kOwnMaterialTexel = 0.05, kSharedMaterialTexel = kLeafTexel;

double world_area(const BuildObject& object, const BuildTriangle& triangle) {
    const auto n = quadtree::triangle_normal(object.vertices[triangle.vertex[0]], object.vertices[triangle.vertex[1]],
                                             object.vertices[triangle.vertex[2]]);
    return 0.5 * std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) * kMetresPerGridUnit * kMetresPerGridUnit;
}

double texture_area(const BuildTriangle& triangle) {
    const auto& t = triangle.texcoord;
    const auto edge = [&](size_t corner, size_t axis) {
        return static_cast<double>(t[corner][axis] - t[0][axis]) / quadtree::kTexcoordUnits;
    };
    return 0.5 * std::abs(edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0));
}

/// Halvings after which a texel of `texel` metres is about `wanted`, and the image fits a chart.
uint32_t halvings(const std::array<uint32_t, 2>& sides, double texel, double wanted) {
    uint32_t level = 0;
    const uint32_t size = std::max(sides[0], sides[1]);
    while ((size >> level) > 1 &&
           ((size >> level) > kGreatestChart || std::ldexp(texel, static_cast<int>(level)) < wanted / kFinestShare))
        ++level;
    return level;
}

/// The same of an image with alpha, which has to keep texels enough to be there in part (codec/atlas/alpha_mask.h).
uint32_t masked_halvings(const std::array<uint32_t, 2>& sides, double texel, double wanted) {
    uint32_t level = halvings(sides, texel, wanted);
    const auto side = [&](size_t axis) { return uint64_t{std::max(1U, sides[axis] >> level)}; };
    while (level > 0 && side(0) * side(1) < codec::atlas::kLeastAlphaTexels) --level;
    return level;
}

codec::atlas::ContentHash hash_of(const ChartImage& image) {
    const size_t bytes = image.rgb.size() + image.alpha.size();
    std::vector<uint32_t> words((bytes + 3) / 4, 0);
    std::memcpy(words.data(), image.rgb.data(), image.rgb.size());
    if (!image.alpha.empty())
        std::memcpy(reinterpret_cast<uint8_t*>(words.data()) + image.rgb.size(), image.alpha.data(),
                    image.alpha.size());
    const uint32_t flags = (image.repeat_u ? 1U : 0U) | (image.repeat_v ? 2U : 0U) | (image.alpha.empty() ? 0U : 4U);
    return codec::atlas::content_hash({{image.width | image.height << 16, flags}, words});
}

/// Whether two images show the same as charts.
bool looks_equal(const ChartImage& a, const ChartImage& b) {
    return a.width == b.width && a.height == b.height && a.repeat_u == b.repeat_u && a.repeat_v == b.repeat_v &&
           a.rgb == b.rgb && a.alpha == b.alpha;
}

/// About the size of an image's mip `levels` coarser (finer where negative).
std::array<uint32_t, 2> halved(const std::array<uint32_t, 2>& size, int levels) {
    const auto side = [levels](uint32_t texels) {
        return static_cast<uint32_t>(std::clamp(std::ldexp(static_cast<double>(texels), -levels), 1.0, 65536.0));
    };
    return {side(size[0]), side(size[1])};
}

}  // namespace

void TileCharts::note(uint32_t object, const BuildObject& built) {
    for (const BuildTriangle& triangle : built.triangles) {
        const Paint& paint = built.paints[triangle.paint];
        if (paint.kind == PaintKind::kFacade) {
            blur_ = std::max(blur_, find_facade_picture(paint.a, paint.b, facade_texel_).texel);
        }
        if (paint.kind != PaintKind::kMaterial) continue;
        ImagePaint& noted = noted_[paint];
        noted.world_area += world_area(built, triangle);
        noted.texture_area += texture_area(triangle);
        Range& range = noted.objects[object];
        for (const auto& texcoord : triangle.texcoord) {
            for (size_t axis = 0; axis < 2; ++axis) {
                range.lo[axis] = std::min(range.lo[axis], texcoord[axis]);
                range.hi[axis] = std::max(range.hi[axis], texcoord[axis]);
            }
        }
    }
}

void TileCharts::add_ground_picture(uint32_t picture, ChartImage image) {
    blur_ = std::max(blur_, static_cast<double>(image.metres_per_texel));
    ground_pictures_[picture] = add(std::move(image));
}

void TileCharts::settle() {
    for (const auto& [paint, noted] : noted_) settle_image(paint, noted);
}

float TileCharts::ImageView::metres() const {
    return width * height > 1 ? static_cast<float>(std::ldexp(texel, static_cast<int>(level))) : 0;
}

void TileCharts::settle_image(const Paint& paint, const ImagePaint& noted) {
    const city::Material& material = catalog_.materials[paint.a];
    const auto sides = images_.sides(static_cast<uint32_t>(material.image));
    if (!sides) {
        const uint32_t chart = codec::colour_word(material.rgb);
        for (const auto& [object, range] : noted.objects) image_uses_[{paint, object}] = {chart, {}, {0, 0}};
        return;
    }
    ImageView view{paint, noted, static_cast<uint32_t>(material.image)};
    const double area = std::max(noted.texture_area, 1e-12) * (*sides)[0] * (*sides)[1];
    view.texel = std::sqrt(noted.world_area / area);
    view.level = images_.has_alpha(view.image) ? masked_halvings(*sides, view.texel, texel_)
                                               : halvings(*sides, view.texel, texel_);
    view.width = std::max(1U, (*sides)[0] >> view.level);
    view.height = std::max(1U, (*sides)[1] >> view.level);
    const bool outside = std::any_of(noted.objects.begin(), noted.objects.end(), [](const auto& entry) {
        const Range& r = entry.second;
        return r.lo[0] < -kEdgeSlack || r.lo[1] < -kEdgeSlack || r.hi[0] > kOneRepeat + kEdgeSlack ||
               r.hi[1] > kOneRepeat + kEdgeSlack;
    });
    if (outside) {
        settle_whole(view, material.repeat);
    } else {
        settle_crops(view, plan_crops(view), material.repeat);
    }
}

void TileCharts::note_blur(const ImageView& view, int level) {
    if (level > 0) blur_ = std::max(blur_, std::ldexp(view.texel, level));
}

std::optional<SharedChart> TileCharts::take(const ChartKey& key, double coarseness, uint64_t texels) {
    return shelf_ == nullptr ? std::nullopt : shelf_->take(key, coarseness, texels);
}

bool TileCharts::take_whole(const ImageView& view, bool repeat, uint64_t texels) {
    const auto kind = repeat ? ChartKey::Kind::kRepeatedImage : ChartKey::Kind::kImage;
    const auto shared = take({kind, {view.image, 0}}, view.level, texels);
    if (!shared) return false;
    const int level = static_cast<int>(shared->coarseness);
    note_blur(view, level);
    use_whole(view,
              add_shared(shared->number, std::ldexp(view.texel, level),
                         halved({view.width, view.height}, level - static_cast<int>(view.level))),
              repeat);
    return true;
}

void TileCharts::settle_whole(const ImageView& view, bool repeat) {
    if (take_whole(view, repeat, uint64_t{view.width} * view.height)) return;
    note_blur(view, static_cast<int>(view.level));
    ChartImage chart = *images_.mip(view.image, view.level);
    chart.repeat_u = chart.repeat_v = repeat;
    chart.metres_per_texel = view.metres();
    use_whole(view, add(std::move(chart), texel_), repeat);
}

void TileCharts::use_whole(const ImageView& view, uint32_t chart, bool repeat) {
    for (const auto& [object, range] : view.noted.objects) {
        ChartUse use;
        use.chart = chart;
        // Whole repeats are shifted away object by object, so that the packed coordinates stay small.
        for (size_t axis = 0; repeat && axis < 2; ++axis)
            use.offset[axis] = static_cast<double>((range.lo[axis] >> 16) * kOneRepeat);
        image_uses_[{view.paint, object}] = use;
    }
}

TileCharts::Crops TileCharts::plan_crops(const ImageView& view) {
    const auto low = [](int64_t t, uint32_t size) {
        return static_cast<uint32_t>(
            std::clamp(std::floor(static_cast<double>(t) / kOneRepeat * size) - kMarginTexels, 0.0, size - 1.0));
    };
    const auto high = [](int64_t t, uint32_t size) {
        return static_cast<uint32_t>(
            std::clamp(std::ceil(static_cast<double>(t) / kOneRepeat * size) + kMarginTexels, 1.0, size * 1.0));
    };
    Crops crops;
    Crop& all = crops.all;
    all = {view.width, view.height, 0, 0};
    for (const auto& [object, range] : view.noted.objects) {
        Crop crop{low(range.lo[0], view.width), low(range.lo[1], view.height), high(range.hi[0], view.width),
                  high(range.hi[1], view.height)};
        crop.x1 = std::max(crop.x1, crop.x0 + 1);
        crop.y1 = std::max(crop.y1, crop.y0 + 1);
        all = {std::min(all.x0, crop.x0), std::min(all.y0, crop.y0), std::max(all.x1, crop.x1),
               std::max(all.y1, crop.y1)};
        crops.area += crop.area();
        crops.of_object[object] = crop;
    }
    crops.together = 2 * all.area() <= 3 * crops.area;
    if (crops.together) crops.area = all.area();
    return crops;
}

/// A whole image that repeats elsewhere repeats here, too: the dictionary has it once, and its edges are those of the
/// material.
void TileCharts::settle_crops(const ImageView& view, const Crops& crops, bool repeat) {
    if (take_whole(view, repeat, crops.area)) return;
    note_blur(view, static_cast<int>(view.level));
    const auto image = images_.mip(view.image, view.level);
    const auto texel = static_cast<float>(std::ldexp(view.texel, static_cast<int>(view.level)));
    const uint32_t common = crops.together ? add_crop(*image, crops.all, texel) : 0;
    for (const auto& [object, own] : crops.of_object) {
        const Crop& crop = crops.together ? crops.all : own;
        ChartUse use;
        use.chart = crops.together ? common : add_crop(*image, own, texel);
        use.offset = {static_cast<double>(crop.x0) / image->width * kOneRepeat,
                      static_cast<double>(crop.y0) / image->height * kOneRepeat};
        use.scale = {static_cast<double>(image->width) / (crop.x1 - crop.x0),
                     static_cast<double>(image->height) / (crop.y1 - crop.y0)};
        image_uses_[{view.paint, object}] = use;
    }
}

uint32_t TileCharts::add_crop(const ChartImage& image, const Crop& crop, float texel) {
    ChartImage chart;
    chart.width = crop.x1 - crop.x0;
    chart.height = crop.y1 - crop.y0;
    chart.metres_per_texel = chart.width * chart.height > 1 ? texel : 0;
    chart.rgb.reserve(size_t{3} * chart.width * chart.height);
    for (uint32_t y = crop.y0; y < crop.y1; ++y) {
        const size_t first = size_t{y} * image.width + crop.x0;
        const auto row = image.rgb.begin() + static_cast<ptrdiff_t>(3 * first);
        chart.rgb.insert(chart.rgb.end(), row, row + static_cast<ptrdiff_t>(size_t{3} * chart.width));
        if (image.alpha.empty()) continue;
        const auto alpha = image.alpha.begin() + static_cast<ptrdiff_t>(first);
        chart.alpha.insert(chart.alpha.end(), alpha, alpha + static_cast<ptrdiff_t>(chart.width));
    }
    return add(std::move(chart), texel_);
}

ChartUse TileCharts::placed_use(uint32_t object, const Paint& paint) const {
    switch (paint.kind) {
        case PaintKind::kFlat:
            return {codec::colour_word(paint.rgb()), {}, {1, 1}};
        case PaintKind::kMaterial:
            return image_uses_.at({paint, object});
        case PaintKind::kFacade:
            return {facade_pictures_.at({paint.a, paint.b}).chart, {}, {1, 1}};
        case PaintKind::kGroundPicture:
            return {ground_pictures_.at(paint.a), {}, {1, 1}};
    }
    return {};
}

bool TileCharts::is_one_texel(uint32_t chart) const {
    if (codec::names_colour(chart)) return true;
    const uint32_t own = own_index_[chart];
    return own != kNotOwn && own_[own].width == 1 && own_[own].height == 1;
}

ChartUse TileCharts::use(uint32_t object, const Paint& paint) const {
    const ChartUse placed = placed_use(object, paint);
    return is_one_texel(placed.chart) ? use_of_whole(placed.chart) : placed;
}

ChartUse TileCharts::use_of_whole(uint32_t chart) const {
    // Where every coordinate shows the same, all are 0: they cost the mesh nothing.
    return is_one_texel(chart) ? ChartUse{chart, {}, {0, 0}} : ChartUse{chart, {}, {1, 1}};
}

const TileCharts::FacadePicture& TileCharts::find_facade_picture(uint32_t map, uint32_t palette, double texel) {
    const auto [found, is_new] = facade_pictures_.try_emplace({map, palette});
    FacadePicture& picture = found->second;
    if (!is_new) return picture;
    const auto shared =
        take({ChartKey::Kind::kFacadePicture, {map, palette}}, texel, facades_.picture_size(map, texel).texels());
    if (shared) {
        const auto size = facades_.picture_size(map, shared->coarseness);
        picture = {add_shared(shared->number, shared->metres_per_texel, {size.width, size.height}), shared->coarseness};
    } else {
        picture = {add(*facades_.picture(map, palette, texel)), texel};
    }
    return picture;
}

uint32_t TileCharts::facade_picture(uint32_t map, uint32_t palette, double texel) {
    return find_facade_picture(map, palette, texel).chart;
}

uint32_t TileCharts::facade_material(uint32_t material) {
    const auto found = facade_materials_.find(material);
    if (found != facade_materials_.end()) return found->second;
    const city::Material& m = catalog_.materials[material];
    const auto image = static_cast<uint32_t>(m.image);
    const auto sides = m.image < 0 ? std::nullopt : images_.sides(image);
    if (!sides) return facade_materials_[material] = codec::colour_word(m.rgb);
    const double repeat = m.metres_per_repeat > 0 ? static_cast<double>(m.metres_per_repeat) : 1.0;
    const double texel = repeat / std::max((*sides)[0], (*sides)[1]);
    const double finest = shelf_ == nullptr ? kOwnMaterialTexel : kSharedMaterialTexel;
    const uint32_t level = halvings(*sides, texel, std::max(texel_, finest));
    const uint64_t texels = uint64_t{std::max(1U, (*sides)[0] >> level)} * std::max(1U, (*sides)[1] >> level);
    // Relief is solid, while others may show a shared chart with its alpha.
    const bool alpha = images_.has_alpha(image);
    const auto shared = alpha ? std::nullopt : take({ChartKey::Kind::kRepeatedImage, {image, 0}}, level, texels);
    if (shared) {
        const int halvings_there = static_cast<int>(shared->coarseness);
        return facade_materials_[material] =
                   add_shared(shared->number, std::ldexp(texel, halvings_there), halved(*sides, halvings_there));
    }
    ChartImage chart = *images_.mip(image, level);
    chart.alpha = {};
    chart.repeat_u = chart.repeat_v = true;
    chart.metres_per_texel =
        chart.width * chart.height > 1 ? static_cast<float>(std::ldexp(texel, static_cast<int>(level))) : 0;
    return facade_materials_[material] = add(std::move(chart));
}

uint32_t TileCharts::add(ChartImage image, double asked_texel) {
    if (codec::atlas::all_there(image.alpha)) image.alpha = {};
    const auto colour = image.alpha.empty() ? codec::atlas::flat_colour(image.rgb) : std::nullopt;
    if (colour) return codec::colour_word(*colour);
    const codec::atlas::ContentHash hash = hash_of(image);
    const auto [begin, end] = by_content_.equal_range(hash);
    for (auto entry = begin; entry != end; ++entry) {
        ChartImage& there = own_[own_index_[entry->second]];
        if (!looks_equal(there, image)) continue;
        there.metres_per_texel = std::max(there.metres_per_texel, image.metres_per_texel);
        float& asked = asked_[own_index_[entry->second]];
        asked = std::min(asked, static_cast<float>(asked_texel));
        return entry->second;
    }
    const uint32_t chart = add_own(std::move(image), asked_texel);
    by_content_.emplace(hash, chart);
    return chart;
}

uint32_t TileCharts::add_own(ChartImage image, double asked_texel) {
    own_index_.push_back(static_cast<uint32_t>(own_.size()));
    own_.push_back(std::move(image));
    asked_.push_back(static_cast<float>(asked_texel));
    return static_cast<uint32_t>(own_index_.size() - 1);
}

uint32_t TileCharts::add_shared(uint32_t number, double metres_per_texel, const std::array<uint32_t, 2>& size) {
    const auto [found, is_new] = by_number_.try_emplace(number, shared_.size());
    if (is_new) {
        own_index_.push_back(kNotOwn);
        shared_.push_back({static_cast<uint32_t>(own_index_.size() - 1), number, 0});
    }
    codec::atlas::SharedChartUse& use = shared_[found->second];
    use.metres_per_texel = std::max(use.metres_per_texel, static_cast<float>(metres_per_texel));
    std::array<uint32_t, 2>& known = shared_sizes_[use.chart_in_tile];
    for (size_t axis = 0; axis < 2; ++axis) known[axis] = std::max(known[axis], size[axis]);
    return use.chart_in_tile;
}

std::array<uint32_t, 2> TileCharts::size_of(uint32_t chart_word) const {
    if (codec::names_colour(chart_word) || chart_word >= own_index_.size()) return {1, 1};
    const uint32_t own = own_index_[chart_word];
    if (own == kNotOwn) return shared_sizes_.at(chart_word);
    return {own_[own].width, own_[own].height};
}

}  // namespace citystream::tiles::layers

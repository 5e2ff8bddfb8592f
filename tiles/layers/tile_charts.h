// The charts of one tile: which parts of which images its triangles and facades show, at the texel size that the tile's
// level asks for. Pictures that other tiles may show too are taken from a shelf where it has them. Usage: note() every
// triangle, settle(), then ask where each triangle's texture coordinates land; own_charts() and shared_charts() are for
// the atlas codec.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "codec/atlas/chart_content.h"
#include "tiles/layers/chart_wishes.h"
#include "tiles/layers/facade_painter.h"
#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// Texture coordinate in chart repeats = (t - offset) * scale, t and offset in 2^-16 repeats of the image.
struct ChartUse {
    uint32_t chart = 0;  ///< chart word (codec/chart_word.h): what is of one colour has no chart
    std::array<double, 2> offset{}, scale = {1, 1};
};

class TileCharts {
  public:
    /// Metres a texel of the finest mip, of images (which are never enlarged to reach it) and of facades that triangles
    /// show. `shelf`, where given, must outlive the charts.
    TileCharts(const city::CityCatalog& catalog, ImageCache& images, FacadePainter& facades, double texel,
               double facade_texel, ChartShelf* shelf = nullptr)
        : catalog_(catalog),
          images_(images),
          facades_(facades),
          texel_(texel),
          facade_texel_(facade_texel),
          shelf_(shelf) {}

    /// Notes what object number `object` of the tile shows.
    void note(uint32_t object, const quadtree::BuildObject& built);
    /// Adds a picture that paints of kind kGroundPicture with index `picture` show.
    void add_ground_picture(uint32_t picture, ChartImage image);
    /// Makes the charts of everything noted.
    void settle();

    /// Chart of a paint of an object noted before.
    ChartUse use(uint32_t object, const quadtree::Paint& paint) const;
    /// Of a chart that shows all of a picture.
    ChartUse use_of_whole(uint32_t chart) const;

    /// Chart words asked for by facades: charts are made at once, once each.
    uint32_t facade_picture(uint32_t map, uint32_t palette, double texel);
    uint32_t facade_material(uint32_t material);

    /// As encode_atlas takes them.
    std::span<const ChartImage> own_charts() const { return own_; }
    std::span<const codec::atlas::SharedChartUse> shared_charts() const { return shared_; }
    /// Of each of own_charts(), metres a texel that it need not be finer than, 0: none; mips are taken as they are, and
    /// are finer than asked for by up to kFinestShare (image_uses.h).
    std::span<const float> asked_texels() const { return asked_; }
    /// Texels of a chart's finest mip; of a shared one about. {1, 1} of a colour, and of a chart that is not there,
    /// as all are in cities without pictures.
    std::array<uint32_t, 2> size_of(uint32_t chart_word) const;
    /// Metres that what the triangles show is blurred by: a texel of images that were halved, of ground pictures and of
    /// facades drawn as pictures; of shared ones as they are in the dictionary. Zero when every image is shown as fine
    /// as it is.
    double blur() const { return blur_; }

  private:
    struct Range {
        std::array<int64_t, 2> lo = {INT64_MAX, INT64_MAX}, hi = {INT64_MIN, INT64_MIN};
    };
    struct ImagePaint {
        double world_area = 0, texture_area = 0;  ///< square metres, square repeats
        std::map<uint32_t, Range> objects;
    };
    struct Crop {
        uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
        uint64_t area() const { return uint64_t{x1 - x0} * (y1 - y0); }
    };
    /// A mip of an image that a paint shows.
    struct ImageView {
        const quadtree::Paint& paint;
        const ImagePaint& noted;
        uint32_t image = 0, level = 0;
        uint32_t width = 0, height = 0;  ///< of that mip
        double texel = 0;                ///< metres, of level 0
        float metres() const;            ///< a texel of that mip; 0 where it is the only one
    };
    struct Crops {
        std::map<uint32_t, Crop> of_object;
        bool together = false;  ///< all objects show `all`
        Crop all;
        uint64_t area = 0;  ///< of what would be cut out
    };
    struct FacadePicture {
        uint32_t chart = 0;
        double texel = 0;  ///< metres, about
    };
    void settle_image(const quadtree::Paint& paint, const ImagePaint& noted);
    /// Whether the shelf has the whole image, which is then used.
    bool take_whole(const ImageView& view, bool repeat, uint64_t texels);
    void settle_whole(const ImageView& view, bool repeat);
    void use_whole(const ImageView& view, uint32_t chart, bool repeat);
    void settle_crops(const ImageView& view, const Crops& crops, bool repeat);
    void note_blur(const ImageView& view, int level);
    static Crops plan_crops(const ImageView& view);
    uint32_t add_crop(const ChartImage& image, const Crop& crop, float texel);
    std::optional<SharedChart> take(const ChartKey& key, double coarseness, uint64_t texels);
    const FacadePicture& find_facade_picture(uint32_t map, uint32_t palette, double texel);
    ChartUse placed_use(uint32_t object, const quadtree::Paint& paint) const;
    /// Chart word that shows this image: of a new chart, of an equal one that is there, or its only colour.
    uint32_t add(ChartImage image, double asked_texel = 0);
    uint32_t add_own(ChartImage image, double asked_texel = 0);
    uint32_t add_shared(uint32_t number, double metres_per_texel, const std::array<uint32_t, 2>& size);
    bool is_one_texel(uint32_t chart) const;

    const city::CityCatalog& catalog_;
    ImageCache& images_;
    FacadePainter& facades_;
    double texel_, facade_texel_;
    ChartShelf* shelf_;
    double blur_ = 0;
    static constexpr uint32_t kNotOwn = UINT32_MAX;
    std::vector<uint32_t> own_index_;  // by chart: its place in own_, kNotOwn: shared
    std::vector<ChartImage> own_;
    std::vector<float> asked_;  // like own_
    std::vector<codec::atlas::SharedChartUse> shared_;
    std::map<uint32_t, std::array<uint32_t, 2>> shared_sizes_;  // by chart
    std::map<uint32_t, size_t> by_number_;                      // of the dictionary: place in shared_
    std::multimap<codec::atlas::ContentHash, uint32_t> by_content_;
    std::map<quadtree::Paint, ImagePaint> noted_;
    std::map<std::pair<quadtree::Paint, uint32_t>, ChartUse> image_uses_;
    std::map<uint32_t, uint32_t> facade_materials_, ground_pictures_;
    std::map<std::array<uint32_t, 2>, FacadePicture> facade_pictures_;
};

}  // namespace citystream::tiles::layers

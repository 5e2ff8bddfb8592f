// The charts of one tile: which parts of which images its triangles and facades show, at the texel size that the tile's
// level asks for. Usage: note() every triangle, settle(), then ask where each triangle's texture coordinates land;
// take() the images for the atlas codec.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "codec/atlas/chart_content.h"
#include "tiles/layers/facade_painter.h"
#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// Texture coordinate in chart repeats = (t - offset) * scale, t and offset in 2^-16 repeats of the image.
struct ChartUse {
    uint32_t chart = 0;
    std::array<double, 2> offset{}, scale = {1, 1};
};

class TileCharts {
  public:
    /// Metres a texel of the finest mip, of images (which are never enlarged to reach it) and of facades that triangles
    /// show.
    TileCharts(const city::CityCatalog& catalog, ImageCache& images, FacadePainter& facades, double texel,
               double facade_texel)
        : catalog_(catalog), images_(images), facades_(facades), texel_(texel), facade_texel_(facade_texel) {}

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

    /// Charts asked for by facades: made at once, once each.
    uint32_t facade_picture(uint32_t map, uint32_t palette, double texel);
    uint32_t facade_material(uint32_t material);
    uint32_t flat(const std::array<uint8_t, 3>& rgb);

    std::span<const ChartImage> charts() const { return charts_; }
    /// Metres that what the triangles show is blurred by: a texel of images that were halved, of ground pictures and of
    /// facades drawn as pictures. Zero when every image is shown as fine as it is.
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
    void settle_image(const quadtree::Paint& paint, const ImagePaint& noted);
    void settle_whole(const quadtree::Paint& paint, const ImagePaint& noted, const ChartImage& image, bool repeat,
                      float texel);
    void settle_crops(const quadtree::Paint& paint, const ImagePaint& noted, const ChartImage& image, float texel);
    ChartUse placed_use(uint32_t object, const quadtree::Paint& paint) const;
    uint32_t add_crop(const ChartImage& image, const Crop& crop, float texel);
    /// Index of a chart that shows this image: a new one, or what there is already where it is of one colour or equal.
    uint32_t add(ChartImage image);

    const city::CityCatalog& catalog_;
    ImageCache& images_;
    FacadePainter& facades_;
    double texel_, facade_texel_;
    double blur_ = 0;
    std::vector<ChartImage> charts_;
    std::multimap<codec::atlas::ContentHash, uint32_t> by_content_;
    std::map<quadtree::Paint, ImagePaint> noted_;
    std::map<std::pair<quadtree::Paint, uint32_t>, ChartUse> image_uses_;
    std::map<uint32_t, uint32_t> flats_, facade_materials_, ground_pictures_;
    std::map<std::array<uint32_t, 2>, uint32_t> facade_pictures_;
};

}  // namespace citystream::tiles::layers

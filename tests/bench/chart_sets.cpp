#include "tests/bench/chart_sets.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace citystream::bench {

namespace {

using codec::atlas::AtlasPackingOptions;
using codec::atlas::ChartRequest;
using codec::atlas::RectangleSize;

constexpr uint32_t kLeastSide = 16, kMadeImages = 150;

/// The same numbers from every standard library.
class Dice {
  public:
    explicit Dice(uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) {}
    /// 0 .. 1.
    double roll() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state_ >> 40) * 0x1p-24;
    }
    /// low .. high, evenly in the logarithm.
    double spread(double low, double high) { return low * std::pow(high / low, roll()); }

  private:
    uint64_t state_;
};

std::vector<RectangleSize> made_images() {
    Dice dice(1);
    std::vector<RectangleSize> images(kMadeImages);
    for (RectangleSize& image : images) {
        image.width = static_cast<uint32_t>(dice.spread(64, 1400));
        image.height = static_cast<uint32_t>(dice.spread(64, 1400));
    }
    return images;
}

struct Wall {
    RectangleSize image;
    double width;  ///< metres that the image's width covers
};

/// The chart at metres per texel: never larger than its image or than the largest chart, never below four texels.
ChartRequest chart_of(const Wall& wall, double metres_per_texel, uint32_t most_side) {
    const double scale = std::min({1.0, wall.width / metres_per_texel / wall.image.width,
                                   static_cast<double>(most_side) / std::max(wall.image.width, wall.image.height)});
    const auto scaled = [scale](uint32_t side) { return std::max(4u, static_cast<uint32_t>(scale * side)); };
    ChartRequest chart;
    chart.wanted = {scaled(wall.image.width), scaled(wall.image.height)};
    chart.source = {std::max(wall.image.width, chart.wanted.width), std::max(wall.image.height, chart.wanted.height)};
    chart.repeat_u = chart.repeat_v = true;
    return chart;
}

/// Texels with border and alignment.
uint64_t padded_area(const std::vector<ChartRequest>& charts, const AtlasPackingOptions& options) {
    const uint32_t unit = codec::atlas::alignment_unit(options.mips, options.blocks, options.packed_coordinates);
    uint64_t area = 0;
    for (const ChartRequest& chart : charts) {
        const auto border = codec::atlas::border_of(options.border, options.mips, chart.repeat_u, chart.repeat_v);
        const auto padded = [unit](uint32_t side, uint32_t b) {
            return (uint64_t{side} + 2 * b + unit - 1) / unit * unit;
        };
        area += padded(chart.wanted.width, border.u) * padded(chart.wanted.height, border.v);
    }
    return area;
}

}  // namespace

std::vector<RectangleSize> image_sizes(const std::vector<std::string>& folders_and_files) {
    namespace fs = std::filesystem;
    std::vector<std::string> paths;
    for (const std::string& from : folders_and_files) {
        std::error_code error;
        if (fs::is_regular_file(from, error)) paths.push_back(from);
        if (!fs::is_directory(from, error)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(from, error)) {
            const std::string extension = entry.path().extension().string();
            if (extension == ".jpg" || extension == ".jpeg" || extension == ".png")
                paths.push_back(entry.path().string());
        }
    }
    std::sort(paths.begin(), paths.end());
    std::vector<RectangleSize> sizes;
    for (const std::string& path : paths) {
        const auto input = OIIO::ImageInput::open(path);
        if (!input) continue;
        const OIIO::ImageSpec& spec = input->spec();
        if (spec.width < static_cast<int>(kLeastSide) || spec.height < static_cast<int>(kLeastSide)) continue;
        sizes.push_back({static_cast<uint32_t>(spec.width), static_cast<uint32_t>(spec.height)});
    }
    return sizes;
}

std::vector<std::string> texture_folders() {
    const std::string data = std::string(CITYSTREAM_SOURCE_DIR) + "/../shared/data/";
    return {data + "ingolstadt_lod3", data + "spb_facades/images", data + "cc0_building_textures",
            data + "cityjson_samples/rotterdam/appearances"};
}

std::vector<ChartRequest> table_14_set(const PrintedPacking& printed, const std::vector<RectangleSize>& images,
                                       const AtlasPackingOptions& options) {
    const std::vector<RectangleSize> from = images.empty() ? made_images() : images;
    Dice dice(printed.charts);
    std::vector<Wall> walls;
    for (size_t i = 0; i < printed.charts; ++i) walls.push_back({from[i % from.size()], dice.spread(2, 20)});
    const auto set_at = [&](double metres_per_texel) {
        std::vector<ChartRequest> charts;
        for (const Wall& wall : walls) charts.push_back(chart_of(wall, metres_per_texel, options.max_chart_side - 16));
        return charts;
    };
    const double most = printed.plain / 100 * printed.side * printed.side;
    double too_coarse = 100, too_fine = 1e-4;  // both in metres per texel
    for (int i = 0; i < 60; ++i) {
        const double middle = std::sqrt(too_coarse * too_fine);
        (static_cast<double>(padded_area(set_at(middle), options)) > most ? too_fine : too_coarse) = middle;
    }
    return set_at(too_coarse);
}

}  // namespace citystream::bench

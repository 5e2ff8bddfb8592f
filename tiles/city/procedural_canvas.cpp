#include "tiles/city/procedural_canvas.h"

#include <algorithm>
#include <utility>

#include "tiles/city/generator_random.h"

namespace citystream::tiles::city::procedural {
namespace {

constexpr int kFine = 256;  ///< parts of a texel
constexpr int kBlotchMm = 900, kStreakWidthMm = 180, kStreakHeightMm = 3000;

/// The texels that an interval of millimetres touches, with the share of each that it covers.
class Extent {
  public:
    Extent(int from_mm, int to_mm, int period_mm, uint32_t texels)
        : from_(fine(from_mm, period_mm, texels)),
          to_(std::min(fine(to_mm, period_mm, texels), from_ + int64_t{texels} * kFine)) {}
    int64_t first() const { return floor_part(from_); }
    int64_t end() const { return floor_part(to_ + kFine - 1); }
    int cover(int64_t texel) const {
        return static_cast<int>(std::min(to_, (texel + 1) * kFine) - std::max(from_, texel * kFine));
    }

  private:
    static int64_t floor_part(int64_t at) { return at >> 8; }
    static int64_t fine(int mm, int period_mm, uint32_t texels) {
        const int64_t scaled = int64_t{mm} * texels * kFine;
        return scaled / period_mm - (scaled % period_mm < 0 ? 1 : 0);
    }
    int64_t from_, to_;
};

uint32_t wrapped(int64_t texel, uint32_t texels) {
    const int64_t rest = texel % texels;
    return static_cast<uint32_t>(rest < 0 ? rest + texels : rest);
}

uint8_t mixed(uint8_t a, uint8_t b, int share_of_b) {
    return static_cast<uint8_t>((a * (kFine - share_of_b) + b * share_of_b) >> 8);
}

/// A smooth field that repeats over the picture, -256..255, read row by row.
class Field {
  public:
    Field(uint32_t width, uint32_t height, int across, int up, uint64_t seed)
        : height_(height), across_(across), up_(up), seed_(seed), columns_(width) {
        for (uint32_t x = 0; x < width; ++x) columns_[x] = cell_of(x, width, across);
    }

    /// Adds `strength` / 256 of row y to `levels`.
    void add_row(uint32_t y, int strength, std::vector<int>& levels) const {
        const Cell row = cell_of(y, height_, up_);
        std::vector<int> line(static_cast<size_t>(across_) + 1);
        for (int i = 0; i < across_; ++i) {
            line[static_cast<size_t>(i)] =
                (lattice(i, row.index) * (256 - row.weight) + lattice(i, (row.index + 1) % up_) * row.weight) / 256;
        }
        line.back() = line.front();
        for (size_t x = 0; x < columns_.size(); ++x) {
            const auto [index, weight] = columns_[x];
            const auto i = static_cast<size_t>(index);
            levels[x] += ((line[i] * (256 - weight) + line[i + 1] * weight) / 256 * strength) >> 8;
        }
    }

  private:
    struct Cell {
        int index, weight;
    };
    static Cell cell_of(uint32_t at, uint32_t size, int cells) {
        const uint32_t scaled = (2 * at + 1) * static_cast<uint32_t>(cells) * 128 / size;
        const int t = static_cast<int>(scaled % 256);
        return {static_cast<int>(scaled / 256), t * t * (768 - 2 * t) / 65536};
    }
    int lattice(int i, int j) const { return static_cast<int>(hash(seed_, i, j) & 511) - 256; }

    uint32_t height_;
    int across_, up_;
    uint64_t seed_;
    std::vector<Cell> columns_;
};

/// Lattice cells over a period; at most one for two texels.
int cells(int period_mm, int cell_mm, uint32_t texels) {
    return std::clamp(period_mm / cell_mm, 1, std::max(1, static_cast<int>(texels / 2)));
}

void add_grain(int strength, uint64_t seed, uint32_t y, std::vector<int>& levels) {
    for (size_t x = 0; x < levels.size(); x += 4) {
        uint64_t word = mix(seed + (uint64_t{y} << 32) + x);
        for (size_t i = x; i < std::min(x + 4, levels.size()); ++i, word >>= 16)
            levels[i] += ((static_cast<int>(word & 255) + static_cast<int>(word >> 8 & 255) - 255) * strength) >> 8;
    }
}

}  // namespace

PeriodicCanvas::PeriodicCanvas(uint32_t width, uint32_t height, int width_mm, int height_mm, Rgb ground)
    : width_mm_(width_mm), height_mm_(height_mm) {
    image_.width = width;
    image_.height = height;
    image_.rgb.resize(size_t{3} * width * height);
    for (size_t i = 0; i < image_.rgb.size(); ++i) image_.rgb[i] = ground[i % 3];
}

void PeriodicCanvas::fill(const Rect& mm, Rgb foot, Rgb head, int opacity) {
    if (mm.empty()) return;
    const Extent across(mm.x0, mm.x1, width_mm_, image_.width), up(mm.y0, mm.y1, height_mm_, image_.height);
    const auto rows = static_cast<int>(std::max<int64_t>(1, up.end() - up.first() - 1));
    for (int64_t y = up.first(); y < up.end(); ++y) {
        const int at = static_cast<int>(y - up.first()) * kFine / rows, row_opacity = up.cover(y) * opacity / kFine;
        const Rgb colour = {mixed(foot[0], head[0], at), mixed(foot[1], head[1], at), mixed(foot[2], head[2], at)};
        uint8_t* row = image_.rgb.data() + size_t{3} * image_.width * wrapped(y, image_.height);
        uint32_t column = wrapped(across.first(), image_.width);
        for (int64_t x = across.first(); x < across.end(); ++x) {
            const int share = across.cover(x) * row_opacity / kFine;
            uint8_t* texel = row + size_t{3} * column;
            for (size_t c = 0; c < 3; ++c) texel[c] = mixed(texel[c], colour[c], share);
            if (++column == image_.width) column = 0;
        }
    }
}

void PeriodicCanvas::weather(const Weather& weather) {
    const uint32_t width = image_.width, height = image_.height;
    const Field coarse(width, height, cells(width_mm_, kBlotchMm, width), cells(height_mm_, kBlotchMm, height),
                       weather.seed);
    const Field fine(width, height, cells(width_mm_, kBlotchMm / 5, width), cells(height_mm_, kBlotchMm / 5, height),
                     weather.seed + 1);
    const Field rain(width, height, cells(width_mm_, kStreakWidthMm, width), cells(height_mm_, kStreakHeightMm, height),
                     weather.seed + 2);
    std::vector<int> levels(width);
    for (uint32_t y = 0; y < height; ++y) {
        std::fill(levels.begin(), levels.end(), 0);
        coarse.add_row(y, weather.blotches, levels);
        fine.add_row(y, weather.blotches / 2, levels);
        rain.add_row(y, weather.streaks, levels);
        add_grain(weather.grain, weather.seed + 3, y, levels);
        uint8_t* texel = image_.rgb.data() + size_t{3} * width * y;
        for (uint32_t x = 0; x < width; ++x, texel += 3) {
            for (size_t c = 0; c < 3; ++c)
                texel[c] = static_cast<uint8_t>(std::clamp(texel[c] + ((texel[c] * levels[x]) >> 8), 0, 255));
        }
    }
}

Image PeriodicCanvas::finish() && {
    return std::move(image_);
}

}  // namespace citystream::tiles::city::procedural

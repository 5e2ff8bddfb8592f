#include "tests/bench/facade_sets.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "tiles/city/grammar.h"

namespace citystream::bench {

namespace {

using codec::facade::FacadeMatrices;
using codec::facade::kOpenDisplacement;
using tiles::city::procedural::Canvas;
using tiles::city::procedural::Rect;
using tiles::city::procedural::Slot;

/// Lengths in centimetres, displacements in millimetres.
class FacadePainting {
  public:
    FacadePainting(int width, int height, FacadeStyle style, uint32_t seed)
        : canvas_(width, height), width_(width), height_(height), style_(style), engine_(seed) {}

    codec::facade::RunGrid run() {
        wall();
        const int floors = std::max(1, (height_ - kGround - kCrown) / kFloor);
        const int bays = std::max(1, (width_ - 2 * kMargin) / kBay);
        const int bay = (width_ - 2 * kMargin) / bays;
        for (int f = 0; f < floors; ++f) {
            const int foot = kGround + f * ((height_ - kGround - kCrown) / floors);
            if (f > 0) fill(0, foot - 6, width_, foot + 6, 40, Slot::kCornice);
            for (int b = 0; b < bays; ++b) window_in(kMargin + b * bay, foot, bay, f, b);
        }
        for (int b = 0; b < bays; ++b) shop(kMargin + b * bay + 30, bay - 60);
        if (style_ == FacadeStyle::kOrnate) diagonal();
        return canvas_.relief();
    }

  private:
    static constexpr int kGround = 380, kCrown = 60, kFloor = 300, kMargin = 40, kBay = 220;

    bool plain() const { return style_ == FacadeStyle::kRegular; }
    /// low..high; the same from every standard library.
    int roll(int low, int high) {
        return low + static_cast<int>(uint64_t{engine_()} * static_cast<uint64_t>(high - low + 1) >> 32);
    }
    void fill(int x0, int y0, int x1, int y1, int mm, Slot slot) { canvas_.fill({x0, y0, x1, y1}, mm, slot); }

    void wall() {
        fill(0, 0, width_, height_, 0, Slot::kWall);
        fill(0, 0, width_, 60, 60, Slot::kPlinth);
        fill(0, kGround - 25, width_, kGround - 10, 90, Slot::kCornice);
        fill(0, kGround - 10, width_, kGround, 120, Slot::kCornice);
        fill(0, height_ - 40, width_, height_ - 15, 150, Slot::kCornice);
        fill(0, height_ - 15, width_, height_, 220, Slot::kCornice);
        for (int x = 6; x + 12 < width_; x += 24) fill(x, height_ - 55, x + 12, height_ - 40, 110, Slot::kCornice);
        if (plain()) return;
        int foot = 0;
        for (int k = 0; foot + 30 < height_ - kCrown; ++k) {
            const int length = k % 2 == 0 ? 28 : 40;
            fill(0, foot, length, foot + 28, 25, Slot::kQuoin);
            fill(width_ - length, foot, width_, foot + 28, 25, Slot::kQuoin);
            foot += 30 + roll(0, 6);
        }
    }

    void window_in(int x, int foot, int bay, int storey, int column) {
        int width = 110, height = 160, left = x + (bay - width) / 2, sill = foot + 80, panes = storey == 0 ? 2 : 3;
        bool balcony = storey == 1 && column % 3 == 1;
        if (!plain()) {
            width += 6 * roll(-3, 3);
            height += 6 * roll(-3, 3);
            left = x + (bay - width) / 2 + roll(-6, 6);
            sill += roll(-5, 5);
            panes = roll(1, 3);
            balcony = roll(0, 5) == 0;
        }
        window({left, sill, left + width, sill + height}, panes);
        if (balcony) rail({left - 20, sill - 24, left + width + 20, sill + 72});
        if (style_ == FacadeStyle::kOrnate) ornament({left, sill, left + width, sill + height});
    }

    void window(const Rect& r, int panes) {
        const int frame = plain() ? -120 : -120 - 20 * roll(0, 2);
        const int glass = frame - (plain() ? 50 : roll(40, 60));
        const Slot frame_slot = !plain() && roll(0, 1) == 0 ? Slot::kShutter : Slot::kFrame;
        canvas_.fill(r.inset(-8), 30, Slot::kCornice);
        canvas_.fill(r, -100, Slot::kQuoin);
        canvas_.fill(r.inset(4), frame, frame_slot);
        const Rect inner = r.inset(7);
        const int pane = (inner.width() - (panes - 1) * 4) / panes;
        const int transom = panes % 2 == 1 ? inner.y0 + inner.height() * 2 / 3 : inner.y1;
        for (int p = 0; p < panes; ++p) {
            const int x = inner.x0 + p * (pane + 4);
            fill(x, inner.y0, x + pane, transom, glass, Slot::kGlass);
            fill(x, transom + 4, x + pane, inner.y1, glass, Slot::kGlass);
            if (!plain() && roll(0, 2) == 0)
                fill(x, inner.y1 - roll(10, 90), x + pane, inner.y1, glass + 15, Slot::kBlind);
        }
        fill(r.x0 - 12, r.y0 - 14, r.x1 + 12, r.y0 - 8, 80, Slot::kSill);
        fill(r.x0 - 12, r.y1 + 8, r.x1 + 12, r.y1 + 14, 70, Slot::kCornice);
    }

    void rail(const Rect& r) {
        fill(r.x0, r.y0, r.x1, r.y0 + 12, 400, Slot::kBalcony);
        fill(r.x0, r.y1 - 6, r.x1, r.y1, 400, Slot::kRailing);
        for (int x = r.x0; x + 2 <= r.x1; x += 10) fill(x, r.y0 + 12, x + 2, r.y1 - 6, 400, Slot::kRailing);
    }

    void ornament(const Rect& r) {
        const int top = r.y1 + 14, middle = (r.x0 + r.x1) / 2, half = r.width() / 2;
        const int kind = roll(0, 4);
        for (int y = 0; kind == 0 && y < half - 4; ++y) span_of_circle(middle, top + y, y, half - 4, -60, Slot::kGlass);
        for (int y = -14; kind == 2 && y <= 14; ++y) span_of_circle(middle, top + 26 + y, y, 14, 50, Slot::kAccent);
        for (int y = 0; kind == 1 && y < half / 2; ++y)
            fill(r.x0 + 2 * y, top + y, r.x1 - 2 * y, top + y + 1, 60, Slot::kCornice);
    }
    void span_of_circle(int middle, int row, int y, int radius, int mm, Slot slot) {
        const int half = static_cast<int>(std::sqrt(static_cast<double>(radius * radius - y * y)));
        fill(middle - half, row, middle + half + 1, row + 1, mm, slot);
    }

    void shop(int x, int width) {
        fill(x, 60, x + width, 320, -200, Slot::kQuoin);
        fill(x + 8, 70, x + width - 8, 312, -260, Slot::kGlass);
        fill(x + width / 2 - 3, 70, x + width / 2 + 3, 312, -240, Slot::kFrame);
    }

    void diagonal() {
        for (int i = 0; i < std::min(width_, height_) / 3; ++i)
            fill(width_ - 60 - i, height_ - 120 - i, width_ - 40 - i, height_ - 119 - i, 70, Slot::kMetal);
    }

    Canvas canvas_;
    int width_, height_;
    FacadeStyle style_;
    std::mt19937 engine_;
};

struct Grey {
    uint32_t width = 0, height = 0;
    bool wide = false;             ///< 16 bits a pixel
    std::vector<uint16_t> pixels;  ///< top row first
};

Result<Grey> read_grey(const std::string& path) {
    const auto input = OIIO::ImageInput::open(path);
    if (!input) return Error{path + ": " + OIIO::geterror()};
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.nchannels != 1) return Error{path + ": has " + std::to_string(spec.nchannels) + " channels, grey has one"};
    Grey grey{static_cast<uint32_t>(spec.width),
              static_cast<uint32_t>(spec.height),
              spec.format == OIIO::TypeDesc::UINT16,
              {}};
    grey.pixels.resize(size_t{grey.width} * grey.height);
    // Read in the file's own type: a conversion from 8 bits would stretch the numbers.
    std::vector<uint8_t> bytes(grey.wide ? 0 : grey.pixels.size());
    const bool read = grey.wide ? input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT16, grey.pixels.data())
                                : input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT8, bytes.data());
    if (!read) return Error{path + ": " + input->geterror()};
    std::copy(bytes.begin(), bytes.end(), grey.pixels.begin());
    return grey;
}

int16_t displacement(const Grey& grey, size_t pixel, int step_mm) {
    if (!grey.wide) return static_cast<int16_t>(grey.pixels[pixel]);
    const int mm = grey.pixels[pixel] - 32768;
    if (mm == kOpenDisplacement) return static_cast<int16_t>(mm);
    const int rounded = static_cast<int>(std::lround(static_cast<double>(mm) / step_mm)) * step_mm;
    return static_cast<int16_t>(std::clamp(rounded, -32767, 32767));
}

}  // namespace

std::vector<BenchFacade> paper_facades(FacadeStyle style) {
    constexpr int kSizes[4][2] = {{600, 1000}, {1536, 2048}, {1024, 768}, {930, 1166}};
    constexpr const char* kNames[] = {"regular", "irregular", "ornate"};
    std::vector<BenchFacade> facades;
    for (uint32_t i = 0; i < 4; ++i) {
        const std::string name = std::string(kNames[static_cast<int>(style)]) + ":F" + std::to_string(i + 1);
        facades.push_back({name, FacadePainting(kSizes[i][0], kSizes[i][1], style, i + 1).run()});
    }
    return facades;
}

Result<BenchFacade> read_facade(const std::string& displacement_file, const std::string& material_file, int step_mm) {
    const Result<Grey> depth = read_grey(displacement_file), material = read_grey(material_file);
    if (!depth) return depth.error();
    if (!material) return material.error();
    if (depth->width != material->width || depth->height != material->height)
        return Error{displacement_file + " and " + material_file + " differ in size"};
    FacadeMatrices matrices{depth->width, depth->height, {}, {}};
    for (uint32_t row = depth->height; row-- > 0;) {
        for (uint32_t column = 0; column < depth->width; ++column) {
            const size_t pixel = size_t{row} * depth->width + column;
            matrices.displacement_mm.push_back(displacement(*depth, pixel, step_mm));
            matrices.material.push_back(material->pixels[pixel]);
        }
    }
    Result<codec::facade::RunGrid> grid = codec::facade::make_run_grid(matrices);
    if (!grid) return Error{displacement_file + ": " + grid.error().text()};
    return BenchFacade{std::filesystem::path(displacement_file).stem().string(), std::move(grid).value()};
}

std::vector<BenchFacade> raster_facades(const std::string& folder, int step_mm) {
    constexpr std::string_view kDepth = "_depth.png";
    std::vector<std::string> names;
    std::error_code absent;
    for (const auto& file : std::filesystem::directory_iterator(folder, absent)) {
        const std::string path = file.path().string();
        if (path.ends_with(kDepth)) names.push_back(path.substr(0, path.size() - kDepth.size()));
    }
    std::sort(names.begin(), names.end());
    std::vector<BenchFacade> facades;
    for (const std::string& name : names) {
        Result<BenchFacade> facade = read_facade(name + "_depth.png", name + "_material.png", step_mm);
        if (facade) facades.push_back(std::move(facade).value());
    }
    return facades;
}

std::string surveyed_facades_folder() {
    return std::string(CITYSTREAM_SOURCE_DIR) + "/../shared/data/ingolstadt_facade_rasters";
}

}  // namespace citystream::bench

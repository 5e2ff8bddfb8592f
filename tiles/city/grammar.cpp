#include "tiles/city/grammar.h"

#include <algorithm>

namespace citystream::tiles::city::procedural {
namespace {

std::vector<int> part_ends(int begin, int length, std::initializer_list<Part> parts) {
    int fixed = 0, shares = 0;
    for (const Part& part : parts) (part.flex > 0 ? shares : fixed) += part.flex > 0 ? part.flex : part.size;
    const int rest = std::max(0, length - fixed);
    std::vector<int> ends;
    int at = begin, shares_done = 0, rest_done = 0;
    for (const Part& part : parts) {
        if (part.flex > 0) {
            shares_done += part.flex;
            const int upto = rest * shares_done / shares;
            at += upto - rest_done;
            rest_done = upto;
        } else {
            at += part.size;
        }
        ends.push_back(std::min(at, begin + length));
    }
    return ends;
}

std::vector<int> equal_ends(int begin, int length, int target) {
    const int count = std::max(1, (length + target / 2) / target);
    std::vector<int> ends;
    for (int i = 1; i <= count; ++i) ends.push_back(begin + length * i / count);
    return ends;
}

std::vector<Rect> columns(const Rect& rect, const std::vector<int>& ends) {
    std::vector<Rect> cut;
    int left = rect.x0;
    for (int end : ends) {
        cut.push_back({left, rect.y0, end, rect.y1});
        left = end;
    }
    return cut;
}

std::vector<Rect> rows(const Rect& rect, const std::vector<int>& ends) {
    std::vector<Rect> cut;
    int foot = rect.y0;
    for (int end : ends) {
        cut.push_back({rect.x0, foot, rect.x1, end});
        foot = end;
    }
    return cut;
}

size_t index_of(const std::vector<int>& breaks, int value) {
    return static_cast<size_t>(std::lower_bound(breaks.begin(), breaks.end(), value) - breaks.begin());
}

void sort_unique(std::vector<int>& breaks) {
    std::sort(breaks.begin(), breaks.end());
    breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
}

}  // namespace

Rect Rect::centred(int width, int bottom, int height) const {
    const int left = x0 + (this->width() - width) / 2;
    return {left, y0 + bottom, left + width, y0 + bottom + height};
}

std::vector<Rect> split_x(const Rect& rect, std::initializer_list<Part> parts) {
    return columns(rect, part_ends(rect.x0, rect.width(), parts));
}

std::vector<Rect> split_y(const Rect& rect, std::initializer_list<Part> parts) {
    return rows(rect, part_ends(rect.y0, rect.height(), parts));
}

std::vector<Rect> repeat_x(const Rect& rect, int target) {
    return columns(rect, equal_ends(rect.x0, rect.width(), target));
}

std::vector<Rect> repeat_y(const Rect& rect, int target) {
    return rows(rect, equal_ends(rect.y0, rect.height(), target));
}

Canvas::Canvas(int width, int height) : width_(width), height_(height) {
    fill(bounds(), 0, Slot::kWall);
}

void Canvas::fill(const Rect& rect, int displacement_mm, Slot slot) {
    const Rect inside{std::max(rect.x0, 0), std::max(rect.y0, 0), std::min(rect.x1, width_),
                      std::min(rect.y1, height_)};
    if (!inside.empty()) fills_.push_back({inside, static_cast<int16_t>(displacement_mm), slot});
}

codec::facade::RunGrid Canvas::relief() const {
    std::vector<int> xs, ys;
    for (const Fill& fill : fills_) {
        xs.insert(xs.end(), {fill.rect.x0, fill.rect.x1});
        ys.insert(ys.end(), {fill.rect.y0, fill.rect.y1});
    }
    sort_unique(xs);
    sort_unique(ys);
    codec::facade::RunGrid grid{{xs.begin(), xs.end()}, {ys.begin(), ys.end()}, {}};
    const size_t columns = grid.columns();
    grid.labels.resize(columns * grid.rows());
    for (const Fill& fill : fills_) {
        const size_t left = index_of(xs, fill.rect.x0), right = index_of(xs, fill.rect.x1);
        const uint32_t label = codec::facade::make_label(fill.displacement_mm, static_cast<uint32_t>(fill.slot));
        for (size_t row = index_of(ys, fill.rect.y0), top = index_of(ys, fill.rect.y1); row < top; ++row)
            std::fill_n(&grid.labels[row * columns + left], right - left, label);
    }
    return codec::facade::merge_equal_runs(grid);
}

}  // namespace citystream::tiles::city::procedural

#include "tiles/layers/relief_mesh.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::RunGrid;
using Point = std::array<double, 3>;

constexpr double kMetresPerTexel = 0.01, kMetresPerMm = 0.001;

bool is_open(uint32_t label) {
    return codec::facade::displacement_of(label) == codec::facade::kOpenDisplacement;
}

double depth_of(uint32_t label) {
    return codec::facade::displacement_of(label) * kMetresPerMm;
}

class ReliefBuilder {
  public:
    explicit ReliefBuilder(const RunGrid& map) : map_(map), floor_(map.depths().min_mm * kMetresPerMm) {}

    std::map<uint32_t, ReliefPart> run() {
        add_fronts();
        for (uint32_t i = 0; i <= map_.columns(); ++i) add_sides_at_column(i);
        for (uint32_t i = 0; i <= map_.rows(); ++i) add_sides_at_row(i);
        return std::move(parts_);
    }

  private:
    double x(uint32_t column) const { return map_.x_breaks[column] * kMetresPerTexel; }
    double y(uint32_t row) const { return map_.y_breaks[row] * kMetresPerTexel; }

    /// A rectangle from corner p with sides a and b; its normal is a x b.
    void add_quad(uint32_t label, const Point& p, const Point& a, const Point& b, const Point& normal) {
        ReliefPart& part = parts_[codec::facade::material_of(label)];
        const auto base = static_cast<uint32_t>(part.positions.size());
        constexpr std::array<std::array<double, 2>, 4> kCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        for (const auto& [s, t] : kCorners) {
            std::array<float, 3> position{}, direction{};
            for (size_t k = 0; k < 3; ++k) {
                position[k] = static_cast<float>(p[k] + s * a[k] + t * b[k]);
                direction[k] = static_cast<float>(normal[k]);
            }
            part.positions.push_back(position);
            part.normals.push_back(direction);
            part.texcoords.push_back({position[0], -position[1]});
        }
        for (uint32_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) part.indices.push_back(base + corner);
    }

    void add_fronts() {
        const uint32_t columns = map_.columns(), rows = map_.rows();
        std::vector<bool> done(size_t{columns} * rows);
        for (uint32_t row = 0; row < rows; ++row) {
            for (uint32_t column = 0; column < columns; ++column) {
                if (done[size_t{row} * columns + column]) continue;
                const uint32_t label = map_.label(column, row);
                if (is_open(label)) continue;
                const auto fits = [&](uint32_t c, uint32_t r) {
                    return !done[size_t{r} * columns + c] && map_.label(c, r) == label;
                };
                uint32_t right = column + 1, top = row + 1;
                while (right < columns && fits(right, row)) ++right;
                const auto row_fits = [&](uint32_t r) {
                    for (uint32_t c = column; c < right; ++c) {
                        if (!fits(c, r)) return false;
                    }
                    return true;
                };
                while (top < rows && row_fits(top)) ++top;
                for (uint32_t r = row; r < top; ++r) {
                    for (uint32_t c = column; c < right; ++c) done[size_t{r} * columns + c] = true;
                }
                add_quad(label, {x(column), y(row), depth_of(label)}, {x(right) - x(column), 0, 0},
                         {0, y(top) - y(row), 0}, {0, 0, 1});
            }
        }
    }

    /// The step between two neighbouring cells: who is higher, and the span of depths.
    struct Step {
        uint32_t label = 0;
        double low = 0, high = 0;
        bool first_is_higher = false;
        bool operator==(const Step& o) const {
            return label == o.label && low == o.low && first_is_higher == o.first_is_higher;
        }
        bool visible() const { return high > low; }
    };

    Step step_between(bool has_first, uint32_t first, bool has_second, uint32_t second) const {
        const auto height = [&](bool has, uint32_t label) { return has && !is_open(label) ? depth_of(label) : floor_; };
        const double a = height(has_first, first), b = height(has_second, second);
        Step step;
        step.first_is_higher = a > b;
        step.label = step.first_is_higher ? first : second;
        step.high = step.first_is_higher ? a : b;
        step.low = step.first_is_higher ? b : a;
        return step;
    }

    void add_sides_at_column(uint32_t column) {
        const auto step_at = [&](uint32_t row) {
            const bool left = column > 0, right = column < map_.columns();
            return step_between(left, left ? map_.label(column - 1, row) : 0, right,
                                right ? map_.label(column, row) : 0);
        };
        for (uint32_t row = 0; row < map_.rows();) {
            const Step step = step_at(row);
            uint32_t end = row + 1;
            while (end < map_.rows() && step_at(end) == step) ++end;
            if (step.visible()) {
                const Point up = {0, y(end) - y(row), 0}, out = {0, 0, step.high - step.low};
                // The lower cell is on the right: the face looks right (y x z = x); else it looks left (z x y = -x).
                if (step.first_is_higher) {
                    add_quad(step.label, {x(column), y(row), step.low}, up, out, {1, 0, 0});
                } else {
                    add_quad(step.label, {x(column), y(row), step.low}, out, up, {-1, 0, 0});
                }
            }
            row = end;
        }
    }

    void add_sides_at_row(uint32_t row) {
        const auto step_at = [&](uint32_t column) {
            const bool below = row > 0, above = row < map_.rows();
            return step_between(below, below ? map_.label(column, row - 1) : 0, above,
                                above ? map_.label(column, row) : 0);
        };
        for (uint32_t column = 0; column < map_.columns();) {
            const Step step = step_at(column);
            uint32_t end = column + 1;
            while (end < map_.columns() && step_at(end) == step) ++end;
            if (step.visible()) {
                const Point along = {x(end) - x(column), 0, 0}, out = {0, 0, step.high - step.low};
                // The lower cell is above: the face looks up (z x x = y); else it looks down (x x z = -y).
                if (step.first_is_higher) {
                    add_quad(step.label, {x(column), y(row), step.low}, out, along, {0, 1, 0});
                } else {
                    add_quad(step.label, {x(column), y(row), step.low}, along, out, {0, -1, 0});
                }
            }
            column = end;
        }
    }

    const RunGrid& map_;
    double floor_;  // metres: the least displacement
    std::map<uint32_t, ReliefPart> parts_;
};

}  // namespace

std::map<uint32_t, ReliefPart> make_relief(const RunGrid& map) {
    return ReliefBuilder(map).run();
}

}  // namespace citystream::tiles::layers

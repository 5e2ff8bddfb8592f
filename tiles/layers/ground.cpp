#include "tiles/layers/ground.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tiles/layers/decimate.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::BuildTriangle;
using quadtree::GridBox;
using quadtree::Paint;
using quadtree::PaintKind;

constexpr uint32_t kPictureTexels = 512;
constexpr size_t kWorthDecimating = 32;
constexpr int64_t kNoHeight = INT64_MIN;

BuildObject join(const std::vector<BuildObject>& parts) {
    BuildObject whole;
    whole.kind = city::ObjectKind::kTerrain;
    std::map<std::array<int64_t, 3>, uint32_t> known;
    std::map<Paint, uint32_t> paints;
    for (const BuildObject& part : parts) {
        whole.error = std::max(whole.error, part.error);
        for (BuildTriangle triangle : part.triangles) {
            for (uint32_t& vertex : triangle.vertex) {
                const GridPoint& p = part.vertices[vertex];
                const auto [found, is_new] =
                    known.try_emplace({p.x, p.y, p.z}, static_cast<uint32_t>(whole.vertices.size()));
                if (is_new) whole.vertices.push_back(p);
                vertex = found->second;
            }
            const Paint& paint = part.paints[triangle.paint];
            const auto [found, is_new] = paints.try_emplace(paint, static_cast<uint32_t>(whole.paints.size()));
            if (is_new) whole.paints.push_back(paint);
            triangle.paint = found->second;
            whole.triangles.push_back(triangle);
        }
    }
    return whole;
}

/// A regular lattice over a rectangle of the ground; samples at its points, seen from above.
struct Lattice {
    double x0 = 0, y0 = 0, step_x = 1, step_y = 1;  // grid units
    int64_t columns = 0, rows = 0;                  // points
};

/// Calls fn(column, row, weights of the corners) for each lattice point inside the triangle (borders included).
template <typename Sample>
void for_each_sample(const Lattice& lattice, const std::array<std::array<double, 2>, 3>& p, const Sample& fn) {
    const double area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
    if (area <= 0) return;
    const auto range = [](double a, double b, double c, double start, double step, int64_t count) {
        const auto [low, high] = std::minmax({a, b, c});
        return std::array<int64_t, 2>{
            std::max<int64_t>(0, std::llround(std::ceil((low - start) / step - 1e-9))),
            std::min<int64_t>(count - 1, std::llround(std::floor((high - start) / step + 1e-9)))};
    };
    const auto xs = range(p[0][0], p[1][0], p[2][0], lattice.x0, lattice.step_x, lattice.columns);
    const auto ys = range(p[0][1], p[1][1], p[2][1], lattice.y0, lattice.step_y, lattice.rows);
    for (int64_t row = ys[0]; row <= ys[1]; ++row) {
        for (int64_t column = xs[0]; column <= xs[1]; ++column) {
            const double x = lattice.x0 + static_cast<double>(column) * lattice.step_x,
                         y = lattice.y0 + static_cast<double>(row) * lattice.step_y;
            std::array<double, 3> w{};
            bool inside = true;
            for (size_t k = 0; k < 3; ++k) {
                const auto& a = p[(k + 1) % 3];
                const auto& b = p[(k + 2) % 3];
                w[k] = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
                inside = inside && w[k] >= -1e-9;
            }
            if (inside) fn(static_cast<size_t>(row * lattice.columns + column), w);
        }
    }
}

class GroundPicture {
  public:
    GroundPicture(const BuildObject& ground, const std::vector<ChartImage>& pictures, ImageCache& images)
        : ground_(ground), box_(ground.box()), images_(images) {
        // A child's picture is seen at half its resolution.
        for (const ChartImage& picture : pictures) pictures_.push_back(codec::atlas::downsample(picture));
    }

    ChartImage colours() const {
        Lattice lattice = over_box(kPictureTexels);
        lattice.x0 += lattice.step_x / 2;
        lattice.y0 += lattice.step_y / 2;
        std::vector<int64_t> heights(size_t{kPictureTexels} * kPictureTexels, kNoHeight);
        ChartImage picture;
        picture.width = picture.height = kPictureTexels;
        picture.metres_per_texel = static_cast<float>(std::max(lattice.step_x, lattice.step_y) * kMetresPerGridUnit);
        picture.rgb.resize(3 * heights.size());
        for (const BuildTriangle& triangle : ground_.triangles) draw(triangle, lattice, heights, picture);
        fill_gaps(heights, picture);
        return picture;
    }

    /// The ground as a lattice of cells x cells; the error is the greatest height difference at its vertices, metres.
    BuildObject grid(uint32_t cells, double& error) const {
        Lattice lattice = over_box(cells);
        lattice.columns = lattice.rows = cells + 1;
        std::vector<int64_t> heights(static_cast<size_t>(lattice.columns * lattice.rows), kNoHeight);
        for (const BuildTriangle& triangle : ground_.triangles) {
            for_each_sample(lattice, corners(triangle), [&](size_t at, const std::array<double, 3>& w) {
                heights[at] = std::max(heights[at], height(triangle, w));
            });
        }
        fill_neighbours(lattice, heights);
        error = height_error(lattice, heights);
        return mesh(lattice, heights);
    }

  private:
    Lattice over_box(uint32_t cells) const {
        Lattice lattice;
        lattice.step_x = static_cast<double>(std::max<int64_t>(box_.hi.x - box_.lo.x, 1)) / cells;
        lattice.step_y = static_cast<double>(std::max<int64_t>(box_.hi.y - box_.lo.y, 1)) / cells;
        lattice.columns = lattice.rows = cells;
        return lattice;
    }

    std::array<std::array<double, 2>, 3> corners(const BuildTriangle& triangle) const {
        std::array<std::array<double, 2>, 3> out{};
        for (size_t k = 0; k < 3; ++k) {
            const GridPoint& p = ground_.vertices[triangle.vertex[k]];
            out[k] = {static_cast<double>(p.x - box_.lo.x), static_cast<double>(p.y - box_.lo.y)};
        }
        return out;
    }

    int64_t height(const BuildTriangle& triangle, const std::array<double, 3>& w) const {
        double z = 0;
        for (size_t k = 0; k < 3; ++k)
            z += w[k] * static_cast<double>(ground_.vertices[triangle.vertex[k]].z - box_.lo.z);
        return box_.lo.z + std::llround(z);
    }

    void draw(const BuildTriangle& triangle, const Lattice& lattice, std::vector<int64_t>& heights,
              ChartImage& picture) const {
        const Paint& paint = ground_.paints[triangle.paint];
        const bool sampled = paint.kind == PaintKind::kGroundPicture && paint.a < pictures_.size();
        const std::array<uint8_t, 3> flat =
            paint.kind == PaintKind::kMaterial ? images_.mean_colour(paint.a) : paint.rgb();
        for_each_sample(lattice, corners(triangle), [&](size_t at, const std::array<double, 3>& w) {
            const int64_t z = height(triangle, w);
            if (z < heights[at]) return;
            heights[at] = z;
            const std::array<uint8_t, 3> rgb = sampled ? sample(pictures_[paint.a], triangle, w) : flat;
            std::copy(rgb.begin(), rgb.end(), picture.rgb.begin() + static_cast<ptrdiff_t>(3 * at));
        });
    }

    static std::array<uint8_t, 3> sample(const ChartImage& image, const BuildTriangle& triangle,
                                         const std::array<double, 3>& w) {
        std::array<size_t, 2> texel{};
        const std::array<uint32_t, 2> size = {image.width, image.height};
        for (size_t axis = 0; axis < 2; ++axis) {
            double t = 0;
            for (size_t k = 0; k < 3; ++k)
                t += w[k] * static_cast<double>(triangle.texcoord[k][axis]) / quadtree::kTexcoordUnits;
            texel[axis] = static_cast<size_t>(std::clamp(std::floor(t * size[axis]), 0.0, size[axis] - 1.0));
        }
        const uint8_t* rgb = image.rgb.data() + 3 * (texel[1] * image.width + texel[0]);
        return {rgb[0], rgb[1], rgb[2]};
    }

    /// Texels without ground get the mean colour of the rest: they show at the very edge only.
    static void fill_gaps(const std::vector<int64_t>& heights, ChartImage& picture) {
        std::array<uint64_t, 3> sum{};
        uint64_t count = 0;
        for (size_t i = 0; i < heights.size(); ++i) {
            if (heights[i] == kNoHeight) continue;
            for (size_t c = 0; c < 3; ++c) sum[c] += picture.rgb[3 * i + c];
            ++count;
        }
        for (size_t i = 0; i < heights.size() && count > 0; ++i) {
            if (heights[i] != kNoHeight) continue;
            for (size_t c = 0; c < 3; ++c) picture.rgb[3 * i + c] = static_cast<uint8_t>(sum[c] / count);
        }
    }

    /// Points without ground beside points with ground take their neighbour's height, so that the edge is not eaten
    /// away.
    static void fill_neighbours(const Lattice& lattice, std::vector<int64_t>& heights) {
        const std::vector<int64_t> before = heights;
        for (int64_t row = 0; row < lattice.rows; ++row) {
            for (int64_t column = 0; column < lattice.columns; ++column) {
                int64_t& here = heights[static_cast<size_t>(row * lattice.columns + column)];
                for (int64_t dy = -1; dy <= 1 && here == kNoHeight; ++dy) {
                    for (int64_t dx = -1; dx <= 1 && here == kNoHeight; ++dx) {
                        const int64_t x = column + dx, y = row + dy;
                        if (x >= 0 && y >= 0 && x < lattice.columns && y < lattice.rows)
                            here = before[static_cast<size_t>(y * lattice.columns + x)];
                    }
                }
            }
        }
    }

    double height_error(const Lattice& lattice, const std::vector<int64_t>& heights) const {
        double worst = 0;
        for (const GridPoint& p : ground_.vertices) {
            const double x = static_cast<double>(p.x - box_.lo.x) / lattice.step_x,
                         y = static_cast<double>(p.y - box_.lo.y) / lattice.step_y;
            const int64_t column = std::clamp<int64_t>(static_cast<int64_t>(x), 0, lattice.columns - 2);
            const int64_t row = std::clamp<int64_t>(static_cast<int64_t>(y), 0, lattice.rows - 2);
            const auto at = [&](int64_t dx, int64_t dy) {
                return heights[static_cast<size_t>((row + dy) * lattice.columns + column + dx)];
            };
            if (at(0, 0) == kNoHeight || at(1, 0) == kNoHeight || at(0, 1) == kNoHeight || at(1, 1) == kNoHeight)
                continue;
            const double s = x - static_cast<double>(column), t = y - static_cast<double>(row);
            const auto z = [&](int64_t dx, int64_t dy) { return static_cast<double>(at(dx, dy) - p.z); };
            // The quad's diagonal runs from its lower left to its upper right corner, as in mesh().
            const double difference = s >= t ? z(0, 0) * (1 - s) + z(1, 0) * (s - t) + z(1, 1) * t
                                             : z(0, 0) * (1 - t) + z(0, 1) * (t - s) + z(1, 1) * s;
            worst = std::max(worst, std::abs(difference));
        }
        return worst * kMetresPerGridUnit;
    }

    BuildObject mesh(const Lattice& lattice, const std::vector<int64_t>& heights) const {
        BuildObject out;
        out.kind = city::ObjectKind::kTerrain;
        out.paints = {Paint{PaintKind::kGroundPicture, 0, 0}};
        const auto index = [&](int64_t column, int64_t row) {
            return static_cast<size_t>(row * lattice.columns + column);
        };
        for (int64_t row = 0; row < lattice.rows; ++row) {
            for (int64_t column = 0; column < lattice.columns; ++column) {
                const int64_t z = heights[index(column, row)];
                out.vertices.push_back({box_.lo.x + std::llround(static_cast<double>(column) * lattice.step_x),
                                        box_.lo.y + std::llround(static_cast<double>(row) * lattice.step_y),
                                        z == kNoHeight ? box_.lo.z : z});
            }
        }
        const auto add = [&](const std::array<std::array<int64_t, 2>, 3>& at) {
            BuildTriangle triangle;
            for (size_t k = 0; k < 3; ++k) {
                triangle.vertex[k] = static_cast<uint32_t>(index(at[k][0], at[k][1]));
                if (heights[triangle.vertex[k]] == kNoHeight) return;
                triangle.texcoord[k] = {at[k][0] * 65536 / (lattice.columns - 1),
                                        at[k][1] * 65536 / (lattice.rows - 1)};
            }
            out.triangles.push_back(triangle);
        };
        for (int64_t row = 0; row + 1 < lattice.rows; ++row) {
            for (int64_t column = 0; column + 1 < lattice.columns; ++column) {
                add({{{column, row}, {column + 1, row}, {column + 1, row + 1}}});
                add({{{column, row}, {column + 1, row + 1}, {column, row + 1}}});
            }
        }
        return out;
    }

    const BuildObject& ground_;
    GridBox box_;
    ImageCache& images_;
    std::vector<ChartImage> pictures_;
};

bool shows_picture(const BuildObject& ground) {
    return std::any_of(ground.paints.begin(), ground.paints.end(),
                       [](const Paint& paint) { return paint.kind == PaintKind::kGroundPicture; });
}

BuildObject as_picture(const BuildObject& ground, std::vector<ChartImage>& pictures, double allowed,
                       ImageCache& images) {
    const GroundPicture maker(ground, pictures, images);
    BuildObject best;
    double best_error = 0;
    for (uint32_t cells : {16U, 32U, 64U, 128U}) {
        double error = 0;
        BuildObject candidate = maker.grid(cells, error);
        if (best.triangles.empty() || error < best_error) {
            best = std::move(candidate);
            best_error = error;
        }
        if (best_error <= allowed) break;
    }
    best.error = ground.error + static_cast<float>(best_error);
    pictures = {maker.colours()};
    return best;
}

}  // namespace

void coarsen_ground(std::vector<BuildObject>& ground, std::vector<ChartImage>& pictures, const GroundSpec& spec,
                    ImageCache& images) {
    if (ground.empty()) return;
    BuildObject whole = join(ground);
    const double allowed = spec.error_metres - static_cast<double>(whole.error);
    const bool picture = shows_picture(whole);
    if (!picture && whole.triangles.size() > kWorthDecimating) decimate(whole, allowed / 2);
    if (picture || whole.triangles.size() > spec.triangle_limit) {
        whole = as_picture(whole, pictures, spec.error_metres - static_cast<double>(whole.error), images);
    }
    ground.clear();
    ground.push_back(std::move(whole));
}

}  // namespace citystream::tiles::layers

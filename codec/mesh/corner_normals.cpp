#include "codec/mesh/corner_normals.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>

#include "codec/mesh/direction.h"
#include "codec/mesh/flat_normal_code.h"
#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_residual.h"

namespace citystream::codec::mesh {

namespace {

/// How the triangles round a point count in its normal.
enum class Weights : uint32_t { kAngle, kMax, kArea, kEqual };
constexpr uint32_t kWeightings = 4;

/// Cosines of the creases that modelling tools offer, 180 to 0 degrees, as written: no library's cosine.
constexpr std::array kCreases = {-1.0, 0.0, 0.173648, 0.5, 0.707107, 0.766044, 0.866025, 0.939693, 0.984808, 0.999999};

struct Prediction {
    uint32_t weights = 0, crease = 0;
};
constexpr uint32_t kWeightsBits = 2, kCreaseBits = 4;
static_assert(kWeightings <= 1U << kWeightsBits && kCreases.size() <= 1U << kCreaseBits);

Direction cross_of(const Direction& a, const Direction& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot_of(const Direction& a, const Direction& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// To 1e-5, of sine >= 0 and cosine times any length, by exact operations: the same everywhere.
double angle_of(double sine, double cosine) {
    constexpr double kHalfPi = std::numbers::pi / 2;
    if (cosine < 0) return 2 * kHalfPi - angle_of(sine, -cosine);
    if (sine > cosine) return kHalfPi - angle_of(cosine, sine);
    if (cosine == 0) return 0;
    const double t = sine / cosine, square = t * t;  // Abramowitz and Stegun 4.4.49
    return t * (0.9998660 + square * (-0.3302995 + square * (0.1801410 + square * (-0.0851330 + square * 0.0208351))));
}

/// Planes of triangles, and the triangles round each point.
class Surroundings {
  public:
    explicit Surroundings(const GridMesh& mesh)
        : mesh_(mesh), grid_unit_(find_grid_unit()), first_(mesh.points.size() + 1), corners_(corner_count()) {
        for (size_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            area_.push_back(cross_of(edge(a, b), edge(a, c)));
            plane_.push_back(unit_direction(area_[t]));
            for (const uint32_t point : mesh.triangles[t]) ++first_[point + 1];
        }
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
        for (uint32_t corner = 0; corner < corner_count(); ++corner) corners_[next[point_of(corner)]++] = corner;
    }

    uint32_t corner_count() const { return static_cast<uint32_t>(3 * mesh_.triangles.size()); }
    uint32_t point_of(uint32_t corner) const { return mesh_.triangles[corner / 3][corner % 3]; }
    const Direction& plane(uint32_t triangle) const { return plane_[triangle]; }

    /// The largest power of two that all differences of points are multiples of; 1 where there are none.
    double grid_unit() const { return grid_unit_; }
    double least_height(uint32_t triangle) const {
        const auto& [a, b, c] = mesh_.triangles[triangle];
        double longest = 1;
        for (const Direction& side : {edge(a, b), edge(b, c), edge(c, a)})
            longest = std::max(longest, dot_of(side, side));
        return std::sqrt(dot_of(area_[triangle], area_[triangle]) / longest);
    }

    void weigh(Weights weights) {
        parts_.resize(corner_count());
        whole_.assign(mesh_.points.size(), {0, 0, 0});
        for (uint32_t corner = 0; corner < corner_count(); ++corner) {
            const double weight = weight_of(corner, weights);
            for (size_t c = 0; c < 3; ++c) {
                parts_[corner][c] = weight * area_[corner / 3][c];
                whole_[point_of(corner)][c] += parts_[corner][c];
            }
        }
    }

    /// Sum over the triangles whose planes turn from the corner's own by no more than the crease. Of points with so
    /// many triangles that this would take long, and without a crease: over all.
    Direction normal(uint32_t corner, double crease_cosine) const {
        constexpr uint32_t kMostTriangles = 64;
        const uint32_t point = point_of(corner), first = first_[point], last = first_[point + 1];
        if (crease_cosine <= -1 || last - first > kMostTriangles) return whole_[point];
        Direction sum = {0, 0, 0};
        for (uint32_t i = first; i < last; ++i) {
            const uint32_t other = corners_[i];
            if (other != corner && dot_of(plane_[other / 3], plane_[corner / 3]) < crease_cosine) continue;
            for (size_t c = 0; c < 3; ++c) sum[c] += parts_[other][c];
        }
        return sum;
    }

  private:
    Direction edge(uint32_t from, uint32_t to) const {
        Direction edge;
        for (size_t c = 0; c < 3; ++c)
            edge[c] = static_cast<double>(mesh_.points[to][c]) - static_cast<double>(mesh_.points[from][c]);
        return edge;
    }

    /// For a length of twice the area.
    double weight_of(uint32_t corner, Weights weights) const {
        const double square = dot_of(area_[corner / 3], area_[corner / 3]);
        if (square == 0) return 0;
        if (weights == Weights::kArea) return 1;
        if (weights == Weights::kEqual) return 1 / std::sqrt(square);
        const uint32_t at = point_of(corner), base = corner - corner % 3;
        const Direction e = edge(at, point_of(base + (corner + 1) % 3)),
                        f = edge(at, point_of(base + (corner + 2) % 3));
        if (weights == Weights::kMax) return 1 / (dot_of(e, e) * dot_of(f, f));
        const double length = std::sqrt(square);
        return angle_of(length, dot_of(e, f)) / length;
    }

    double find_grid_unit() const {
        uint32_t differences = 0;
        for (const GridPoint& point : mesh_.points) {
            for (size_t c = 0; c < 3; ++c)
                differences |= static_cast<uint32_t>(point[c]) - static_cast<uint32_t>(mesh_.points[0][c]);
        }
        return differences == 0 ? 1 : static_cast<double>(differences & (0 - differences));
    }

    const GridMesh& mesh_;
    double grid_unit_;
    std::vector<uint32_t> first_, corners_;  ///< corners_[first_[p]..first_[p + 1]) lie at point p
    std::vector<Direction> area_, plane_;    ///< of triangles: twice the area long, unit
    std::vector<Direction> parts_, whole_;   ///< what each corner adds, and the sums at points
};

/// The last few different normals met at a point, newest first.
class SeenNormals {
  public:
    static constexpr uint32_t kMost = 4;
    std::span<const uint64_t> codes() const { return std::span(codes_).first(count_); }
    /// The code is the newest now.
    void meet(uint64_t code) {
        auto place = static_cast<uint32_t>(std::find(codes_.begin(), codes_.begin() + count_, code) - codes_.begin());
        if (place == count_) {
            count_ = std::min(count_ + 1, kMost);
            place = count_ - 1;
        }
        for (; place > 0; --place) codes_[place] = codes_[place - 1];
        codes_[0] = code;
    }

  private:
    std::array<uint64_t, kMost> codes_{};
    uint32_t count_ = 0;
};

/// Differences from a prediction; how large the last one was tells how large the next will be.
struct ResidualModel {
    static constexpr uint32_t kClasses = 6;
    bits::NumberModel u[kClasses], v[kClasses];  ///< by the class of the last one, by that of u
    uint32_t last = 0;

    static uint32_t class_of(uint32_t folded) {
        return std::min<uint32_t>(static_cast<uint32_t>(std::bit_width(folded)), kClasses - 1);
    }
    template <typename Coder>
    std::array<int32_t, 2> code(Coder& coder, const std::array<int32_t, 2>& residual) {
        const uint32_t folded_u = u[last].code(coder, bits::zigzag(residual[0]));
        const uint32_t folded_v = v[class_of(folded_u)].code(coder, bits::zigzag(residual[1]));
        last = class_of(std::max(folded_u, folded_v));
        return {bits::unzigzag(folded_u), bits::unzigzag(folded_v)};
    }
};

/// What does not follow from the positions.
struct NewNormals {
    bits::BitModel is_met[ResidualModel::kClasses];
    ResidualModel residuals;
};

uint32_t distance_of(const std::array<int32_t, 2>& residual) {
    return static_cast<uint32_t>(std::max(std::abs(residual[0]), std::abs(residual[1])));
}

/// One pass over the corners, the same for both directions: `codes` are read by an encoder and written by a decoder.
template <typename Coder>
class CornerCoder {
  public:
    CornerCoder(Coder& coder, const GridMesh& mesh, Surroundings& round, uint32_t normal_bits)
        : coder_(coder),
          mesh_(mesh),
          round_(round),
          bits_(normal_bits),
          seen_(mesh.points.size()),
          flat_(normal_bits) {}

    void code(std::span<uint64_t> codes, Prediction prediction) {
        const uint32_t weights = coder_.plain_bits(kWeightsBits, prediction.weights);
        const uint32_t crease = coder_.plain_bits(kCreaseBits, prediction.crease);
        weights_ = static_cast<Weights>(weights);
        crease_ = kCreases[std::min<size_t>(crease, kCreases.size() - 1)];
        for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            code_triangle(t, codes.subspan(size_t{3} * t, 3));
            for (size_t c = 0; c < 3; ++c) seen_[mesh_.triangles[t][c]].meet(codes[size_t{3} * t + c]);
        }
    }

  private:
    void code_triangle(uint32_t triangle, std::span<uint64_t> corners) {
        const auto& points = mesh_.triangles[triangle];
        const auto first = seen_[points[0]].codes(), second = seen_[points[1]].codes();
        const uint32_t met = first.empty() || second.empty() ? 0 : first[0] == second[0] ? 1 : 2;
        const uint32_t same = corners[0] == corners[1] && corners[1] == corners[2] ? 1 : 0;
        const uint32_t one_normal = coder_.bit(has_one_normal_[one_normal_ & 3][met], same);
        one_normal_ = one_normal_ << 1 | one_normal;
        if (one_normal != 0) {
            std::fill(corners.begin(), corners.end(), code_flat(triangle, corners[0]));
            return;
        }
        weigh();
        for (uint32_t c = 0; c < 3; ++c) {
            const uint64_t predicted =
                canonical_octahedral(pack_octahedral(round_.normal(3 * triangle + c, crease_), bits_), bits_);
            corners[c] = code_new(corner_, std::span(points).subspan(c, 1), predicted, corners[c]);
        }
    }

    /// Weights are reckoned when they are first needed: not where all triangles are flat.
    void weigh() {
        if (weighed_) return;
        round_.weigh(weights_);
        weighed_ = true;
    }

    uint64_t code_flat(uint32_t triangle, uint64_t code) {
        const uint64_t plane = canonical_octahedral(pack_octahedral(round_.plane(triangle), bits_), bits_);
        std::array<uint64_t, 3 * SeenNormals::kMost> met;
        size_t count = 0;
        for (const uint32_t point : mesh_.triangles[triangle]) {
            for (const uint64_t one : seen_[point].codes()) met[count++] = one;
        }
        return flat_.code(coder_, plane, doubt_of(triangle), std::span(met).first(count), code);
    }

    /// How far its plane may be off the true one, in the lattice's units.
    uint32_t doubt_of(uint32_t triangle) const {
        constexpr uint32_t kMost = FlatNormalCode::kDoubts - 1;
        const double height = round_.least_height(triangle), side = octahedral_side(bits_);
        const double units = 4 * side * round_.grid_unit();
        uint32_t doubt = 0;
        while (doubt < kMost && units >= height * static_cast<double>(uint32_t{1} << doubt)) ++doubt;
        return doubt;
    }

    /// First whether it is the one met at the point that is nearest to the prediction.
    uint64_t code_new(NewNormals& model, std::span<const uint32_t> points, uint64_t predicted, uint64_t code) {
        uint64_t nearest = 0;
        uint32_t least = ~0U;
        for (const uint32_t point : points) {
            for (const uint64_t met : seen_[point].codes()) {
                const uint32_t distance = distance_of(octahedral_residual(met, predicted, bits_));
                if (distance >= least) continue;
                least = distance;
                nearest = met;
            }
        }
        if (least != ~0U && coder_.bit(model.is_met[ResidualModel::class_of(least)], code == nearest ? 1 : 0) != 0)
            return nearest;
        std::array<int32_t, 2> difference = {};
        if constexpr (!Coder::kDecodes) difference = octahedral_residual(code, predicted, bits_);
        return octahedral_of_residual(model.residuals.code(coder_, difference), predicted, bits_);
    }

    Coder& coder_;
    const GridMesh& mesh_;
    Surroundings& round_;
    uint32_t bits_;
    double crease_ = 0;
    std::vector<SeenNormals> seen_;
    Weights weights_ = Weights::kAngle;
    bool weighed_ = false;
    bits::BitModel has_one_normal_[4][3];  ///< by the last two triangles, and what was met at the first edge
    uint32_t one_normal_ = 0;
    FlatNormalCode flat_;
    NewNormals corner_;  ///< of other triangles
};

/// What corners of triangles that are not flat would cost roughly, by some of them spread over the mesh.
uint64_t score_of(const Surroundings& round, std::span<const uint64_t> codes, double crease, uint32_t normal_bits) {
    constexpr size_t kMostSamples = 30'000;
    const size_t step = codes.size() / kMostSamples + 1;
    uint64_t score = 0;
    for (size_t i = 0; i < codes.size(); i += step) {
        const auto corners = codes.subspan(i - i % 3, 3);
        if (corners[0] == corners[1] && corners[1] == corners[2]) continue;  // flat: told otherwise
        const uint64_t predicted = pack_octahedral(round.normal(static_cast<uint32_t>(i), crease), normal_bits);
        const auto residual = octahedral_residual(codes[i], predicted, normal_bits);
        for (const int32_t part : residual) score += static_cast<uint64_t>(std::bit_width(bits::zigzag(part)));
    }
    return score;
}

/// The crease that predicts best by angles, then the weights that do so with that crease.
Prediction best_prediction(Surroundings& round, std::span<const uint64_t> codes, uint32_t normal_bits) {
    Prediction best;
    uint64_t least = ~uint64_t{0};
    const auto consider = [&](uint32_t weights, uint32_t crease) {
        const uint64_t score = score_of(round, codes, kCreases[crease], normal_bits);
        if (score >= least) return;
        least = score;
        best = {weights, crease};
    };
    round.weigh(Weights::kAngle);
    for (uint32_t crease = 0; crease < kCreases.size(); ++crease) consider(0, crease);
    const uint32_t crease = best.crease;
    for (uint32_t weights = 1; weights < kWeightings; ++weights) {
        round.weigh(static_cast<Weights>(weights));
        consider(weights, crease);
    }
    return best;
}

}  // namespace

void encode_corner_normals(bits::RangeEncoder& encoder, const GridMesh& mesh, std::span<const uint64_t> codes,
                           uint32_t normal_bits) {
    std::vector<uint64_t> canonical(codes.begin(), codes.end());
    for (uint64_t& code : canonical) code = canonical_octahedral(code, normal_bits);
    Surroundings round(mesh);
    const Prediction prediction = best_prediction(round, canonical, normal_bits);
    CornerCoder(encoder, mesh, round, normal_bits).code(canonical, prediction);
}

std::vector<uint64_t> decode_corner_normals(bits::RangeDecoder& decoder, const GridMesh& mesh, uint32_t normal_bits) {
    std::vector<uint64_t> codes(3 * mesh.triangles.size());
    Surroundings round(mesh);
    CornerCoder(decoder, mesh, round, normal_bits).code(codes, {});
    return codes;
}

std::vector<std::byte> encode_corner_normals(const GridMesh& mesh, std::span<const uint64_t> codes,
                                             uint32_t normal_bits) {
    bits::RangeEncoder encoder;
    encode_corner_normals(encoder, mesh, codes, normal_bits);
    return encoder.finish();
}

Result<std::vector<uint64_t>> decode_corner_normals(const GridMesh& mesh, uint32_t normal_bits,
                                                    std::span<const std::byte> bytes) {
    bits::RangeDecoder decoder(bytes);
    std::vector<uint64_t> codes = decode_corner_normals(decoder, mesh, normal_bits);
    const Status finished = decoder.finish();
    if (!finished) return finished.error();
    return codes;
}

}  // namespace citystream::codec::mesh

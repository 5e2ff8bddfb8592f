#include "tiles/radiance/standing_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tiles/radiance/even_light.h"
#include "tiles/radiance/sealed_place.h"

namespace citystream::tiles::radiance {

namespace {

/// Places across the surface's bounds.
constexpr int32_t kPlacesAcross = 6;
/// Of an even sky's light: a receiver that is so much off what its surface has there moves.
constexpr double kOffFit = 0.04;
/// Added to the variances of places along both axes, squared spacings: a surface with few places is taken to be lit
/// evenly rather than steeply.
constexpr double kLevelling = 0.1;
/// Cosine of the angle within which normals are alike enough for their surfaces to stand for each other.
constexpr double kAlike = 0.99;
/// Spacings. Less than kDecisiveSpacings by as much as a receiver may be away from its tile's surfaces, so that tiles
/// that share a receiver have what is around in common.
constexpr int64_t kSealedHop = 6;
static_assert(kSealedHop + 4 <= kDecisiveSpacings);

struct LitPlace {
    GridPoint point;
    std::array<double, 2> place{};  ///< spacings from the column
    double weight = 0, light = 0;
};

class Surroundings {
  public:
    Surroundings(const OccluderScene& scene, const Receiver& receiver, int64_t spacing)
        : scene_(scene),
          receiver_(receiver),
          spacing_(spacing),
          normal_(receiver_normal(receiver.surface_class, receiver.tilt)),
          even_(normal_) {}

    std::optional<GridPoint> standing(std::span<const ClassTriangle* const> surface) const {
        std::vector<LitPlace> places = lit_places(pieces_of(surface));
        const double own = even_.at(scene_, receiver_.point);
        if (places.empty()) {
            if (sealed(scene_, receiver_.point, normal_, kSealedHop * spacing_)) return std::nullopt;
            return receiver_.point;
        }
        const double light = fitted_light(places), off = std::abs(own - light);
        if (off <= kOffFit) return receiver_.point;
        std::stable_sort(places.begin(), places.end(), [&](const LitPlace& a, const LitPlace& b) {
            return std::abs(a.light - light) < std::abs(b.light - light);
        });
        for (const LitPlace& place : places) {
            if (std::abs(place.light - light) >= off) break;
            if (!buried(scene_, place.point, normal_)) return place.point;
        }
        return receiver_.point;
    }

  private:
    std::vector<LatticePiece> pieces_of(std::span<const ClassTriangle* const> surface) const {
        const std::array<int64_t, 2> column_at = {receiver_.column[0] * spacing_, receiver_.column[1] * spacing_};
        std::vector<LatticePiece> pieces;
        for (const ClassTriangle* triangle : surface) {
            const auto other = receiver_normal(triangle->surface_class, triangle->tilt);
            if (normal_[0] * other[0] + normal_[1] * other[1] + normal_[2] * other[2] < kAlike) continue;
            if (auto piece = LatticePiece::create(*triangle, column_at, spacing_)) pieces.push_back(*piece);
        }
        return pieces;
    }

    std::vector<LitPlace> lit_places(std::span<const LatticePiece> pieces) const {
        std::array<double, 2> low = {1, 1}, high = {-1, -1};
        for (const LatticePiece& piece : pieces) {
            const auto bounds = piece.bounds();
            for (size_t axis = 0; axis < 2; ++axis) {
                low[axis] = std::min(low[axis], bounds[0][axis]);
                high[axis] = std::max(high[axis], bounds[1][axis]);
            }
        }
        std::array<bool, kPlacesAcross * kPlacesAcross> taken{};
        std::vector<LitPlace> places;
        for (const LatticePiece& piece : pieces) {
            for (size_t i = 0; i < taken.size(); ++i) {
                const auto across = [&](size_t axis, size_t step) {
                    return low[axis] + (high[axis] - low[axis]) * (static_cast<double>(step) + 0.5) / kPlacesAcross;
                };
                const std::array<double, 2> place = {across(0, i % kPlacesAcross), across(1, i / kPlacesAcross)};
                const auto point = taken[i] ? std::nullopt : piece.at(place);
                if (!point) continue;
                taken[i] = true;
                // What sees nothing of the sky is mostly under something, and nobody sees it.
                const double light = even_.at(scene_, *point);
                if (light > 0)
                    places.push_back({*point, place, (1 - std::abs(place[0])) * (1 - std::abs(place[1])), light});
            }
        }
        return places;
    }

    /// At the column, of the plane that is nearest to the light of the places.
    static double fitted_light(std::span<const LitPlace> places) {
        double weight = 0;
        std::array<double, 3> mean{};  // of place and light
        for (const LitPlace& one : places) {
            weight += one.weight;
            for (size_t k = 0; k < 3; ++k) mean[k] += one.weight * (k < 2 ? one.place[k] : one.light);
        }
        for (double& v : mean) v /= weight;
        double xx = kLevelling, xy = 0, yy = kLevelling, xv = 0, yv = 0;
        for (const LitPlace& one : places) {
            const double part = one.weight / weight, x = one.place[0] - mean[0], y = one.place[1] - mean[1];
            xx += part * x * x;
            xy += part * x * y;
            yy += part * y * y;
            xv += part * x * (one.light - mean[2]);
            yv += part * y * (one.light - mean[2]);
        }
        const double determinant = xx * yy - xy * xy;
        const double along_x = (xv * yy - yv * xy) / determinant, along_y = (yv * xx - xv * xy) / determinant;
        return mean[2] - along_x * mean[0] - along_y * mean[1];
    }

    const OccluderScene& scene_;
    const Receiver& receiver_;
    int64_t spacing_;
    std::array<double, 3> normal_;
    EvenLight even_;
};

}  // namespace

std::optional<GridPoint> standing_place(const OccluderScene& scene, const Receiver& receiver,
                                        std::span<const ClassTriangle* const> surface, int64_t spacing) {
    return Surroundings(scene, receiver, spacing).standing(surface);
}

}  // namespace citystream::tiles::radiance

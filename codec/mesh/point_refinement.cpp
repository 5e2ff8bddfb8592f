#include "codec/mesh/point_refinement.h"

#include <algorithm>
#include <cmath>

namespace citystream::codec::mesh {

namespace {

/// The expected place in quarters of what is left, from kFarBelow below its middle on; and bits below the
/// kBitClasses-th are alike.
constexpr uint32_t kPlaces = 26, kFarBelow = 13;
constexpr uint32_t kBitClasses = 16, kSayings = 81, kErrorClasses = 20;

}  // namespace

PointRefinement::PointRefinement(uint32_t bits)
    : bits_(bits),
      next_({3 * kBitClasses * kPlaces, kSayings * 3, kSayings * kPlaces, kBitClasses * kErrorClasses * kPlaces}, 1,
            kBitClasses) {}

void PointRefinement::expect(std::span<const GridPoint> points, uint32_t index, const Origin& origin) {
    error_class_ = 0;
    if (index == 0) {
        for (size_t k = 0; k < 3; ++k) expected_[k] = points[0][k];
        return;
    }
    const GatePlaces places = places_of(origin.gate, points, errors_);
    if (!origin.is_apex) {
        for (size_t k = 0; k < 3; ++k) expected_[k] = places.a[k];
        return;
    }
    expected_ = predictor_.expect(places);
    const double miss = 4 * predictor_.expected_miss();
    while (error_class_ + 1 < kErrorClasses && miss > static_cast<double>(1u << error_class_)) ++error_class_;
}

void PointRefinement::set_guesses(std::span<const GridPoint> points, uint32_t axis, uint32_t index,
                                  const GateVertices& from) {
    guesses_ = {};
    if (index == 0) return;
    const int64_t a = points[from.a][axis], b = points[from.b][axis], c = points[from.c][axis];
    guesses_ = {a + b - c, a, b, c};
}

void PointRefinement::learn(const GridPoint& point, const Origin& origin) {
    Vector error{};
    for (size_t k = 0; k < 3; ++k) error[k] = point[k] - expected_[k];
    errors_.push_back(error);
    if (origin.is_apex) predictor_.learn(point);
}

void PointRefinement::set_contexts(uint32_t axis, uint32_t bit, int64_t lowest) {
    const int64_t half = int64_t{1} << bit, middle = lowest + half;
    const double quarters = std::ldexp(expected_[axis] - static_cast<double>(middle) + 0.5, 2 - static_cast<int>(bit));
    constexpr double kMost = kPlaces - 1;
    const double place_in = quarters + kFarBelow;
    const uint32_t place = !(place_in > 0) ? 0 : static_cast<uint32_t>(std::min(place_in, kMost));
    uint32_t sayings = 0;
    for (const int64_t guess : guesses_) {
        const bool inside = guess >= lowest && guess < lowest + 2 * half;
        sayings = 3 * sayings + (!inside ? 0u : guess < middle ? 1u : 2u);
    }
    const uint32_t bit_class = std::min(bit, kBitClasses - 1);
    next_.set_contexts({(axis * kBitClasses + bit_class) * kPlaces + place, sayings * 3 + axis,
                        sayings * kPlaces + place, (bit_class * kErrorClasses + error_class_) * kPlaces + place},
                       bit_class);
}

}  // namespace citystream::codec::mesh

// Where the apex of a triangle is likely to be: the parallelogram of the triangle beyond its gate, and a correction
// that is learnt while coding.
//
// The correction is a sum of vectors that the region offers (how the border goes on at both ends of the gate and what
// is behind it there, the triangle's height and base, the errors made at its corners), weighted by least squares over
// the points seen so far, old ones fading. There is a system of weights for each kind of gate, by the angles at which
// the border opens at its ends: where it is nearly closed the apex is drawn to it, where it is straight there is room.
// Both sides learn alike. Arithmetic: double, in a fixed order, with additions, multiplications, divisions and square
// roots only (IEEE 754 rounds these alike everywhere, and the build forbids contraction).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "codec/mesh/grid_mesh.h"
#include "codec/vector.h"

namespace citystream::codec::mesh {

/// The points around a gate a -> b: c is opposite in the region, `before` the start of the gate before, `after` the end
/// of the gate after (b or a where the loop has no more than two gates), `behind_before` and `behind_after` are
/// opposite those two gates.
struct GateVertices {
    uint32_t a, b, c, before, after, behind_before, behind_after;
};

/// Where they are, and how far some of them are from where they were expected.
struct GatePlaces {
    GridPoint a, b, c, before, after, behind_before, behind_after;
    Vector error_a, error_b, error_c;
};

inline GatePlaces places_of(const GateVertices& v, std::span<const GridPoint> points, std::span<const Vector> errors) {
    return {points[v.a],
            points[v.b],
            points[v.c],
            points[v.before],
            points[v.after],
            points[v.behind_before],
            points[v.behind_after],
            errors[v.a],
            errors[v.b],
            errors[v.c]};
}

class PlacePredictor {
  public:
    /// Gates by how far the border opens at both ends.
    static constexpr uint32_t kKinds = 49;

    PlacePredictor();
    /// Takes up a gate and returns the expected place.
    Vector expect(const GatePlaces& places);
    /// The apex of that gate is here.
    void learn(const GridPoint& apex);
    /// Of the gate taken up: its kind, and the sum of the coordinates' errors to expect.
    uint32_t kind() const { return kind_; }
    double expected_miss() const { return systems_[kind_].miss * length_; }

  private:
    static constexpr size_t kVectors = 9;
    struct System {
        std::array<std::array<double, kVectors>, kVectors> squares{};
        std::array<double, kVectors> products{}, weights{};
        double miss = 0.1;  ///< mean error in lengths of the gate
        uint32_t seen = 0;
    };
    void add(System& system, const Vector& error, double weight) const;
    void solve(System& system) const;

    std::array<System, kKinds> systems_;
    System shared_;
    uint32_t kind_ = 0;
    std::array<Vector, kVectors> vectors_{};
    Vector parallelogram_{}, place_{};
    double length_ = 1;
};

}  // namespace citystream::codec::mesh

#include "codec/mesh/place_predictor.h"

#include <cmath>

namespace citystream::codec::mesh {

namespace {

/// What a sum keeps of itself at each new point, and how many points the first guess (no correction) counts as.
constexpr double kKept = 1 - 1.0 / 4096, kFirstGuess = 0.5;
/// Points between two solutions; points from which on a system's own solution is taken.
constexpr uint32_t kInterval = 4, kTrusted = 32;
/// The mean error is one of about so many points; in lengths of the gate it counts as at most kMostMiss.
constexpr uint32_t kMissMemory = 32;
constexpr double kMostMiss = 2;
/// Where the border turns back, or there is none.
constexpr uint32_t kBeyondStraight = 5, kNoBorder = 6, kOpenings = 7;
static_assert(kOpenings * kOpenings == PlacePredictor::kKinds);

Vector difference(const GridPoint& a, const GridPoint& b) {
    return {double{1} * a[0] - b[0], double{1} * a[1] - b[1], double{1} * a[2] - b[2]};
}

double length_of(const Vector& v) {
    return std::sqrt(dot(v, v));
}

/// How far the border opens at `end` of a gate, from its `other` end to the next point on the border: by the cosine.
uint32_t opening(const GridPoint& end, const GridPoint& other, const GridPoint& opposite, const GridPoint& next) {
    const Vector gate = difference(other, end), border = difference(next, end), inner = difference(opposite, end);
    const double along = dot(gate, border), square = dot(gate, gate);
    // Across the gate on the side of the triangle: more than straight.
    if (dot(border, inner) * square - along * dot(gate, inner) > 0) return kBeyondStraight;
    const double lengths = std::sqrt(square * dot(border, border));
    constexpr std::array<double, 5> kCosines = {0.5, 0.1, -0.3, -0.65, -0.9};
    uint32_t result = 0;
    for (const double cosine : kCosines) result += along > cosine * lengths ? 0 : 1;
    return result;
}

}  // namespace

PlacePredictor::PlacePredictor() {
    for (size_t i = 0; i < kVectors; ++i) shared_.squares[i][i] = kFirstGuess;
    systems_.fill(shared_);
}

Vector PlacePredictor::expect(const GatePlaces& g) {
    const bool has_after = g.after != g.a && g.after != g.b, has_before = g.before != g.a && g.before != g.b;
    const uint32_t at_a = has_before ? opening(g.a, g.b, g.c, g.before) : kNoBorder;
    const uint32_t at_b = has_after ? opening(g.b, g.a, g.c, g.after) : kNoBorder;
    kind_ = at_a * kOpenings + at_b;
    for (size_t k = 0; k < 3; ++k) {
        const double a = g.a[k], b = g.b[k], c = g.c[k];
        parallelogram_[k] = a + b - c;
        vectors_[0][k] = has_after ? g.after[k] - 2 * b + c : 0;
        vectors_[1][k] = has_before ? g.before[k] - 2 * a + c : 0;
        vectors_[2][k] = c - (a + b) / 2;
        vectors_[3][k] = b - a;
        vectors_[4][k] = g.error_a[k];
        vectors_[5][k] = g.error_b[k];
        vectors_[6][k] = g.error_c[k];
        vectors_[7][k] = has_after ? b - g.behind_after[k] - (a - c) : 0;
        vectors_[8][k] = has_before ? a - g.behind_before[k] - (b - c) : 0;
    }
    length_ = length_of(difference(g.b, g.a)) + length_of(difference(g.c, g.a)) + 1;
    place_ = parallelogram_;
    const System& system = systems_[kind_].seen >= kTrusted ? systems_[kind_] : shared_;
    for (size_t i = 0; i < kVectors; ++i) {
        for (size_t k = 0; k < 3; ++k) place_[k] += system.weights[i] * vectors_[i][k];
    }
    return place_;
}

void PlacePredictor::learn(const GridPoint& apex) {
    Vector error{};
    for (size_t k = 0; k < 3; ++k) error[k] = apex[k] - parallelogram_[k];
    // Creases and corners are far off; each point counts by about the first power of its error.
    const double weight = 1 / (length_ * (length_of(error) + length_ / 256));
    double miss = 0;
    for (size_t k = 0; k < 3; ++k) miss += std::abs(apex[k] - place_[k]) / length_;
    System& system = systems_[kind_];
    miss = miss < kMostMiss ? miss : kMostMiss;
    system.miss += (miss - system.miss) / (system.seen < kMissMemory ? system.seen + 2 : kMissMemory);
    add(system, error, weight);
    add(shared_, error, weight);
}

void PlacePredictor::add(System& s, const Vector& error, double weight) const {
    for (size_t i = 0; i < kVectors; ++i) {
        double product = 0;
        for (size_t k = 0; k < 3; ++k) product += vectors_[i][k] * error[k];
        s.products[i] = s.products[i] * kKept + product * weight;
        for (size_t j = 0; j <= i; ++j) {
            double square = 0;
            for (size_t k = 0; k < 3; ++k) square += vectors_[i][k] * vectors_[j][k];
            s.squares[i][j] = s.squares[i][j] * kKept + square * weight + (i == j ? kFirstGuess * (1 - kKept) : 0);
        }
    }
    if (++s.seen % kInterval == 0) solve(s);
}

/// Cholesky: the matrix is positive definite, for the first guess is in its diagonal.
void PlacePredictor::solve(System& s) const {
    std::array<std::array<double, kVectors>, kVectors> l{};
    std::array<double, kVectors> y{};
    for (size_t i = 0; i < kVectors; ++i) {
        for (size_t j = 0; j <= i; ++j) {
            double sum = s.squares[i][j];
            for (size_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
            if (i != j)
                l[i][j] = sum / l[j][j];
            else
                l[i][i] = std::sqrt(sum > 1e-9 ? sum : 1e-9);
        }
        double sum = s.products[i];
        for (size_t k = 0; k < i; ++k) sum -= l[i][k] * y[k];
        y[i] = sum / l[i][i];
    }
    for (size_t i = kVectors; i-- > 0;) {
        double sum = y[i];
        for (size_t k = i + 1; k < kVectors; ++k) sum -= l[k][i] * s.weights[k];
        s.weights[i] = sum / l[i][i];
    }
}

}  // namespace citystream::codec::mesh

#include "codec/mesh/hidden_lattice.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace citystream::codec::mesh {

namespace {

__extension__ using Wide = __int128;
using Point = HiddenLattice::Point;
using Rings = std::span<const std::vector<Point>>;

constexpr size_t kTerms = 6;
constexpr double kLinearUnit = 4294967296.0, kSquareUnit = 281474976710656.0;  // 2^32, 2^48
using Terms = std::array<double, kTerms>;

Terms terms_of(double i, double j) {
    return {1, i, j, i * i, i * j, j * j};
}
double sum_of(const Terms& a, const Terms& b) {
    double sum = 0;
    for (size_t k = 0; k < kTerms; ++k) sum += a[k] * b[k];
    return sum;
}

/// Lengths of edges along one axis, counted.
class Lengths {
  public:
    static constexpr int32_t kMost = 1 << 16;
    Lengths(Rings rings, size_t axis) {
        std::vector<int32_t> lengths;
        for (const auto& ring : rings) {
            for (size_t p = 0; p < ring.size(); ++p) {
                const int64_t d = std::abs(int64_t{ring[(p + 1) % ring.size()][axis]} - ring[p][axis]);
                if (d != 0 && d < kMost) lengths.push_back(static_cast<int32_t>(d));
            }
        }
        std::sort(lengths.begin(), lengths.end());
        for (const int32_t length : lengths) {
            if (counts_.empty() || counts_.back().length != length) counts_.push_back({length, 0});
            ++counts_.back().count;
        }
    }
    /// The spacing that lengths are most clearly multiples of; 0 when there is none.
    double spacing() const {
        for (const double s : kDecimal) {
            if (unevenness(s, kMost) < kClear) return s;
        }
        double best = 0, best_score = 1;
        for (double s = kLeastSpacing; s < kMostSpacing; s += s * kStep) {
            const double score = unevenness(s, kMostMultiple * s);
            if (score < best_score) {
                best_score = score;
                best = s;
            }
        }
        return best > 0 ? refined(best) : 0;
    }

  private:
    /// Decimetres and centimetres in 2^-10 m. As these are known exactly, lengths of any number of them count.
    static constexpr double kDecimal[] = {102.4, 10.24};
    static constexpr double kClear = 0.1;
    static constexpr double kLeastSpacing = 2, kMostSpacing = 4096, kStep = 1.0 / 1024;
    /// Multiples looked at; with more, a spacing would have to be known better than kStep.
    static constexpr double kMostMultiple = 32.5;
    /// Least number of lengths, and how many standard deviations from chance are enough.
    static constexpr double kLeastCount = 40, kSigmas = 7;
    /// Above this spacing integers are as good as any numbers.
    static constexpr double kSmooth = 32;
    struct Count {
        int32_t length;
        double count;
    };

    /// Below 2^15 multiples, so that truncation is std::floor, which would be a call.
    static double off_multiple(int32_t length, double s) {
        const double multiple = length / s;
        return multiple - static_cast<int32_t>(multiple + 0.5);
    }

    /// Mean square of the distance from the nearest multiple, over that of all integers; 1 where it may be chance.
    double unevenness(double s, double most) const {
        double found = 0, count = 0;
        for (const Count& entry : counts_) {
            if (2 * entry.length <= s) continue;
            if (entry.length >= most) break;
            const double off = off_multiple(entry.length, s);
            found += entry.count * off * off;
            count += entry.count;
        }
        if (count < kLeastCount) return 1;
        const double ratio = found / count / by_chance(s);
        return ratio < 1 && (1 - ratio) * (1 - ratio) * count > kSigmas * kSigmas ? ratio : 1;
    }

    static double by_chance(double s) {
        if (s > kSmooth) return 1.0 / 12;
        double any = 0, all = 0;
        for (auto length = static_cast<int32_t>(s / 2) + 1; length < kMostMultiple * s; ++length) {
            any += off_multiple(length, s) * off_multiple(length, s);
            all += 1;
        }
        return any / all;
    }

    /// Least squares over ever longer lengths.
    double refined(double s) const {
        for (double most = kMostMultiple; most < 600; most *= 2) {
            double up = 0, down = 0;
            for (const Count& entry : counts_) {
                if (entry.length >= most * s) break;
                const double k = std::floor(entry.length / s + 0.5);
                if (std::abs(entry.length / s - k) > 0.35) continue;
                up += entry.count * k * entry.length;
                down += entry.count * k * k;
            }
            if (down > 0) s = up / down;
        }
        return s;
    }

    std::vector<Count> counts_;  ///< ascending
};

/// The binary logarithm of x >= 1, by operations that are exact everywhere.
double log2_of(double x) {
    double whole = 0;
    while (x >= 2) {
        x /= 2;
        ++whole;
    }
    const double t = (x - 1) / (x + 1), square = t * t;
    double power = t, sum = 0;
    for (int k = 1; k < 20; k += 2) {
        sum += power / k;
        power *= square;
    }
    return whole + sum * 2.8853900817779268;  // 2 / ln 2
}

/// Recursive least squares of one axis' polynomial.
class AxisFit {
  public:
    AxisFit(size_t axis, double spacing, double other_spacing, double start) {
        const double turn = 0.003 * spacing, drift = 3e-8 * spacing;
        terms_[0] = start;
        terms_[1 + axis] = spacing;
        const double spread[kTerms] = {spacing,
                                       axis == 0 ? 3e-4 * spacing : turn * other_spacing / spacing,
                                       axis == 0 ? turn : 3e-4 * spacing,
                                       drift,
                                       drift,
                                       drift};
        for (size_t k = 0; k < kTerms; ++k) covariance_[k][k] = spread[k] * spread[k];
    }
    double at(const Terms& t) const { return sum_of(terms_, t); }
    void learn(const Terms& t, double value) {
        constexpr double kNoise = 0.2;
        Terms gain{};
        for (size_t k = 0; k < kTerms; ++k) gain[k] = sum_of(covariance_[k], t);
        const double scale = 1 / (sum_of(gain, t) + kNoise), error = value - at(t);
        for (size_t k = 0; k < kTerms; ++k) {
            terms_[k] += gain[k] * scale * error;
            for (size_t l = 0; l < kTerms; ++l) covariance_[k][l] -= gain[k] * gain[l] * scale;
        }
    }
    const Terms& terms() const { return terms_; }

  private:
    Terms terms_{};
    std::array<Terms, kTerms> covariance_{};
};

/// Lattice numbers of a position, by the polynomials' inverse.
std::array<double, 2> invert(const Terms& x, const Terms& y, double px, double py) {
    const double det = x[1] * y[2] - x[2] * y[1];
    double i = 0, j = 0;
    for (int round = 0; round < 6; ++round) {
        const Terms t = terms_of(i, j);
        const double ex = px - sum_of(x, t), ey = py - sum_of(y, t);
        i += (ex * y[2] - ey * x[2]) / det;
        j += (ey * x[1] - ex * y[1]) / det;
    }
    return {i, j};
}

/// Also of what is no number.
int64_t rounded(double value) {
    constexpr double kMost = 4.0e18;
    return value > -kMost && value < kMost ? static_cast<int64_t>(std::floor(value + 0.5)) : 0;
}

/// Keeps of the terms what matters over the area.
void shorten(HiddenLattice& lattice, Rings rings) {
    uint32_t most = 0;
    for (const auto& ring : rings) {
        for (const Point& p : ring) {
            const Point number = lattice.nearest(p);
            for (const int32_t n : number) most = std::max(most, static_cast<uint32_t>(std::abs(n)));
        }
    }
    lattice.reach = std::min(static_cast<uint32_t>(std::bit_width(most)), 30u);
    for (HiddenLattice::Axis& axis : lattice.axes) {
        for (size_t k = 0; k < kTerms; ++k) {
            const uint32_t dropped = lattice.dropped_bits(k);
            const int64_t half = dropped > 0 ? int64_t{1} << (dropped - 1) : 0;
            axis.terms[k] = (axis.terms[k] + half) >> dropped << dropped;
        }
    }
}

Terms terms_of(const HiddenLattice::Axis& axis) {
    Terms terms;
    for (size_t k = 0; k < kTerms; ++k)
        terms[k] = static_cast<double>(axis.terms[k]) / (k < 3 ? kLinearUnit : kSquareUnit);
    return terms;
}

HiddenLattice fitted(Rings rings, double sx, double sy) {
    AxisFit x(0, sx, sy, rings[0][0][0]), y(1, sy, sx, rings[0][0][1]);
    for (int pass = 0; pass < 2; ++pass) {
        for (const auto& ring : rings) {
            for (const Point& p : ring) {
                const auto [i, j] = invert(x.terms(), y.terms(), p[0], p[1]);
                const Terms t = terms_of(std::floor(i + 0.5), std::floor(j + 0.5));
                if (std::abs(p[0] - x.at(t)) > 0.4 * sx || std::abs(p[1] - y.at(t)) > 0.4 * sy) continue;
                x.learn(t, p[0]);
                y.learn(t, p[1]);
            }
        }
    }
    HiddenLattice lattice;
    for (size_t a = 0; a < 2; ++a) {
        const Terms& terms = (a == 0 ? x : y).terms();
        for (size_t k = 0; k < kTerms; ++k)
            lattice.axes[a].terms[k] = rounded(terms[k] * (k < 3 ? kLinearUnit : kSquareUnit));
    }
    shorten(lattice, rings);
    return lattice;
}

/// Two spacings this large and their aliases cannot be taken for each other.
constexpr double kMostAliased = 4;
/// What a lattice costs to say, and what it must be good for.
constexpr double kLeastGain = 400;

/// Bits saved over all points: fewer places, less what is left over in each sixteenth of a grid step.
double gain_of(const HiddenLattice& lattice, Rings rings) {
    constexpr int32_t kMostLeft = 64;
    double gain = 0;
    for (size_t a = 0; a < 2; ++a) {
        const double spacing = static_cast<double>(lattice.axes[a].terms[1 + a]) / kLinearUnit;
        if (spacing < 1) return 0;
        std::vector<uint32_t> counts(16 * (2 * kMostLeft + 1));
        double total[16] = {}, points = 0;
        for (const auto& ring : rings) {
            for (const Point& p : ring) {
                const int64_t place = lattice.place_of(lattice.nearest(p))[a] + (1 << 15);
                const auto left =
                    static_cast<int32_t>(std::clamp<int64_t>(p[a] - (place >> 16), -kMostLeft, kMostLeft));
                const auto part = static_cast<size_t>(place >> 12 & 15);
                ++counts[part * (2 * kMostLeft + 1) + static_cast<size_t>(left + kMostLeft)];
                ++total[part];
                ++points;
            }
        }
        gain += points * log2_of(spacing);
        for (const double t : total) gain -= t > 0 ? t * log2_of(t) : 0;
        for (const uint32_t c : counts) gain += c > 0 ? c * log2_of(c) - log2_of(points) / 2 : 0;
    }
    return gain;
}

}  // namespace

HiddenLattice::Place HiddenLattice::place_of(Point number) const {
    const int64_t i = number[0], j = number[1];
    Place place{};
    for (size_t a = 0; a < 2; ++a) {
        const auto& t = axes[a].terms;
        const Wide linear = Wide{t[0]} + Wide{t[1]} * i + Wide{t[2]} * j;
        const Wide square = Wide{t[3]} * (i * i) + Wide{t[4]} * (i * j) + Wide{t[5]} * (j * j);
        const Wide sum = (linear >> 16) + (square >> 32);
        constexpr Wide kMost = Wide{1} << 46;
        place[a] = static_cast<int64_t>(std::clamp(sum, -kMost, kMost));
    }
    return place;
}

Point HiddenLattice::nearest(Point point) const {
    const auto [i, j] = invert(terms_of(axes[0]), terms_of(axes[1]), point[0], point[1]);
    const auto bounded = [](double v) { return v > -1e9 && v < 1e9 ? static_cast<int32_t>(std::floor(v + 0.5)) : 0; };
    return {bounded(i), bounded(j)};
}

uint32_t HiddenLattice::dropped_bits(size_t term) const {
    constexpr uint32_t kPlaceBits = 8;  // of a grid unit
    const uint32_t unit = term < 3 ? 32 : 48, power = term == 0 ? 0 : term < 3 ? 1 : 2;
    const uint32_t kept = kPlaceBits + power * reach;
    return kept < unit ? unit - kept : 0;
}

std::optional<HiddenLattice> find_hidden_lattice(Rings rings) {
    if (rings.empty() || rings[0].empty()) return std::nullopt;
    const double sx = Lengths(rings, 0).spacing(), sy = Lengths(rings, 1).spacing();
    if (sx <= 0 || sy <= 0) return std::nullopt;
    std::optional<HiddenLattice> best;
    double most = kLeastGain;
    // Of integers, multiples of s are also about multiples of s / (s - 1).
    for (const bool alias : {false, true}) {
        if (alias && std::max(sx, sy) > kMostAliased) break;
        const HiddenLattice lattice = alias ? fitted(rings, sx / (sx - 1), sy / (sy - 1)) : fitted(rings, sx, sy);
        const double gain = gain_of(lattice, rings);
        if (gain <= most) continue;
        most = gain;
        best = lattice;
    }
    return best;
}

}  // namespace citystream::codec::mesh

#include "codec/atlas/facade_tint.h"

#include <cassert>
#include <cmath>

namespace citystream::codec::atlas {

double tint_parameter(TintField field, double x, double y, double step) {
    const double across = std::abs(x), along = std::abs(y);
    return (field == TintField::kProduct ? across * along : across + along) / step;
}

Tint tint_at(std::span<const Tint> palette, double t) {
    assert(!palette.empty() && t >= 0 && std::isfinite(t));
    const double whole = std::floor(t);
    const auto count = static_cast<double>(palette.size());
    const auto first = static_cast<size_t>(std::fmod(whole, count));
    const Tint& a = palette[first];
    const Tint& b = palette[(first + 1) % palette.size()];
    const auto f = static_cast<float>(t - whole);
    Tint tint;
    for (size_t c = 0; c < tint.size(); ++c) tint[c] = a[c] * (1 - f) + b[c] * f;
    return tint;
}

}  // namespace citystream::codec::atlas

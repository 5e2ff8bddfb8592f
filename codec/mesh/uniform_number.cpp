#include "codec/mesh/uniform_number.h"

#include <algorithm>
#include <cmath>

namespace citystream::codec::mesh {
namespace {

double most_index(uint32_t bits) {
    return std::ldexp(1.0, static_cast<int>(bits)) - 1;
}

}  // namespace

double UniformRange::step() const {
    return (high - low) / most_index(bits);
}

uint32_t UniformRange::pack(double value) const {
    if (!(value > low) || !(high > low)) return 0;
    if (value >= high) return static_cast<uint32_t>(most_index(bits));
    const double index = std::floor((value - low) / (high - low) * most_index(bits) + 0.5);
    return static_cast<uint32_t>(std::clamp(index, 0.0, most_index(bits)));
}

double UniformRange::unpack(uint32_t index) const {
    const double last = most_index(bits);
    // The upper end comes out exactly.
    return index >= last ? high : low + (high - low) * (index / last);
}

double float_spacing(double magnitude) {
    return std::ldexp(1.0, std::ilogb(magnitude) - 23);
}

}  // namespace citystream::codec::mesh

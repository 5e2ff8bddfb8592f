#include "codec/atlas/facade_tint.h"

#include <cassert>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "codec/atlas/tint_layout.h"

namespace citystream::codec::atlas {
namespace {

constexpr double kLeastStep = 1, kMostStep = 1e5;  // metres

#define TINT(red, green, blue)    \
    Tint {                        \
        red##F, green##F, blue##F \
    }
constexpr std::array<Tint, TINT_COLOURS> kPalette = {TINT_PALETTE};
#undef TINT

std::optional<double> number_in(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

}  // namespace

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

Result<FacadeTint> parse_facade_tint(std::string_view text) {
    FacadeTint tint;
    const size_t comma = text.find(',');
    const auto strength = number_in(text.substr(0, comma));
    const auto step = comma == text.npos ? std::optional(tint.step_metres) : number_in(text.substr(comma + 1));
    if (!strength || !step || *strength < 0 || *strength > 1 || *step < kLeastStep || *step > kMostStep)
        return Error{std::string(text) + " is not STRENGTH[,METRES]: 0 to 1, 1 to 100000"};
    tint.strength = *strength;
    tint.step_metres = *step;
    return tint;
}

std::span<const Tint> tint_palette() {
    return kPalette;
}

double tint_place(const std::array<double, 3>& position, const FacadeTint& tint) {
    const double place = std::fmod((position[0] + position[1]) / tint.step_metres, TINT_COLOURS);
    const double wrapped = place < 0 ? place + TINT_COLOURS : place;
    return wrapped < TINT_COLOURS ? wrapped : 0;
}

}  // namespace citystream::codec::atlas

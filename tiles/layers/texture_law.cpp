#include "tiles/layers/texture_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <vector>

namespace citystream::tiles::layers {
namespace {

using codec::atlas::LevelLaw;

constexpr double kFinestTexel = 1e-3, kCoarsestTexel = 1e3;  // metres

std::optional<double> number_in(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::vector<std::string_view> split(std::string_view text) {
    std::vector<std::string_view> parts;
    for (size_t comma = text.find(','); comma != std::string_view::npos; comma = text.find(',')) {
        parts.push_back(text.substr(0, comma));
        text.remove_prefix(comma + 1);
    }
    parts.push_back(text);
    return parts;
}

Error wrong(std::string_view text) {
    return Error{fmt::format("{} is not thesis, METRES or METRES,FACTOR,LEVELS", text)};
}

}  // namespace

double TextureLaw::inner_texel(uint32_t height, double error_metres) const {
    if (levels) return levels->metres_per_texel(std::min(height, levels->levels - 1));
    return std::max(finest, error_metres / 2);
}

uint32_t TextureLaw::mips(uint32_t height) const {
    assert(levels.has_value());
    return levels->mips(std::min(height, levels->levels - 1));
}

Result<TextureLaw> parse_texture_law(std::string_view text) {
    TextureLaw law;
    if (text == "thesis") {
        law.levels = codec::atlas::thesis_law();
        law.finest = law.levels->finest;
        return law;
    }
    const auto parts = split(text);
    std::vector<double> numbers;
    for (const std::string_view part : parts) {
        const auto number = number_in(part);
        if (!number) return wrong(text);
        numbers.push_back(*number);
    }
    if (numbers.size() != 1 && numbers.size() != 3) return wrong(text);
    law.finest = numbers[0];
    if (!(law.finest >= kFinestTexel && law.finest <= kCoarsestTexel))
        return Error{fmt::format("{} metres a texel is not {} to {}", parts[0], kFinestTexel, kCoarsestTexel)};
    law.levels.reset();
    if (numbers.size() == 1) return law;
    // Checked as a number before it becomes a count.
    if (!(numbers[2] >= 1 && numbers[2] <= 255) || numbers[2] != std::floor(numbers[2]))
        return Error{fmt::format("{} is not a number of levels", parts[2])};
    law.levels = LevelLaw{law.finest, numbers[1], static_cast<uint32_t>(numbers[2]), codec::atlas::MipRule::kFull};
    if (const Status status = codec::atlas::check_law(*law.levels); !status) return status.error();
    return law;
}

std::string to_string(const TextureLaw& law) {
    if (law.levels == codec::atlas::thesis_law()) return "thesis";
    if (law.levels) return fmt::format("{},{},{}", law.finest, law.levels->factor, law.levels->levels);
    return fmt::format("{}", law.finest);
}

}  // namespace citystream::tiles::layers

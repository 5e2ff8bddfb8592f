#include "client/select/relief_arguments.h"

namespace citystream::client {

std::vector<std::string> map_level_names() {
    std::vector<std::string> names = {"auto"};
    for (uint32_t level = 0; level < codec::facade::kMostFacadeLevels; ++level) names.push_back(std::to_string(level));
    return names;
}

Result<ReliefOptions> parse_relief_options(const std::string& map_level, std::optional<double> tolerance_pixels) {
    ReliefOptions options;
    options.tolerance_pixels = tolerance_pixels;
    if (map_level == "auto") return options;
    for (uint32_t level = 0; level < codec::facade::kMostFacadeLevels; ++level) {
        if (map_level != std::to_string(level)) continue;
        options.map_level = level;
        return options;
    }
    return Error{"--map-level " + map_level + ": expected auto, or 0 (the coarsest) to " +
                 std::to_string(codec::facade::kMostFacadeLevels - 1)};
}

}  // namespace citystream::client

// Reading how relief shall be drawn from what people type.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/select/facade_dictionary.h"
#include "codec/result.h"

namespace citystream::client {

/// "auto" and every level: what --map-level takes.
std::vector<std::string> map_level_names();

/// Error: `map_level` is none of them.
Result<ReliefOptions> parse_relief_options(const std::string& map_level, std::optional<double> tolerance_pixels);

}  // namespace citystream::client

// Reading what people type: durations.
#pragma once

#include <cstdint>
#include <string>

#include "codec/result.h"

namespace citystream::client {

/// "30s", "500ms", "2m", "1h", "45" (seconds): above 0, at most a day. In seconds.
Result<double> parse_load_duration(const std::string& text);

}  // namespace citystream::client

// Reading what people type: durations, byte amounts.
#pragma once

#include <cstdint>
#include <string>

#include "codec/result.h"

namespace citystream::client {

/// "30s", "500ms", "2m", "1h", "45" (seconds): above 0, at most a day. In seconds.
Result<double> parse_load_duration(const std::string& text);
/// "512MiB", "1GiB", "64KiB", "500MB", "1000" (bytes): at least 1.
Result<uint64_t> parse_load_bytes(const std::string& text);

}  // namespace citystream::client

// Sizes as people write them: 512MiB, 1GiB, 64KiB, 2MB, 1000000.
#pragma once

#include <cstdint>
#include <string>

#include "codec/result.h"

namespace citystream::client {

/// Bytes of "NUMBER[UNIT]": B, KiB, MiB, GiB, TiB (powers of 1024), KB, MB, GB, TB (powers of 1000); any case;
/// fractions allowed.
Result<uint64_t> parse_byte_count(const std::string& text);

}  // namespace citystream::client

// Says where a text stops being JSON (the fast parser that we use does not).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "codec/result.h"

namespace citystream::tiles::city {

/// The error for `text`, which starts at line `first_line` and byte `first_byte` of `file` and which the parser refused
/// with `reason`.
Error json_fault(std::string_view text, const std::string& file, uint64_t first_line, uint64_t first_byte,
                 const std::string& reason);

}  // namespace citystream::tiles::city

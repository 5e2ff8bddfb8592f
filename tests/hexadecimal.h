// Bytes as format pages print them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace citystream::test {

/// Two lower-case digits a byte.
inline std::string hexadecimal(std::span<const std::byte> bytes) {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    for (const std::byte byte : bytes) {
        text += kDigits[std::to_integer<uint32_t>(byte) >> 4];
        text += kDigits[std::to_integer<uint32_t>(byte) & 15];
    }
    return text;
}

}  // namespace citystream::test

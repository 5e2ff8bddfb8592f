// A small HTTP client for measuring servers on this machine: blocking keep-alive connections that ask for byte ranges
// and compare every answer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace citystream::bench {

/// One entry of a city, on the server and as it must arrive.
struct ServedFile {
    std::string path;  ///< of the URL, from '/'
    std::span<const std::byte> content;
};

struct RangeLoad {
    uint16_t port = 0;
    int connections = 1;
    uint64_t range_bytes = 65536;
    double seconds = 0.5;
};

struct RangeResult {
    uint64_t bytes = 0, answers = 0;
    double seconds = 0;
    std::vector<double> latencies;  ///< seconds, one an answer
    std::string failure;            ///< empty when every answer was 206 with the right bytes
};

/// Every connection (a thread of its own) asks for one range after the other for the given time, each at the next place
/// of a fixed sequence.
RangeResult load_ranges(const RangeLoad& load, std::span<const ServedFile> files);

/// True once something accepts connections on the port (waits at most `seconds`).
bool wait_for_port(uint16_t port, double seconds);

}  // namespace citystream::bench

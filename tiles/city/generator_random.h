// Integer hashes and the random stream of the generator: the same numbers on every machine.
#pragma once

#include <cstdint>

namespace citystream::tiles::city::procedural {

/// SplitMix64's finaliser: a bijection of 64-bit words whose output bits look independent.
constexpr uint64_t mix(uint64_t x) {
    x += 0x9E3779B97F4A7C15ULL;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
    return x ^ (x >> 31);
}

/// One word from a seed and up to three coordinates (negative ones welcome); order matters.
constexpr uint64_t hash(uint64_t seed, int64_t a, int64_t b = 0, int64_t c = 0) {
    return mix(mix(mix(mix(seed) ^ static_cast<uint64_t>(a)) ^ static_cast<uint64_t>(b)) ^ static_cast<uint64_t>(c));
}

/// A stream of random numbers, copied by value.
class Random {
  public:
    explicit constexpr Random(uint64_t seed) : state_(seed) {}

    constexpr uint64_t next() { return mix(state_++); }

    /// 0..count - 1; count must be positive.
    constexpr int below(int count) { return static_cast<int>(((next() >> 32) * static_cast<uint64_t>(count)) >> 32); }

    /// least..greatest, both included.
    constexpr int between(int least, int greatest) { return least + below(greatest - least + 1); }

    constexpr bool chance(int percent) { return below(100) < percent; }

  private:
    uint64_t state_;
};

}  // namespace citystream::tiles::city::procedural

// Runs GLSL of shaders/ on the CPU: stands in for shaders/words.glsl with glm's types and a word source that checks
// every index and counts loads. The sources are written in the common subset of GLSL and C++ (see words.glsl).
//
//   #include "tests/shaders/glsl_on_cpu.h"
//   namespace {
//   using namespace citystream::glsl;
//   #include "shaders/facade_step_patch.glsl"
//   }
//
// Compile such files with -fsingle-precision-constant (see citystream_facade_on_cpu in tests/CMakeLists.txt), so
// that 1.0 is a float as in GLSL; a file with doubles of its own gets at them through a plain header (facade_on_cpu.h).
// GCC only.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/integer.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

// The guard of the file that this one stands in for.
#define CITYSTREAM_WORDS_GLSL
#define OUT(type) type&
#define INOUT(type) type&
#define COUNT_STEP() (void)++citystream::glsl::counted_steps
#define STEP_BOUND(most) citystream::glsl::min<citystream::glsl::uint>(most, citystream::glsl::step_limit)

namespace citystream::glsl {

// NOLINTNEXTLINE: GLSL's names.
using namespace glm;
using uint = uint32_t;

static_assert(std::is_same_v<decltype(1.0), float>, "compile GLSL with -fsingle-precision-constant");

inline thread_local uint64_t counted_loads = 0;  ///< calls of layer_word and layer_words4
inline thread_local uint64_t counted_words = 0;  ///< words that they gave
inline thread_local uint64_t counted_steps = 0;
inline thread_local uint step_limit = ~0u;  ///< of a ray, below the stepper's own bound

/// Words of a layer; what uvec2 references refer to.
using LayerWords = std::span<const uint32_t>;

/// The reference lives as long as `layer`.
inline uvec2 layer_reference(const LayerWords& layer) {
    const auto address = reinterpret_cast<uintptr_t>(&layer);
    return {static_cast<uint32_t>(address), static_cast<uint32_t>(uint64_t{address} >> 32)};
}

inline const LayerWords& layer_at(uvec2 layer) {
    return *reinterpret_cast<const LayerWords*>(static_cast<uintptr_t>(layer.x | uint64_t{layer.y} << 32));
}

inline void check_word(const LayerWords& words, uint64_t index) {
    if (index < words.size()) return;
    throw std::out_of_range("shader reads word " + std::to_string(index) + " of " + std::to_string(words.size()));
}

inline uint layer_word(uvec2 layer, uint index) {
    const LayerWords& words = layer_at(layer);
    check_word(words, index);
    ++counted_loads;
    ++counted_words;
    return words[index];
}

/// Words of the group behind the layer's last are undefined on the GPU; here they are a pattern that no lookup expects.
inline uvec4 layer_words4(uvec2 layer, uint group) {
    const LayerWords& words = layer_at(layer);
    const uint64_t first = uint64_t{group} * 4;
    check_word(words, first);
    ++counted_loads;
    counted_words += 4;
    uvec4 value(0xdeadbeefU);
    for (int i = 0; i < 4 && first + static_cast<uint64_t>(i) < words.size(); ++i)
        value[i] = words[first + static_cast<uint64_t>(i)];
    return value;
}

}  // namespace citystream::glsl

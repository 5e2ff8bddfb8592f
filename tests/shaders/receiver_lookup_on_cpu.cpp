#include "tests/shaders/receiver_lookup_on_cpu.h"

#include "tests/shaders/glsl_on_cpu.h"

namespace citystream::shaders_test {
namespace {

// NOLINTNEXTLINE: the shaders use GLSL's names.
using namespace citystream::glsl;

#include "shaders/receiver_lookup.glsl"

}  // namespace

LookedUpReceivers receivers_on_cpu(std::span<const uint32_t> words, const std::array<float, 3>& point,
                                   const std::array<float, 3>& normal) {
    const uint64_t loads_before = counted_loads;
    const ReceiverShares shares = receiver_shares(layer_reference(words), vec3(point[0], point[1], point[2]),
                                                  vec3(normal[0], normal[1], normal[2]));
    LookedUpReceivers result{0,  shares.own_surface,          {shares.normal.x, shares.normal.y, shares.normal.z}, {},
                             {}, counted_loads - loads_before};
    for (int k = 0; k < 4; ++k) {
        if (!(shares.weight[k] > 0)) continue;
        result.receiver[result.count] = shares.receiver[k];
        result.weight[result.count++] = shares.weight[k];
    }
    return result;
}

}  // namespace citystream::shaders_test

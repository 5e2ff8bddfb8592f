// stb_rect_pack behind our own types: the packer that most others measure themselves against.
#pragma once

#include <span>
#include <vector>

#include "codec/atlas/rectangle_packing.h"

namespace citystream::bench {

enum class StbHeuristic { kBottomLeft, kBestFit };

/// Places like the sizes; width 0 where one did not fit.
std::vector<codec::atlas::Rectangle> pack_with_stb(std::span<const codec::atlas::RectangleSize> sizes,
                                                   codec::atlas::RectangleSize bin, StbHeuristic heuristic);

}  // namespace citystream::bench

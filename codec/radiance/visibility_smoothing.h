// Lone samples of what receivers see, made like those around them: bits that take much of the wire and light little.
//
// Of the squares of two by two samples that visibility_wire.h tells last, those of which all four are above the
// receiver's plane and one differs from the others become even. A receiver's samples depend on nothing but its own bits
// and frame, so one that lies in two tiles stays the same in both.
#pragma once

#include "codec/radiance/visibility_bits.h"

namespace citystream::codec::radiance {

/// Changes samples, in the order of their squares, as long as no receiver has more than `most_error` wrong: relative
/// radiance, the part of an even sky's light that a hemisphere of samples lets through. Gives the most that a receiver
/// has wrong. 0 or less: nothing changes. O(samples).
double smooth_visibility(VisibilityTile& tile, double most_error);

}  // namespace citystream::codec::radiance

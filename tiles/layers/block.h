// Outline blocks: a building as its simplified footprint times its height, in two colours; and crowds of small things
// as boxes.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tiles/layers/facade_painter.h"
#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// Mean colours of an object's walls and of what faces up, weighted by area in linear light, rounded so that
/// equal-looking ones become equal.
struct BlockColours {
    std::array<uint8_t, 3> wall{}, roof{};
};
BlockColours mean_colours(const quadtree::BuildObject& object, ImageCache& images, FacadePainter& facades);

/// The cheapest block whose measured distance from the object, plus the relief of its facades, stays within `allowed`
/// metres; both are added to the error it already has. Nothing when there is none with fewer triangles.
std::optional<quadtree::BuildObject> make_block(const quadtree::BuildObject& object, double allowed, ImageCache& images,
                                                FacadePainter& facades);

/// Replaces objects that are smaller than `cell` grid units in every direction, cell by cell, by one box of the same
/// footprint area and mean height (its error: measured between their bounds and the box). What can be seen
/// through makes no box but fewer faces of its own (cutout.h). Alone in its cell an object stays as it is.
void merge_crowds(std::vector<quadtree::BuildObject>& objects, int64_t cell, ImageCache& images,
                  FacadePainter& facades);

}  // namespace citystream::tiles::layers

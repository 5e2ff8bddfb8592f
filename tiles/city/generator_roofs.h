// Roofs over a rectangle, with eaves or parapets, chimneys, dormers and roof houses.
#pragma once

#include <array>

#include "tiles/city/generator_mesh.h"

namespace citystream::tiles::city::procedural {

struct RoofMaterials {
    uint32_t roof = 0, wall = 0, soffit = 0, coping = 0, chimney = 0, glass = 0;
};

/// A rectangle in a frame, at the height where walls end and the roof begins.
struct RoofBase {
    Frame frame;
    Units width = 0, depth = 0, level = 0;
};

/// How steep a roof is and how far its eaves reach over the walls.
struct RoofPitch {
    int rise = 4, run = 5;
    Units eaves = 0;
};

/// Ridge along the frame's x; gables flush with the left and right wall. Returns the ridge's height above the level.
Units gable_roof(ObjectBuilder& object, const RoofBase& base, const RoofPitch& pitch, const RoofMaterials& materials);
/// Eaves on all sides; a pyramid over a square.
Units hip_roof(ObjectBuilder& object, const RoofBase& base, const RoofPitch& pitch, const RoofMaterials& materials);
/// The level is the top of the parapet; the deck lies `drop` below. 18 triangles.
void flat_roof(ObjectBuilder& object, const RoofBase& base, Units drop, const RoofMaterials& materials);
/// Teeth of about 8 m along x, their upright sides glazed.
void sawtooth_roof(ObjectBuilder& object, const RoofBase& base, const RoofMaterials& materials);

/// An upright box without floor over a rectangle of the frame: chimney, lift house, garage body.
void box(ObjectBuilder& object, const Frame& frame, Point2 low, Point2 high, Units foot, Units head, uint32_t walls,
         uint32_t top);
/// A flat-topped dormer whose window stands 1 m behind the front wall, its middle at `x`; its back hides in a gable
/// roof of this pitch.
void dormer(ObjectBuilder& object, const RoofBase& base, const RoofPitch& pitch, Units x,
            const RoofMaterials& materials);

}  // namespace citystream::tiles::city::procedural

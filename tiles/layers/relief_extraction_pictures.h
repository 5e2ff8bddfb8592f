// What a relief shows in place of images: the mean colour of the part of an image that a surface shows, because library
// textures lie on each window frame in a way of their own, which the planar mapping of a facade's slot cannot follow.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "tiles/layers/relief_extraction_parts.h"

namespace citystream::tiles::layers::relief {

/// The catalog's images in few texels. Decodes an image when it is first asked for.
class Pictures {
  public:
    explicit Pictures(const city::CityCatalog& catalog) : catalog_(catalog) {}
    /// Linear light. A material without a readable image has its flat colour everywhere.
    std::array<float, 3> at(uint32_t material, const city::Vec2& texcoord);

    /// The catalog's flat material of a colour.
    uint32_t flat(const std::array<uint8_t, 3>& rgb, city::CityCatalog& catalog);

  private:
    struct Small {
        uint32_t width = 0, height = 0;  ///< 0: cannot be read
        std::vector<std::array<float, 3>> texels;
    };
    const Small& small(uint32_t image);
    const city::CityCatalog& catalog_;
    std::map<uint32_t, Small> known_;
    std::map<std::array<uint8_t, 3>, uint32_t> flats_;
};

/// Gives each part of an image material its look: a flat material of its mean colour, in steps of a few levels so that
/// surfaces alike share it. Wide patches that are far from one colour are marked as kept, other wide parts as
/// patterned.
void flatten_pictures(const city::CityObject& object, FacadeParts& facade, Pictures& pictures,
                      city::CityCatalog& catalog);

}  // namespace citystream::tiles::layers::relief

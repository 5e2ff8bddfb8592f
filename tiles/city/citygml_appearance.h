// Appearance of CityGML: which surface (by gml:id) has which colour, which ring which image and texture coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "tiles/city/city_model.h"
#include "tiles/city/xml_stream.h"

namespace citystream::tiles::city {

struct GmlTexture {
    std::string uri;
    bool repeat = true;
};

class GmlAppearance {
  public:
    struct RingLook {
        const GmlTexture* texture = nullptr;  ///< null: none
        const Vec2* texcoords = nullptr;      ///< one for each point as written, the closing one too
        size_t count = 0;
    };
    std::optional<std::array<uint8_t, 3>> colour_of(const std::string& surface_id) const;
    RingLook look_of(const std::string& ring_id) const;
    void clear();
    size_t size() const { return texcoords_.size() + colours_.size() + rings_.size(); }

  private:
    friend class GmlAppearanceParser;
    struct Colour {
        std::array<uint8_t, 3> rgb{};
        bool front = true;
    };
    struct Ring {
        uint32_t texture = 0;
        size_t first = 0, count = 0;
        bool front = true;
    };
    std::unordered_map<std::string, Colour> colours_;
    std::unordered_map<std::string, Ring> rings_;
    std::vector<GmlTexture> textures_;
    std::vector<Vec2> texcoords_;
};

/// The elements inside app:Appearance. The owner calls start and end for each of them and collects text where start
/// says so.
class GmlAppearanceParser {
  public:
    /// True: the text of this element is wanted at end().
    bool start(std::string_view name, const XmlAttributes& attributes);
    void end(std::string_view name, const std::string& text, GmlAppearance& into);
    uint64_t unsupported() const {
        return unsupported_;
    }  ///< surface data that cannot be used (generated coordinates, georeferenced images)

  private:
    struct Coordinates {
        std::string ring;
        std::vector<Vec2> points;
    };
    void finish_material(GmlAppearance& into);
    void finish_texture(GmlAppearance& into);

    // Of the surface data in hand:
    std::vector<std::string> targets_;
    std::vector<Coordinates> coordinates_;
    size_t rings_named_ = 0;
    std::optional<std::array<uint8_t, 3>> colour_;
    GmlTexture texture_;
    bool front_ = true;
    uint64_t unsupported_ = 0;
};

}  // namespace citystream::tiles::city

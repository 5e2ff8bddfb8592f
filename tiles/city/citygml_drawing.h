// A gathered CityGML feature -> CityObjects: resolves references, chooses the LoD, draws each surface once.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "tiles/city/city_reading.h"
#include "tiles/city/citygml_appearance.h"
#include "tiles/city/citygml_feature.h"

namespace citystream::tiles::city {

/// For each part: the highest LoD of its body or boundary surfaces (or the one asked for); at that LoD the boundary
/// surfaces where they cover at least half the area of the solid, else the solid; with them openings and installations
/// at the highest LoD not above it (if they have none, at their lowest).
class GmlDrawer {
  public:
    GmlDrawer(CityReading& reading, const std::string& file) : reading_(reading), file_(file) {}

    /// `own` is the appearance inside the feature; it goes before that of the `model`.
    void draw(const GmlFeature& feature, const GmlAppearance& own, const GmlAppearance& model);

  private:
    /// One appearance of a polygon in the feature: where it is written, or where a reference stands for it.
    struct Use {
        uint32_t polygon = 0;
        GmlPlace place;  ///< place.turned: relative to the points as written
    };

    void collect_uses();
    void resolve(const GmlLink& link, GmlPlace place, int depth);
    std::vector<Use> chosen_uses(int32_t part, std::string& lods) const;
    void take_sub_objects(const std::vector<const Use*>& uses, GmlRole role, int lod, std::vector<Use>& out) const;
    double area_of(const std::vector<Use>& uses) const;
    void draw_uses(const std::vector<Use>& uses);
    void draw_polygon(const Use& use);
    bool add_ring(const GmlRing& ring, const GmlAppearance::RingLook& look);
    SurfaceStyle style_of(const Use& use, const GmlTexture* texture);
    GmlAppearance::RingLook look_of(const std::string& ring_id) const;
    bool draw_part(int32_t part);

    CityReading& reading_;
    const std::string& file_;

    // Of the feature in hand:
    const GmlFeature* feature_ = nullptr;
    const GmlAppearance* own_ = nullptr;
    const GmlAppearance* model_ = nullptr;
    std::vector<Use> uses_;  ///< by part, otherwise in document order
    std::unordered_map<std::string_view, int32_t> node_by_id_;
    uint64_t unresolved_ = 0, mismatched_textures_ = 0;
    size_t most_uses_ = 0, resolved_ = 0;
};

}  // namespace citystream::tiles::city

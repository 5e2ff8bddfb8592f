#include "client/select/placement_levels.h"

#include <algorithm>
#include <cmath>

namespace citystream::client {

double distance_to_wall(const Camera& camera, const GridPoint& origin, const codec::facade::Placement& wall) {
    const double x = camera.position[0] - to_metres(origin.x + wall.origin[0]);
    const double y = camera.position[1] - to_metres(origin.y + wall.origin[1]);
    const double z = camera.position[2] - to_metres(origin.z + wall.origin[2]);
    const double along_x = to_metres(wall.along[0]), along_y = to_metres(wall.along[1]),
                 height = to_metres(wall.height);
    const double squared = along_x * along_x + along_y * along_y;
    const double t = squared > 0 ? std::clamp((x * along_x + y * along_y) / squared, 0.0, 1.0) : 0;
    const double above = z - std::clamp(z, 0.0, height);
    return std::max(camera.near_plane, std::hypot(x - t * along_x, y - t * along_y, above));
}

std::vector<PlacementLevel> placement_levels(const FacadeDictionary& dictionary, const Camera& camera,
                                             const GridPoint& origin,
                                             std::span<const codec::facade::Placement> placements,
                                             const ViewDemand& demand) {
    std::vector<PlacementLevel> levels;
    levels.reserve(placements.size());
    for (const codec::facade::Placement& wall : placements) {
        const double scale = camera.pixels_per_metre(distance_to_wall(camera, origin, wall));
        const auto piece = dictionary.wanted(wall.map, {demand.texel_pixels / scale, demand.level});
        levels.push_back({piece.value_or(kNoPiece), scale});
    }
    return levels;
}

std::vector<MapPiece> distinct_pieces(std::span<const PlacementLevel> levels) {
    std::vector<MapPiece> pieces;
    for (const PlacementLevel& level : levels) {
        if (level.piece != kNoPiece) pieces.push_back(level.piece);
    }
    std::sort(pieces.begin(), pieces.end());
    pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
    return pieces;
}

}  // namespace citystream::client

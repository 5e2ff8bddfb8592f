// Which tiles to draw now: the selection where it is here, and the best stand-ins where it is not. Every visible point
// is covered once.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "client/cache/directory_cache.h"

namespace citystream::client {

/// What the cover asks about a tile.
struct CoverQuestions {
    std::function<bool(NodeIndex)> selected;  ///< chosen by the one rule
    std::function<bool(NodeIndex)> refined;   ///< an ancestor of a chosen tile
    std::function<bool(NodeIndex)> visible;
    std::function<bool(NodeIndex)> drawable;  ///< enough of it is resident
};

/// A chosen tile is drawn when it is drawable, else its descendants when together they cover it, else its nearest
/// drawable ancestor (in place of all that lies below that). No tile of the result is an ancestor of another. Where no
/// ancestor is drawable, the parts that are there are drawn.
std::vector<NodeIndex> cover_view(const DirectoryCache& directory, const CoverQuestions& ask);

}  // namespace citystream::client

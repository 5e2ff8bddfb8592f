// What a request can bring into host memory at most: so much is set aside for it before it is sent.
#pragma once

#include <cstdint>

#include "client/stream/request_plan.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

/// Longest answer to a request for a subtree, whose own length nothing says: that of the city's largest, and never more
/// than a share of the budget. The share alone where the manifest does not know.
uint64_t subtree_limit(const tiles::tileset::Manifest& manifest, uint64_t host_budget);

/// Bytes that the answer and what is made of it on arrival take: a layer's or a map's range as it is (it is kept
/// packed), an index with its records, a subtree with the records of its tiles and `bytes_per_tile` of the
/// caller's own for each. Of subtrees that keep their columns apart, as FORMAT.md has them, none takes more; typically
/// half of that.
uint64_t most_host_bytes(const PlannedRequest& request, const tiles::tileset::Manifest& manifest, uint64_t host_budget,
                         uint64_t bytes_per_tile);

}  // namespace citystream::client

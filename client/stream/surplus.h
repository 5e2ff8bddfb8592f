// What is resident beyond what a view needs of the same layers, and room for it where the budgets have none.
#pragma once

#include "client/stream/view_choice.h"

namespace citystream::client {

/// Prefixes that are resident beyond what is wanted are cut back when the budgets need their room; the shorter prefix
/// comes back from the wire bytes, not from the network.
void trim_surplus(const ViewChoice& view, const DirectoryCache& directory, const CityKnowledge& knowledge,
                  LayerCache& cache, const HostMemory& host);

/// Whether host memory has room beside what the view needs: for bytes that only save requests.
bool has_host_room(const Selection& selection, const HostMemory& host);

}  // namespace citystream::client

// The facade dictionary of a city as it travels: every map that is shown, in all its levels, each coded by itself.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "tiles/archive/archive.h"
#include "tiles/layers/build_city.h"
#include "tiles/layers/facade_numbers.h"
#include "tiles/quadtree/spool_file.h"

namespace citystream::tiles::layers {

/// A coarser level is kept where its payload takes at most this share of the next finer one's.
inline constexpr double kMostLevelShare = 0.7;

class EncodedFacades {
  public:
    /// Codes the maps of `numbers` on options.jobs threads; payloads go to `spool`, so that memory holds about 130
    /// bytes a map and what the threads work on. The result does not depend on the number of threads. Tells its
    /// progress as stage "facades". Error: the disk, a dictionary of 4 GiB or more, interrupted.
    static Result<EncodedFacades> encode(const FacadeNumbers& numbers, const city::FacadeCatalog& catalog,
                                         const BuildOptions& options, quadtree::SpoolFile& spool);

    const std::vector<tileset::FacadeMapRecord>& records() const { return records_; }
    /// Writes the entry facades/maps; nothing when there are no maps (3TZ knows no empty entries).
    Status write_entry(archive::ArchiveWriter& writer, quadtree::SpoolFile& spool) const;

  private:
    std::vector<tileset::FacadeMapRecord> records_;
    std::vector<uint64_t> offsets_;  // in the spool: the levels of a map lie side by side
};

}  // namespace citystream::tiles::layers

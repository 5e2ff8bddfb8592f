// The chart dictionary of a city as it travels: the pictures that several tiles show, each stored once, where that is
// smaller than what the tiles would store of their own.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "codec/atlas/atlas_layer.h"
#include "tiles/archive/archive.h"
#include "tiles/layers/build_city.h"
#include "tiles/layers/chart_wishes.h"
#include "tiles/layers/facade_painter.h"
#include "tiles/layers/memory_gate.h"
#include "tiles/quadtree/spool_file.h"

namespace citystream::tiles::layers {

struct ChartSources {
    ImageCache& images;
    FacadePainter& facades;
    codec::atlas::AtlasOptions atlas;
};

/// Thread-safe for take.
class ChartDictionary final : public ChartShelf {
  public:
    /// Encodes the candidates on options.jobs threads and keeps those that take noticeably fewer bytes than what the
    /// tiles would make of their own, estimated by texels from the bytes that the chart itself takes. Pictures of one
    /// colour are never kept; of equal ones there is one. Payloads go to `spool`, which has to stay. The result does
    /// not depend on the number of threads. Tells its progress as stage "charts". Error: the disk, interrupted.
    static Result<ChartDictionary> make(CityWishes& wishes, const ChartSources& sources, const BuildOptions& options,
                                        MemoryGate& gate, quadtree::SpoolFile& spool);

    std::optional<SharedChart> take(const ChartKey& key, double coarseness, uint64_t texels) override;

    std::span<tileset::ChartRecord> records() { return records_; }
    /// Writes the entry charts/levels, in the order of place_chart_levels, which must have placed the records; nothing
    /// when there are none.
    Status write_entry(archive::ArchiveWriter& writer, quadtree::SpoolFile& spool) const;

  private:
    std::vector<tileset::ChartRecord> records_;
    std::vector<uint64_t> offsets_;  // in the spool: the levels of a chart lie side by side
    std::map<ChartKey, SharedChart> charts_;
};

}  // namespace citystream::tiles::layers

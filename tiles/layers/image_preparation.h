// The stage "images" of a build: every image that the city shows is decoded once, on all cores, made as small as the
// finest tile needs it (view matching, thesis section 7.1), then as small as a metric still takes for the same
// (saliency, 7.2), and stored with its mips. What is held at a time stays below a budget: images that do not fit are
// reduced while they are read, row by row.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "codec/atlas/chart_search.h"
#include "tiles/city/city_model.h"
#include "tiles/layers/image_uses.h"
#include "tiles/layers/prepared_images.h"
#include "tiles/layers/texture_law.h"

namespace citystream::tiles::layers {

struct ImagePreparationOptions {
    codec::atlas::Metric saliency;
    double texel_metres = kLeafTexel;  ///< of the finest tiles
    uint32_t jobs = 0;                 ///< threads; 0: all cores. The result does not depend on it
    uint64_t budget_bytes = uint64_t{1} << 30;
    const std::atomic<bool>* cancel = nullptr;
    std::function<void(std::string_view stage, uint64_t done, uint64_t total)> progress;
};

struct ImagePreparationReport {
    uint64_t images = 0, used = 0, failed = 0;         ///< of the catalog; shown by something; of these without pixels
    uint64_t not_searched = 0;                         ///< too large for a search within the budget: view-matched only
    uint64_t decoded_pixels = 0;                       ///< of the images as they are
    uint64_t matched_pixels = 0, prepared_pixels = 0;  ///< after view matching; after the search
    uint64_t metric_calls = 0;
    uint64_t stored_bytes = 0;
    double seconds = 0;
    /// Sums over all threads: reading and decoding with what is reduced on the way; resampling; the search; storing
    /// with the mips.
    double decode_seconds = 0, match_seconds = 0, search_seconds = 0, store_seconds = 0;
    uint64_t peak_bytes = 0;  ///< the most that was held at a time, as planned
};

/// How one image is prepared, and what that holds at most.
struct ImagePlan {
    codec::atlas::ChartSize size;  ///< after view matching
    bool halved = false;           ///< the budget holds no finer one
    bool by_rows = false;          ///< reduced to `size` by area while it is read; else read whole, then by Lanczos
    bool searched = false;
    uint64_t bytes = 0;
};

/// An image before it is prepared.
struct ImageFacts {
    codec::atlas::ChartSize size;  ///< sides not 0
    uint64_t strip_bytes = 0;
    bool whole_pixels_held = false;  ///< it exists in memory whatever is done (it is drawn, not read)
    bool alpha = false;
};
ImagePlan plan_image(const ImageFacts& image, codec::atlas::ChartSize wanted, bool search, uint64_t budget_bytes);

/// Prepares the used images of the catalog. Each that cannot be used is one line in `defects` (in the order of the
/// images) and has no pixels. Error: the disk, or "interrupted".
Result<ImagePreparationReport> prepare_images(const city::CityCatalog& catalog, const std::vector<ImageUse>& uses,
                                              const ImagePreparationOptions& options, PreparedImages& prepared,
                                              std::vector<city::Defect>& defects);

}  // namespace citystream::tiles::layers

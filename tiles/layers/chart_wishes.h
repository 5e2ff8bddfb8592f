// What the tiles of a city would show of charts that other tiles may show too: noted before any tile is encoded, so
// that the chart dictionary can be made first.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

namespace citystream::tiles::layers {

/// A picture that tiles can share.
struct ChartKey {
    enum class Kind : uint8_t { kImage, kRepeatedImage, kFacadePicture };
    Kind kind = Kind::kImage;
    std::array<uint32_t, 2> name = {};  ///< image of the catalog; or facade map and palette
    friend auto operator<=>(const ChartKey&, const ChartKey&) = default;
    bool repeats() const { return kind == Kind::kRepeatedImage; }
    bool is_image() const { return kind != Kind::kFacadePicture; }
};

/// A shared chart, as a tile finds it.
struct SharedChart {
    uint32_t number = 0;
    double coarseness = 0;        ///< of its finest mip: halvings of an image, metres a texel of a facade picture
    double metres_per_texel = 0;  ///< of a facade picture
};

/// Where a tile looks for a chart before it makes its own.
class ChartShelf {
  public:
    virtual ~ChartShelf() = default;
    /// The tile would make `texels` texels of its own at `coarseness` (of SharedChart). Nothing: it has to.
    virtual std::optional<SharedChart> take(const ChartKey& key, double coarseness, uint64_t texels) = 0;
};

/// The wishes for one chart.
struct ChartDemand {
    uint64_t first_use = UINT64_MAX;  ///< least rank of its tiles
    uint32_t tiles = 0;
    double coarseness = 0;  ///< the finest that any asks for
    uint64_t texels = 0;    ///< that all of them would make
};

/// A shelf that has everything, and notes what one tile asks of it.
class TileWishes final : public ChartShelf {
  public:
    std::optional<SharedChart> take(const ChartKey& key, double coarseness, uint64_t texels) override;
    const std::map<ChartKey, ChartDemand>& demands() const { return demands_; }

  private:
    std::map<ChartKey, ChartDemand> demands_;
};

/// What another shelf (may be null) has, and everything else as well, of which it counts the texels: those that a tile
/// has to make itself.
class OwnTexels final : public ChartShelf {
  public:
    explicit OwnTexels(ChartShelf* shelf) : shelf_(shelf) {}
    std::optional<SharedChart> take(const ChartKey& key, double coarseness, uint64_t texels) override;
    uint64_t count() const { return count_; }

  private:
    ChartShelf* shelf_;
    uint64_t count_ = 0;
};

/// Of all tiles. Thread-safe; the sum does not depend on the order of tiles. About 80 bytes a key.
class CityWishes {
  public:
    /// `rank`: of the tile in the order of the dictionary.
    void add(uint64_t rank, const TileWishes& tile);

    struct Candidate {
        ChartKey key;
        ChartDemand demand;
    };
    /// What at least two tiles ask for, by first use. Forgets everything.
    std::vector<Candidate> take_candidates();

  private:
    std::mutex mutex_;
    std::map<ChartKey, ChartDemand> demands_;
};

}  // namespace citystream::tiles::layers

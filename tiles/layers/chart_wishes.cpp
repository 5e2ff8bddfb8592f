#include "tiles/layers/chart_wishes.h"

#include <algorithm>
#include <utility>

namespace citystream::tiles::layers {

namespace {

void add_demand(ChartDemand& sum, const ChartDemand& more) {
    sum.coarseness = sum.tiles == 0 ? more.coarseness : std::min(sum.coarseness, more.coarseness);
    sum.first_use = std::min(sum.first_use, more.first_use);
    sum.tiles += more.tiles;
    sum.texels += more.texels;
}

SharedChart granted(const ChartKey& key, double coarseness) {
    return {0, coarseness, key.is_image() ? 0 : coarseness};
}

}  // namespace

std::optional<SharedChart> TileWishes::take(const ChartKey& key, double coarseness, uint64_t texels) {
    ChartDemand& demand = demands_[key];
    add_demand(demand, {UINT64_MAX, 1, coarseness, texels});
    demand.tiles = 1;
    return granted(key, coarseness);
}

std::optional<SharedChart> OwnTexels::take(const ChartKey& key, double coarseness, uint64_t texels) {
    if (auto shared = shelf_ == nullptr ? std::nullopt : shelf_->take(key, coarseness, texels)) return shared;
    count_ += texels;
    return granted(key, coarseness);
}

void CityWishes::add(uint64_t rank, const TileWishes& tile) {
    const std::lock_guard lock(mutex_);
    for (auto [key, demand] : tile.demands()) {
        demand.first_use = rank;
        add_demand(demands_[key], demand);
    }
}

std::vector<CityWishes::Candidate> CityWishes::take_candidates() {
    const std::lock_guard lock(mutex_);
    std::vector<Candidate> candidates;
    for (const auto& [key, demand] : demands_) {
        if (demand.tiles >= 2) candidates.push_back({key, demand});
    }
    demands_.clear();
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.demand.first_use < b.demand.first_use; });
    return candidates;
}

}  // namespace citystream::tiles::layers

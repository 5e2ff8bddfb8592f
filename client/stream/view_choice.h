// What a view needs of the city: the selection by the one rule, in realtime mode the root that stands in for it, and
// the tiles out of view that cast shadows into it. Marks in the cache what is needed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/cache/layer_cache.h"
#include "client/select/caster_selection.h"
#include "client/select/city_knowledge.h"
#include "client/select/selection.h"
#include "client/stream/city_streamer.h"
#include "client/stream/warnings.h"

namespace citystream::client {

/// One thread.
class ViewChoice {
  public:
    /// All must outlive it.
    ViewChoice(const DirectoryCache& directory, const CityKnowledge& knowledge, LayerCache& cache,
               const LayerStore& store, const HostMemory& host, Selector& selector, Warnings& warnings,
               const StreamerOptions& options)
        : directory_(directory),
          knowledge_(knowledge),
          cache_(cache),
          store_(store),
          host_(host),
          selector_(selector),
          warnings_(warnings),
          options_(options) {}

    /// Host memory for what is noted of a tile of the directory.
    static uint64_t bytes_per_tile() { return sizeof(Mark); }
    /// Follows the directory's growth; bytes by which its own tables grow.
    uint64_t grow();

    /// Once an update, before any choice.
    void begin_update() { ++update_; }
    /// What a camera needs within the budgets; no casters yet.
    void choose(const Camera& camera);
    /// Beside what was chosen last, for a unit vector to the sun. Not of an empty directory.
    void choose_casters(const Camera& camera, const std::array<double, 3>& to_sun);
    /// Of what they left out of the last choice.
    void warn_of_budgets();
    /// Counts each prefix as here or not when it is chosen for the first time in this update.
    void count_hits(StreamerFrame& frame);

    const Selection& selection() const { return selection_; }
    /// The selection, and in realtime mode the root.
    const std::vector<SelectedTile>& needed() const { return needed_; }
    const std::vector<ChartPrefix>& needed_charts() const { return needed_charts_; }  ///< of them all
    const CasterChoice& casters() const { return casters_; }                          ///< beside them

    bool is_caster(NodeIndex node) const;
    bool is_selected(NodeIndex node) const { return node < marks_.size() && marks_[node].selected == serial_; }
    bool is_refined(NodeIndex node) const { return node < marks_.size() && marks_[node].refined == serial_; }
    /// Nothing: not needed.
    const SelectedTile* wanted_tile(NodeIndex node) const {
        return node < marks_.size() && marks_[node].needed == serial_ ? &needed_[marks_[node].position] : nullptr;
    }
    uint32_t levels_needed(uint32_t chart) const { return levels_in(needed_charts_, chart); }

  private:
    /// By node: serial of the choice for which each holds.
    struct Mark {
        uint64_t selected = 0, refined = 0, needed = 0;
        uint64_t counted = 0;   ///< update for which its prefixes were counted as here or not
        uint32_t position = 0;  ///< in needed_
    };
    SelectionBudget selection_budget() const;
    void pin_root();
    SelectedTile stand_in() const;
    uint8_t stand_in_light() const;
    void mark_needed();

    const DirectoryCache& directory_;
    const CityKnowledge& knowledge_;
    LayerCache& cache_;
    const LayerStore& store_;
    const HostMemory& host_;
    Selector& selector_;
    Warnings& warnings_;
    const StreamerOptions& options_;
    Selection selection_;
    std::vector<SelectedTile> needed_;
    std::vector<ChartPrefix> needed_charts_;
    CasterChoice casters_;
    std::vector<Mark> marks_;
    uint64_t serial_ = 0, update_ = 0;
};

}  // namespace citystream::client

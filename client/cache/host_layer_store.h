// A layer store in host memory: the same slots and the same hard budget as on a GPU, for tests and for clients that do
// not draw.
#pragma once

#include <map>
#include <vector>

#include "client/cache/layer_store.h"

namespace citystream::client {

class HostLayerStore final : public LayerStore {
  public:
    /// `keep_words` false: words are counted and dropped (load clients).
    HostLayerStore(uint64_t budget_bytes, uint64_t slot_bytes, bool keep_words);

    uint64_t slot_bytes() const override { return slot_bytes_; }
    uint64_t slot_count() const override { return slot_count_; }
    uint64_t slots_used() const override { return slots_used_; }
    LayerId create() override;
    Status append(LayerId layer, std::span<const uint32_t> words) override;
    /// Only where words are kept.
    Result<uint64_t> refine(LayerId layer, uint64_t begin, std::span<const uint32_t> planes,
                            uint32_t to_level) override;
    void destroy(LayerId layer) override;

    bool has(LayerId layer) const { return layers_.contains(layer); }
    uint64_t bytes_of(LayerId layer) const;
    /// Empty unless words are kept.
    std::span<const uint32_t> words_of(LayerId layer) const;
    uint64_t most_slots_used() const { return most_slots_used_; }
    uint64_t refused_appends() const { return refused_appends_; }  ///< and refinements, for want of slots

  private:
    struct Array {
        uint64_t bytes = 0;
        std::vector<uint32_t> words;
    };
    /// Takes note of so many slots more, if there are.
    bool has_room(uint64_t slots);

    uint64_t slot_bytes_, slot_count_;
    bool keep_words_;
    uint64_t slots_used_ = 0, most_slots_used_ = 0, refused_appends_ = 0;
    LayerId next_ = 0;
    std::map<LayerId, Array> layers_;
};

}  // namespace citystream::client

// A store whose layers lie in pieces in GPU memory.
#pragma once

#include <algorithm>
#include <vector>

#include "client/cache/layer_store.h"

namespace citystream::client::test {

/// Leaves a used slot behind every slot that a layer takes: layers of more than one slot lie in pieces.
class ScatteringStore final : public LayerStore {
  public:
    explicit ScatteringStore(LayerStore& store) : store_(store) {}

    uint64_t slot_bytes() const override { return store_.slot_bytes(); }
    uint64_t slot_count() const override { return store_.slot_count(); }
    uint64_t slots_used() const override { return store_.slots_used(); }
    LayerId create() override { return store_.create(); }
    void destroy(LayerId layer) override { store_.destroy(layer); }
    Status append(LayerId layer, std::span<const uint32_t> words) override {
        const std::vector<uint32_t> plug(1);
        const size_t slot_words = slot_bytes() / sizeof(uint32_t);
        for (size_t begin = 0; begin < words.size(); begin += slot_words) {
            const auto part = words.subspan(begin, std::min(slot_words, words.size() - begin));
            if (Status status = store_.append(layer, part); !status) return status;
            if (Status status = store_.append(store_.create(), plug); !status) return status;
        }
        return Done{};
    }

    Result<uint64_t> refine(LayerId layer, uint64_t begin, std::span<const uint32_t> planes,
                            uint32_t to_level) override {
        return store_.refine(layer, begin, planes, to_level);
    }

  private:
    LayerStore& store_;
};

}  // namespace citystream::client::test

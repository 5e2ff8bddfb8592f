#include <algorithm>

#include "codec/atlas/rectangle_packing_methods.h"

namespace citystream::codec::atlas {

RectanglePool::RectanglePool(std::span<const RectangleSize> sizes, RectangleSize bin) {
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < sizes.size(); ++i) {
        if (sizes[i].fits_in(bin)) order.push_back(i);
    }
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        if (sizes[a].width != sizes[b].width) return sizes[a].width < sizes[b].width;
        if (sizes[a].height != sizes[b].height) return sizes[a].height < sizes[b].height;
        return a < b;
    });
    for (const uint32_t i : order) {
        if (columns_.empty() || columns_.back().width != sizes[i].width) columns_.push_back({sizes[i].width, {}});
        columns_.back().entries.push_back({sizes[i].height, i});
        area_ += sizes[i].area();
        most_height_ = std::max(most_height_, sizes[i].height);
    }
}

size_t RectanglePool::columns_up_to(uint32_t width) const {
    const auto above = std::upper_bound(columns_.begin(), columns_.end(), width,
                                        [](uint32_t most, const Column& column) { return most < column.width; });
    return static_cast<size_t>(above - columns_.begin());
}

size_t RectanglePool::tallest(const Column& column, uint32_t most_height) {
    const auto above = std::upper_bound(column.entries.begin(), column.entries.end(), most_height,
                                        [](uint32_t height, const Entry& entry) { return height < entry.height; });
    return above == column.entries.begin() ? kNone : static_cast<size_t>(above - column.entries.begin()) - 1;
}

uint32_t RectanglePool::take(size_t column, size_t entry) {
    std::vector<Entry>& entries = columns_[column].entries;
    const Entry taken = entries[entry];
    area_ -= uint64_t{columns_[column].width} * taken.height;
    entries.erase(entries.begin() + static_cast<ptrdiff_t>(entry));
    if (entries.empty()) columns_.erase(columns_.begin() + static_cast<ptrdiff_t>(column));
    return taken.rectangle;
}

}  // namespace citystream::codec::atlas

// What the CPU tells the GPU about one frame: the camera record, one record a tile, page tables of the layers drawn. All of it lies in one
// mapped buffer and is reached by address.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "client/render/draw_layout.h"
#include "client/render/frame.h"
#include "client/render/slot_pool.h"
#include "client/select/camera.h"

namespace citystream::client {

/// The camera's place as a whole grid cell and the rest, so that tiles are placed by exact integers. The position is rounded to 2^-16 m first:
/// a city far from the origin, whose camera positions carry rounding of their own, then draws the same frames as one at the origin.
struct CameraCell {
    std::array<int64_t, 3> cell{};       ///< grid units
    std::array<float, 3> fraction{};     ///< metres, 0..2^-10
};
CameraCell camera_cell(const std::array<double, 3>& position);

FrameRecord make_frame_record(const Camera& camera, const CameraCell& cell);

/// Builds the frame's words. References to what is inside are made against `base`, the device address the words will be copied to.
class FrameRecords {
  public:
    FrameRecords(const SlotPool& pool, VkDeviceAddress base) : pool_(pool), base_(base) {}

    /// Appends a record; returns its device address.
    VkDeviceAddress add_frame(const FrameRecord& record);
    /// Appends the tile's record with what it refers to. Fails when a layer it names does not live, or when the tile is too far away
    /// for 32-bit grid units (1,000 km).
    Result<VkDeviceAddress> add_tile(const TileDraw& tile, const CameraCell& camera);
    std::span<const uint32_t> words() const { return words_; }

    /// Upper bound of the words that `tiles` take.
    static uint64_t bound(const SlotPool& pool, std::span<const TileDraw> tiles);

  private:
    VkDeviceAddress append(const void* record, size_t bytes);
    Status refer(LayerId layer, uint out[2]);

    const SlotPool& pool_;
    VkDeviceAddress base_;
    std::vector<uint32_t> words_;
    std::unordered_map<LayerId, VkDeviceAddress> references_;
};

}  // namespace citystream::client

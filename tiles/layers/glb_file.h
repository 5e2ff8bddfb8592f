// A binary glTF file in the making: buffers go to a spool as they come, the JSON grows in memory, both are joined at
// the end.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "codec/result.h"
#include "tiles/quadtree/spool_file.h"

namespace citystream::tiles::layers {

class GlbFile {
  public:
    static Result<std::unique_ptr<GlbFile>> create(const std::string& path, const std::string& folder);

    nlohmann::json& json() { return json_; }

    /// Appends a buffer view (4-byte aligned); target 34962 vertices, 34963 indices, 0 none. Returns its index.
    Result<uint32_t> add_view(std::span<const std::byte> bytes, uint32_t target);
    /// Appends a view and a float accessor of `components` (2, 3, 4) with min and max when asked.
    Result<uint32_t> add_floats(std::span<const float> values, uint32_t components, bool bounds, uint32_t target);
    Result<uint32_t> add_indices(std::span<const uint32_t> values);
    /// Appends to a top-level array ("meshes", "nodes", ...) and returns the index.
    uint32_t add(const char* array, nlohmann::json value);

    /// Joins both parts under a temporary name, syncs, renames. Error: disk, or more than 4 GiB.
    Status finish();

  private:
    GlbFile(std::string path, std::unique_ptr<quadtree::SpoolFile> binary)
        : path_(std::move(path)), binary_(std::move(binary)) {}
    Status write(const std::string& temporary);

    std::string path_;
    std::unique_ptr<quadtree::SpoolFile> binary_;
    nlohmann::json json_;
};

}  // namespace citystream::tiles::layers

// A city of a root and four children with mesh and atlas layers whose bytes no one decodes: enough for clients that
// only count.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::client::test {

using tiles::tileset::Layer;

inline constexpr size_t kStepBytes = 2000;

class TinyCity {
  public:
    TinyCity() {
        static std::atomic<int> counter{0};
        folder_ = std::filesystem::temp_directory_path() /
                  ("citystream-load-test-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
        std::filesystem::create_directories(folder_);
        make_records();
        write();
    }
    ~TinyCity() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    TinyCity(const TinyCity&) = delete;
    TinyCity& operator=(const TinyCity&) = delete;

    std::string file() const { return (folder_ / "tiny.3tz").string(); }
    std::string path_file(const std::string& name) const { return (folder_ / name).string(); }
    const tiles::tileset::Manifest& manifest() const { return manifest_; }
    const tiles::tileset::Subtree& subtree() const { return subtree_; }
    /// All layer bytes of the children: what a close look at the whole city draws.
    uint64_t fine_bytes() const { return 4 * (2 * kStepBytes + kStepBytes); }
    const std::map<std::string, std::vector<std::byte>>& entries() const { return entries_; }

  private:
    static std::vector<std::byte> content(uint32_t seed, size_t size) {
        std::vector<std::byte> bytes(size);
        for (std::byte& b : bytes) b = static_cast<std::byte>((seed = seed * 1664525u + 1013904223u) >> 24);
        return bytes;
    }
    void add_layer(tiles::tileset::TileRecord& record, Layer layer, std::vector<float> errors) {
        const uint32_t seed =
            record.address.level * 100 + record.address.x * 10 + record.address.y * 3 + static_cast<uint32_t>(layer);
        const auto bytes = content(seed, kStepBytes * errors.size());
        auto& steps = record.steps(layer);
        for (size_t i = 0; i < errors.size(); ++i) {
            const uint64_t end = (i + 1) * kStepBytes;
            // Decoded sizes differ from tile to tile, as they do in a city.
            steps.push_back({end, static_cast<uint32_t>(4000 + 40 * (seed % 97) + 4 * i), errors[i],
                             tiles::tileset::checksum_of(bytes.data() + i * kStepBytes, kStepBytes)});
            manifest_.wire_bytes[static_cast<size_t>(layer)] += kStepBytes;
            manifest_.decoded_bytes[static_cast<size_t>(layer)] += steps.back().decoded_bytes;
        }
        entries_[layer_path(layer, record.address)] = bytes;
    }
    void make_records() {
        manifest_.title = "tiny";
        manifest_.origin = {to_grid(1000.0 * 128), to_grid(2000.0 * 128), 0};
        manifest_.levels = 2;
        manifest_.extent.max = {128, 128, 20};
        manifest_.root_geometric_error = 50;
        manifest_.buildings = 4;
        manifest_.tiles = 5;
        manifest_.has_layer = {true, false, true, false};
        tiles::tileset::TileRecord root;
        root.bounds.max = {128, 128, 20};
        root.geometric_error = 10;
        add_layer(root, Layer::kMesh, {10});
        add_layer(root, Layer::kAtlas, {1});
        subtree_.tiles.push_back(root);
        for (uint32_t i = 0; i < 4; ++i) {
            tiles::tileset::TileRecord child;
            child.address = root.address.child(i);
            child.bounds.min = {64.0 * child.address.x, 64.0 * child.address.y, 0};
            child.bounds.max = {64.0 * child.address.x + 64, 64.0 * child.address.y + 64, 20};
            add_layer(child, Layer::kMesh, {2.0F, 0.001F});
            add_layer(child, Layer::kAtlas, {0.001F});
            child.geometric_error = 0.001F;
            subtree_.tiles.push_back(child);
        }
    }
    void write() {
        auto writer = tiles::archive::ArchiveWriter::create(file());
        ASSERT_TRUE(writer.ok()) << writer.error().text();
        const std::string json = write_tileset_json(manifest_);
        const auto bytes = std::as_bytes(std::span(json));
        entries_["tileset.json"].assign(bytes.begin(), bytes.end());
        entries_[tiles::tileset::subtree_path({})] = write_subtree(subtree_, manifest_);
        for (const auto& [name, data] : entries_) ASSERT_TRUE((*writer)->add(name, data).ok()) << name;
        ASSERT_TRUE((*writer)->finish().ok());
    }

    std::filesystem::path folder_;
    tiles::tileset::Manifest manifest_;
    tiles::tileset::Subtree subtree_;
    std::map<std::string, std::vector<std::byte>> entries_;
};

}  // namespace citystream::client::test

// A small archive with every kind of entry that the server distinguishes, in a folder of its own that goes away with
// it.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"
#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::server::test {

using tests::TemporaryFolder;

/// Bytes that differ from place to place, so that a shifted answer is noticed.
inline std::string patterned(size_t size, unsigned seed = 1) {
    std::string bytes(size, '\0');
    uint32_t state = seed * 2654435761u + 12345u;
    for (char& c : bytes) {
        state = state * 1664525u + 1013904223u;
        c = static_cast<char>(state >> 24);
    }
    return bytes;
}

inline std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

inline std::string text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline tiles::tileset::Manifest small_manifest(const std::string& title) {
    tiles::tileset::Manifest manifest;
    manifest.title = title;
    manifest.epsg = 25832;
    manifest.origin = {to_grid(677'888.0), to_grid(5'402'880.0), 0};
    manifest.extent.min = {1, 2, 360};
    manifest.extent.max = {101, 122, 401.5};
    manifest.root_geometric_error = 40;
    manifest.buildings = 1234;
    manifest.tiles = 1;
    manifest.has_layer[0] = true;
    manifest.wire_bytes[0] = 1000;
    manifest.decoded_bytes[0] = 4000;
    return manifest;
}

constexpr size_t kMeshBytes = 1000;
constexpr size_t kLargeBytes = 24u << 20;

inline std::string mesh_bytes() {
    return patterned(kMeshBytes, 7);
}
inline std::string large_bytes() {
    return patterned(kLargeBytes, 9);
}

/// tileset.json, tiles/0/0/0.mesh (1000 bytes), subtrees/0/0/0.subtree, preview.png, and with `large` also tiles/large.
inline void write_city(const std::string& file, const std::string& title = "Test <City>", bool large = false) {
    auto writer = tiles::archive::ArchiveWriter::create(file);
    ASSERT_TRUE(writer.ok()) << writer.error().text();
    const auto add = [&](const std::string& name, const std::string& content) {
        const auto status = (*writer)->add(name, bytes_of(content));
        ASSERT_TRUE(status.ok()) << status.error().text();
    };
    add("tileset.json", tiles::tileset::write_tileset_json(small_manifest(title)));
    add("subtrees/0/0/0.subtree", patterned(333, 3));
    add("tiles/0/0/0.mesh", mesh_bytes());
    add("preview.png", "\x89PNG not really");
    if (large) add("tiles/large", large_bytes());
    const auto status = (*writer)->finish();
    ASSERT_TRUE(status.ok()) << status.error().text();
}

}  // namespace citystream::server::test

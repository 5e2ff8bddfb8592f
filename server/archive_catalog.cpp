#include "server/archive_catalog.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "server/http_target.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::server {
namespace {

/// Where the archive's first byte lies in memory, known from any entry that has bytes.
const std::byte* mapping_of(const tiles::archive::ArchiveReader& archive) {
    for (const auto& entry : archive.entries()) {
        if (entry.size == 0) continue;
        const auto bytes = archive.find(entry.name);
        return bytes.data() == nullptr ? nullptr : bytes.data() - entry.data_offset;
    }
    return nullptr;
}

Result<City> open_city(const std::string& file) {
    std::error_code error;
    const auto kind = std::filesystem::status(file, error).type();
    if (kind == std::filesystem::file_type::not_found) return Error{fmt::format("{}: no such file", file)};
    if (kind == std::filesystem::file_type::directory) {
        return Error{
            fmt::format("{}: a folder, not a .3tz archive (any static web server can serve an unpacked city)", file)};
    }
    auto archive = tiles::archive::ArchiveReader::open(file);
    if (!archive) return Error{fmt::format("{}: {}", file, archive.error().text())};
    const auto tileset = (*archive)->find(tiles::tileset::kTilesetPath);
    if (tileset.data() == nullptr) return Error{fmt::format("{}: the archive has no tileset.json", file)};
    auto manifest = tiles::tileset::parse_tileset_json(tileset);
    if (!manifest) return Error{fmt::format("{}: tileset.json: {}", file, manifest.error().text())};

    City city;
    city.file = file;
    city.archive = std::move(*archive);
    city.manifest = std::move(*manifest);
    city.mapping = mapping_of(*city.archive);
    return city;
}

}  // namespace

std::string url_name_of(std::string_view file) {
    std::string name = std::filesystem::path(file).stem().string();
    for (char& c : name) {
        const bool safe = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
                          c == '_' || c == '-';
        if (!safe) c = '-';
    }
    name.erase(0, std::min(name.find_first_not_of('.'), name.size()));
    return name.empty() ? "city" : name;
}

std::optional<CatalogEntry> City::find(std::string_view entry) const {
    const auto bytes = archive->find(entry);
    if (bytes.data() == nullptr) return std::nullopt;
    // Entries are listed in file order, so the one that holds these bytes is found by its offset.
    const auto& entries = archive->entries();
    const auto offset = static_cast<uint64_t>(bytes.data() - mapping);
    const auto found = std::lower_bound(entries.begin(), entries.end(), offset,
                                        [](const auto& e, uint64_t wanted) { return e.data_offset < wanted; });
    const bool listed =
        mapping != nullptr && found != entries.end() && found->data_offset == offset && found->name == entry;
    const uint64_t fingerprint = listed ? found->crc32 : tiles::tileset::checksum_of(bytes.data(), bytes.size());
    return CatalogEntry{bytes, fmt::format("\"{:08x}-{:x}\"", fingerprint, bytes.size())};
}

bool City::has_preview() const {
    return archive->find(tiles::tileset::kPreviewPath).data() != nullptr;
}

Result<ArchiveCatalog> ArchiveCatalog::open(const std::vector<std::string>& files) {
    ArchiveCatalog catalog;
    for (const auto& file : files) {
        auto city = open_city(file);
        if (!city) return city.error();
        const std::string wanted = url_name_of(file);
        city->name = wanted;
        for (int copy = 2; catalog.find(city->name) || is_reserved_name(city->name); ++copy) {
            city->name = fmt::format("{}-{}", wanted, copy);
        }
        if (city->name != wanted) {
            catalog.remarks_.push_back(
                fmt::format("{} is served as /{}/ because the name {} is taken", file, city->name, wanted));
        }
        catalog.cities_.push_back(std::move(*city));
    }
    return catalog;
}

std::optional<size_t> ArchiveCatalog::find(std::string_view name) const {
    const auto found = std::find_if(cities_.begin(), cities_.end(), [&](const City& c) { return c.name == name; });
    if (found == cities_.end()) return std::nullopt;
    return static_cast<size_t>(found - cities_.begin());
}

}  // namespace citystream::server

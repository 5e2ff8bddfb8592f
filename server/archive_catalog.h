// The cities that one server offers: opened archives, their names in URLs, and what is found under an entry's name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "codec/result.h"
#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"

namespace citystream::server {

/// Bytes of an archive's entry, straight from the mapping, and the tag that names exactly these bytes.
struct CatalogEntry {
    std::span<const std::byte> bytes;
    std::string etag;  ///< strong, quoted: CRC-32 and size as the archive lists them
};

/// One served archive. Immutable once opened, so any thread may read it.
struct City {
    std::string name;  ///< first path segment of its URLs
    std::string file;  ///< as given, for messages
    std::shared_ptr<tiles::archive::ArchiveReader> archive;
    tiles::tileset::Manifest manifest;

    /// O(log entries), no allocation but the tag.
    std::optional<CatalogEntry> find(std::string_view entry) const;
    bool has_preview() const;

    const std::byte* mapping = nullptr;  ///< where the archive's byte 0 lies in memory
};

class ArchiveCatalog {
  public:
    /// Opens every file; the error names the file that is missing, no archive, or without a readable tileset.json.
    static Result<ArchiveCatalog> open(const std::vector<std::string>& files);

    const std::vector<City>& cities() const { return cities_; }
    /// Index into cities(). O(cities).
    std::optional<size_t> find(std::string_view name) const;
    /// Remarks for the operator: which files were given another name than their own because it was taken.
    const std::vector<std::string>& remarks() const { return remarks_; }

  private:
    std::vector<City> cities_;
    std::vector<std::string> remarks_;
};

/// The name under which a file is served: its stem with every byte outside [A-Za-z0-9._-] turned into '-', never empty,
/// never with a leading dot.
std::string url_name_of(std::string_view file);

}  // namespace citystream::server

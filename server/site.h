// Everything a server can answer with: the catalog's entries, the pages made from it, and live metrics. From a parsed
// target to a representation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/archive_catalog.h"
#include "server/http_target.h"
#include "server/metrics.h"

namespace citystream::server {

/// How long others may keep an answer.
enum class CachePolicy : uint8_t {
    kImmutable,   ///< content of a tile: a year
    kRevalidate,  ///< directory and pages: kept, but asked for again with If-None-Match
    kNone,        ///< live values and errors
};

/// What a target stands for, before ranges and conditions are looked at.
struct Representation {
    std::span<const std::byte> bytes;  ///< points into a mapping, a page of the site, or `owned`
    std::string owned;                 ///< bytes made for this answer
    std::string_view content_type;
    std::string etag;  ///< quoted and strong, or empty
    CachePolicy cache = CachePolicy::kNone;
    bool ranges = false;  ///< byte ranges may be asked for

    std::span<const std::byte> body() const { return owned.empty() ? bytes : std::as_bytes(std::span(owned)); }
};

struct Redirect {
    std::string location;  ///< relative, so that it holds behind a proxy that adds a prefix
};

struct NotFound {
    std::string message;  ///< one line
};

struct Lookup {
    std::variant<Representation, Redirect, NotFound> what;
    size_t city = Metrics::kNoCity;
};

/// Media type by the ending of an entry's name; never a type that a browser would run.
std::string_view content_type_of(std::string_view entry);

/// Tiles' content is immutable under its name; the directory (tileset.json, subtrees, index of facade maps) and
/// pictures are revalidated.
CachePolicy cache_policy_of(std::string_view entry);

/// Immutable after construction but for the metrics it shows; any thread may look up.
class Site {
  public:
    Site(ArchiveCatalog catalog, const Metrics& metrics);
    Lookup find(const HttpTarget& target) const;
    const ArchiveCatalog& catalog() const { return catalog_; }

  private:
    struct Page {
        std::string text;
        std::string etag;
    };
    static Page make_page(std::string text);
    static Representation show(const Page& page, std::string_view content_type);
    Lookup find_entry(const HttpTarget& target, size_t city) const;

    ArchiveCatalog catalog_;
    const Metrics& metrics_;
    Page index_, cities_;
    std::vector<Page> city_pages_;
};

}  // namespace citystream::server

#include "server/site.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "server/pages.h"
#include "tiles/tileset/directory.h"

namespace citystream::server {
namespace {

constexpr std::string_view kHtml = "text/html; charset=utf-8";
constexpr std::string_view kText = "text/plain; charset=utf-8";
constexpr std::string_view kJson = "application/json";
constexpr std::string_view kBinary = "application/octet-stream";

constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kTypes = {{
    {".json", kJson},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".jpeg", "image/jpeg"},
    {".webp", "image/webp"},
    {".ktx2", "image/ktx2"},
    {".glb", "model/gltf-binary"},
    {".gltf", "model/gltf+json"},
    {".txt", kText},
    {".md", kText},
}};

Representation live_text(std::string text, std::string_view content_type) {
    Representation answer;
    answer.owned = std::move(text);
    answer.content_type = content_type;
    return answer;
}

}  // namespace

std::string_view content_type_of(std::string_view entry) {
    for (const auto& [ending, type] : kTypes) {
        if (entry.ends_with(ending)) return type;
    }
    return kBinary;
}

CachePolicy cache_policy_of(std::string_view entry) {
    if (entry.starts_with("tiles/") || entry == tiles::tileset::kFacadeMapsPath ||
        entry == tiles::tileset::kChartLevelsPath)
        return CachePolicy::kImmutable;
    return CachePolicy::kRevalidate;
}

Site::Site(ArchiveCatalog catalog, const Metrics& metrics)
    : catalog_(std::move(catalog)),
      metrics_(metrics),
      index_(make_page(index_page(catalog_.cities()))),
      cities_(make_page(cities_json(catalog_.cities()))) {
    for (const City& city : catalog_.cities()) city_pages_.push_back(make_page(city_page(city)));
}

Site::Page Site::make_page(std::string text) {
    const uint64_t checksum = tiles::tileset::checksum_of(text.data(), text.size());
    return {std::move(text), fmt::format("\"{:016x}\"", checksum)};
}

Representation Site::show(const Page& page, std::string_view content_type) {
    Representation answer;
    answer.bytes = std::as_bytes(std::span(page.text));
    answer.content_type = content_type;
    answer.etag = page.etag;
    answer.cache = CachePolicy::kRevalidate;
    return answer;
}

Lookup Site::find_entry(const HttpTarget& target, size_t city) const {
    auto entry = catalog_.cities()[city].find(target.entry);
    if (!entry) return {NotFound{fmt::format("the city {} has no entry {}", target.city, target.entry)}, city};
    Representation answer;
    answer.bytes = entry->bytes;
    answer.content_type = content_type_of(target.entry);
    answer.etag = std::move(entry->etag);
    answer.cache = cache_policy_of(target.entry);
    answer.ranges = true;
    return {std::move(answer), city};
}

Lookup Site::find(const HttpTarget& target) const {
    switch (target.kind) {
        case TargetKind::kIndex:
            return {show(index_, kHtml)};
        case TargetKind::kCities:
            return {show(cities_, kJson)};
        case TargetKind::kHealth:
            return {live_text("ok\n", kText)};
        case TargetKind::kMetrics:
            return {live_text(metrics_.text(), "text/plain; version=0.0.4; charset=utf-8")};
        case TargetKind::kCityRedirect:
        case TargetKind::kCityPage:
        case TargetKind::kEntry:
            break;
    }
    const auto city = catalog_.find(target.city);
    if (!city)
        return {NotFound{fmt::format("no city is called {}; /cities.json lists those that are here", target.city)}};
    if (target.kind == TargetKind::kCityRedirect) return {Redirect{target.city + "/"}, *city};
    if (target.kind == TargetKind::kCityPage) return {show(city_pages_[*city], kHtml), *city};
    return find_entry(target, *city);
}

}  // namespace citystream::server

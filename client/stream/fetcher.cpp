#include "client/stream/fetcher.h"

#include <filesystem>

#include "client/stream/http_fetcher.h"
#include "client/stream/local_fetcher.h"

namespace citystream::client {
namespace {

constexpr uint64_t kStartUpId = ~uint64_t{0};

/// A tileset.json given by its name stands for its folder.
std::string folder_of(const std::filesystem::path& place) {
    const std::filesystem::path parent = place.parent_path();
    return parent.empty() ? "." : parent.string();
}

}  // namespace

Result<std::unique_ptr<Fetcher>> Fetcher::open(const std::string& place, const FetcherOptions& options) {
    if (place.starts_with("http://")) return open_http_fetcher(place, options);
    if (place.find("://") != std::string::npos) {
        return Error{place + ": only http:// is spoken here (put a proxy in front for https)"};
    }
    std::error_code failure;
    const std::filesystem::file_status status = std::filesystem::status(place, failure);
    if (!std::filesystem::exists(status)) {
        return Error{place +
                     ": no such file or folder (expected a .3tz archive, an unpacked folder or http://host:port)"};
    }
    if (std::filesystem::is_directory(status)) return open_folder_fetcher(place, options);
    const std::filesystem::path path(place);
    if (path.filename() == "tileset.json") return open_folder_fetcher(folder_of(path), options);
    return open_archive_fetcher(place, options);
}

Result<std::vector<std::byte>> fetch_now(Fetcher& fetcher, const std::string& path, uint64_t limit) {
    FetchRequest request;
    request.id = kStartUpId;
    request.path = path;
    request.limit = limit;
    request.priority = 1e300;
    fetcher.submit(std::move(request));
    while (true) {
        for (FetchResult& result : fetcher.wait(std::chrono::milliseconds(200))) {
            if (result.id == kStartUpId) return std::move(result.bytes);
        }
    }
}

}  // namespace citystream::client

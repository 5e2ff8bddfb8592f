// Fetchers of places on this machine: a mapped 3TZ archive, an unpacked folder. One worker thread reads; the shaped
// link delays.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "client/stream/fetcher.h"

namespace citystream::client {

/// Reads the bytes that a request names, or says why not. Called from one worker thread.
using ByteSource = std::function<Result<std::vector<std::byte>>(const FetchRequest&)>;

/// What a request of `entry_size` bytes reads: its offset and length, checked. Length 0 asks for the whole entry, at
/// most `limit` bytes.
struct ByteRange {
    uint64_t offset = 0, length = 0;
};
Result<ByteRange> range_within(const FetchRequest& request, uint64_t entry_size);

/// False for absolute paths, empty parts, "." and "..", backslashes and NUL: such a name is never looked up.
bool is_safe_path(const std::string& path);

std::unique_ptr<Fetcher> make_local_fetcher(ByteSource source, const FetcherOptions& options);
Result<std::unique_ptr<Fetcher>> open_archive_fetcher(const std::string& file, const FetcherOptions& options);
Result<std::unique_ptr<Fetcher>> open_folder_fetcher(const std::string& folder, const FetcherOptions& options);

}  // namespace citystream::client

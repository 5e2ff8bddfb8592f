#include "client/stream/local_fetcher.h"
#include "tiles/archive/archive.h"

namespace citystream::client {

Result<std::unique_ptr<Fetcher>> open_archive_fetcher(const std::string& file, const FetcherOptions& options) {
    auto opened = tiles::archive::ArchiveReader::open(file);
    if (!opened) return opened.error();
    std::shared_ptr<tiles::archive::ArchiveReader> archive = *opened;
    ByteSource source = [archive, file](const FetchRequest& request) -> Result<std::vector<std::byte>> {
        const std::span<const std::byte> entry = archive->find(request.path);
        if (entry.data() == nullptr) return Error{request.path + ": no such entry in " + file};
        const Result<ByteRange> range = range_within(request, entry.size());
        if (!range) return range.error();
        const auto part = entry.subspan(range->offset, range->length);
        return std::vector<std::byte>(part.begin(), part.end());
    };
    return make_local_fetcher(std::move(source), options);
}

}  // namespace citystream::client

#include "tiles/archive/hash_index.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace citystream::tiles::archive {

NameHash hash_name(std::string_view name) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    EVP_Digest(name.data(), name.size(), digest.data(), nullptr, EVP_md5(), nullptr);
    NameHash hash;
    std::memcpy(&hash, digest.data(), sizeof hash);
    return hash;
}

std::vector<std::byte> build_index(std::span<const ZipRecord> records) {
    std::vector<IndexEntry> entries;
    entries.reserve(records.size());
    for (const ZipRecord& record : records) entries.push_back({hash_name(record.name), record.header_offset});
    std::sort(entries.begin(), entries.end(), [](const IndexEntry& a, const IndexEntry& b) {
        return a.hash != b.hash ? a.hash < b.hash : a.header_offset < b.header_offset;
    });
    static_assert(sizeof(IndexEntry) == kIndexEntryBytes);
    std::vector<std::byte> bytes(entries.size() * kIndexEntryBytes);
    if (!bytes.empty()) std::memcpy(bytes.data(), entries.data(), bytes.size());
    return bytes;
}

IndexEntry index_entry(std::span<const std::byte> index, size_t i) {
    IndexEntry entry;
    std::memcpy(&entry, index.data() + i * kIndexEntryBytes, kIndexEntryBytes);
    return entry;
}

size_t lower_bound(std::span<const std::byte> index, const NameHash& hash) {
    size_t low = 0;
    size_t high = index.size() / kIndexEntryBytes;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (index_entry(index, middle).hash < hash) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

}  // namespace citystream::tiles::archive

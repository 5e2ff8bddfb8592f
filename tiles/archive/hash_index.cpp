#include "tiles/archive/hash_index.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace citystream::tiles::archive {

namespace {

NameHash hash_name(std::string_view name) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    EVP_Digest(name.data(), name.size(), digest.data(), nullptr, EVP_md5(), nullptr);
    NameHash hash;
    std::memcpy(&hash, digest.data(), sizeof hash);
    return hash;
}

}  // namespace

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

}  // namespace citystream::tiles::archive

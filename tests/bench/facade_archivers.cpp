#include "tests/bench/facade_archivers.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <lzma.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "codec/bits/zstd_frame.h"
#include "tests/bench/measure.h"

namespace citystream::bench {

namespace {

using Bytes = std::vector<std::byte>;
using codec::facade::FacadeMatrices;
using codec::facade::make_label;

template <typename Entry>
PlainMatrix plain(uint32_t width, uint32_t height, const std::vector<Entry>& entries) {
    const auto bytes = std::as_bytes(std::span(entries));
    return {width, height, sizeof(Entry), {bytes.begin(), bytes.end()}};
}

template <typename To, typename From>
std::vector<To> converted(const From& from) {
    std::vector<To> to;
    for (const auto entry : from) to.push_back(static_cast<To>(entry));
    return to;
}

Bytes xz(const Bytes& raw) {
    Bytes out(lzma_stream_buffer_bound(raw.size()));
    size_t size = 0;
    const auto result = lzma_easy_buffer_encode(9 | LZMA_PRESET_EXTREME, LZMA_CHECK_CRC64, nullptr,
                                                reinterpret_cast<const uint8_t*>(raw.data()), raw.size(),
                                                reinterpret_cast<uint8_t*>(out.data()), &size, out.size());
    out.resize(result == LZMA_OK ? size : 0);
    return out;
}

Bytes from_xz(const Bytes& packed, size_t size) {
    Bytes raw(size);
    uint64_t limit = UINT64_MAX;
    size_t in = 0, out = 0;
    const auto result =
        lzma_stream_buffer_decode(&limit, 0, nullptr, reinterpret_cast<const uint8_t*>(packed.data()), &in,
                                  packed.size(), reinterpret_cast<uint8_t*>(raw.data()), &out, raw.size());
    raw.resize(result == LZMA_OK ? out : 0);
    return raw;
}

OIIO::TypeDesc png_type(const PlainMatrix& matrix) {
    return matrix.entry_bytes == 1 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16;
}

/// 4-byte entries as two 16-bit images side by side: pixel pairs.
OIIO::ImageSpec png_spec(const PlainMatrix& matrix) {
    const uint32_t pixels = matrix.entry_bytes == 4 ? 2 : 1;
    OIIO::ImageSpec spec(static_cast<int>(matrix.width * pixels), static_cast<int>(matrix.height), 1, png_type(matrix));
    spec.attribute("png:compressionLevel", 9);
    return spec;
}

std::vector<unsigned char> png(const PlainMatrix& matrix) {
    std::vector<unsigned char> file;
    OIIO::Filesystem::IOVecOutput memory(file);
    const auto output = OIIO::ImageOutput::create("map.png", &memory);
    if (!output || !output->open("map.png", png_spec(matrix)) ||
        !output->write_image(png_type(matrix), matrix.bytes.data()) || !output->close())
        file.clear();
    return file;
}

Bytes from_png(const std::vector<unsigned char>& file, const PlainMatrix& matrix) {
    Bytes raw(matrix.bytes.size());
    OIIO::Filesystem::IOMemReader memory(const_cast<unsigned char*>(file.data()), file.size());
    const auto input = OIIO::ImageInput::open("map.png", nullptr, &memory);
    if (!input || !input->read_image(0, 0, 0, 1, png_type(matrix), raw.data())) raw.clear();
    return raw;
}

uint64_t differing_entries(const PlainMatrix& matrix, const Bytes& back) {
    const uint64_t entries = matrix.bytes.size() / matrix.entry_bytes;
    if (back.size() != matrix.bytes.size()) return entries;
    uint64_t differing = 0;
    for (uint64_t i = 0; i < entries; ++i) {
        const size_t at = i * matrix.entry_bytes;
        differing += std::memcmp(&matrix.bytes[at], &back[at], matrix.entry_bytes) != 0 ? 1 : 0;
    }
    return differing;
}

}  // namespace

PlainMatrix displacement_matrix(const FacadeMatrices& matrices) {
    return plain(matrices.width, matrices.height, matrices.displacement_mm);
}

PlainMatrix material_matrix(const FacadeMatrices& matrices) {
    return index_matrix(matrices.width, matrices.height, converted<uint32_t>(matrices.material));
}

PlainMatrix index_matrix(uint32_t width, uint32_t height, std::span<const uint32_t> entries) {
    const uint32_t greatest = *std::max_element(entries.begin(), entries.end());
    if (greatest < 1u << 8) return plain(width, height, converted<uint8_t>(entries));
    if (greatest < 1u << 16) return plain(width, height, converted<uint16_t>(entries));
    return plain(width, height, std::vector<uint32_t>(entries.begin(), entries.end()));
}

PlainMatrix joint_matrix(const FacadeMatrices& matrices) {
    std::map<uint32_t, uint32_t> ranks;
    for (size_t i = 0; i < matrices.material.size(); ++i)
        ranks[make_label(matrices.displacement_mm[i], matrices.material[i])] = 0;
    uint32_t next = 0;
    for (auto& [label, rank] : ranks) rank = next++;
    std::vector<uint32_t> entries;
    for (size_t i = 0; i < matrices.material.size(); ++i)
        entries.push_back(ranks[make_label(matrices.displacement_mm[i], matrices.material[i])]);
    return index_matrix(matrices.width, matrices.height, entries);
}

Archived archive(std::string_view archiver, const PlainMatrix& matrix) {
    Archived result;
    if (archiver == "png") {
        std::vector<unsigned char> file;
        result.seconds = seconds_of([&] { file = png(matrix); });
        result.bytes = file.size();
        result.mismatches = differing_entries(matrix, from_png(file, matrix));
        return result;
    }
    Bytes packed;
    if (archiver == "xz") {
        result.seconds = seconds_of([&] { packed = xz(matrix.bytes); });
        result.mismatches = differing_entries(matrix, from_xz(packed, matrix.bytes.size()));
    } else {
        result.seconds = seconds_of([&] { packed = codec::bits::compress_frame(matrix.bytes); });
        const auto back = codec::bits::decompress_frame(packed, matrix.bytes.size());
        result.mismatches = differing_entries(matrix, back ? *back : Bytes());
    }
    result.bytes = packed.size();
    return result;
}

}  // namespace citystream::bench

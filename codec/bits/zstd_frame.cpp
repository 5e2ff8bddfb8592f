#include "codec/bits/zstd_frame.h"

#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <memory>
#include <new>
#include <string>

namespace citystream::codec::bits {

namespace {

struct FreeContext {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

/// A zstd block takes at least 4 bytes (header and one repeated byte) and yields at most 128 KiB: no frame expands more
/// than this.
constexpr uint64_t kMostBytesPerFrameByte = (128u << 10) / 4;
constexpr std::byte kMagic[4] = {std::byte{0x28}, std::byte{0xb5}, std::byte{0x2f}, std::byte{0xfd}};
constexpr size_t kDescriptorOffset = 4;
constexpr std::byte kChecksumFlag{0x04};

/// Everything that the frame header and the block headers say, before anything is allocated.
Status check_frame(std::span<const std::byte> frame, size_t decoded_size) {
    if (frame.size() <= kDescriptorOffset || !std::equal(std::begin(kMagic), std::end(kMagic), frame.begin())) {
        return Error{"not a zstd frame", 0};
    }
    const unsigned long long claimed = ZSTD_getFrameContentSize(frame.data(), frame.size());
    if (claimed == ZSTD_CONTENTSIZE_ERROR || claimed == ZSTD_CONTENTSIZE_UNKNOWN) {
        return Error{"zstd frame without a content size", kDescriptorOffset};
    }
    if (claimed != decoded_size) {
        return Error{"zstd frame holds " + std::to_string(claimed) + " bytes, expected " + std::to_string(decoded_size),
                     kDescriptorOffset};
    }
    if ((frame[kDescriptorOffset] & kChecksumFlag) == std::byte{0}) {
        return Error{"zstd frame without a checksum", kDescriptorOffset};
    }
    const size_t frame_size = ZSTD_findFrameCompressedSize(frame.data(), frame.size());
    if (ZSTD_isError(frame_size)) {
        return Error{std::string("zstd frame is cut off or damaged: ") + ZSTD_getErrorName(frame_size), frame.size()};
    }
    if (frame_size != frame.size()) return Error{"bytes follow the zstd frame", frame_size};
    if (decoded_size / kMostBytesPerFrameByte > frame.size()) {
        return Error{"zstd frame claims more bytes than its blocks can hold", kDescriptorOffset};
    }
    return Done{};
}

}  // namespace

std::vector<std::byte> compress_frame(std::span<const std::byte> raw, int level) {
    const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
    if (!context) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_contentSizeFlag, 1);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
    std::vector<std::byte> frame(ZSTD_compressBound(raw.size()));
    const size_t size = ZSTD_compress2(context.get(), frame.data(), frame.size(), raw.data(), raw.size());
    // With room for the bound, memory is the only thing that can be missing.
    if (ZSTD_isError(size)) throw std::bad_alloc();
    frame.resize(size);
    return frame;
}

uint64_t frame_content_size(std::span<const std::byte> frame) {
    const unsigned long long claimed = ZSTD_getFrameContentSize(frame.data(), frame.size());
    return claimed == ZSTD_CONTENTSIZE_ERROR || claimed == ZSTD_CONTENTSIZE_UNKNOWN ? 0 : claimed;
}

Result<std::vector<std::byte>> decompress_frame(std::span<const std::byte> frame, size_t decoded_size) {
    if (const Status checked = check_frame(frame, decoded_size); !checked) return checked.error();
    const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
    if (!context) return Error{"out of memory for the zstd decoder"};
    std::vector<std::byte> raw(decoded_size);
    const size_t size = ZSTD_decompressDCtx(context.get(), raw.data(), raw.size(), frame.data(), frame.size());
    if (ZSTD_isError(size)) {
        return Error{std::string("zstd frame does not decode: ") + ZSTD_getErrorName(size), 0};
    }
    if (size != decoded_size) {
        return Error{"zstd frame yields " + std::to_string(size) + " bytes, expected " + std::to_string(decoded_size),
                     0};
    }
    return raw;
}

}  // namespace citystream::codec::bits

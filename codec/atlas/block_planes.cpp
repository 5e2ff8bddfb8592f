#include "codec/atlas/block_planes.h"

#include <cassert>
#include <cstddef>

namespace citystream::codec::atlas {

void split_block_planes(std::span<const uint32_t> words, uint32_t block_words, std::span<uint32_t> planes) {
    assert(block_words > 0 && words.size() % block_words == 0 && planes.size() == words.size());
    const size_t blocks = words.size() / block_words;
    for (size_t plane = 0; plane < block_words; ++plane) {
        for (size_t block = 0; block < blocks; ++block)
            planes[plane * blocks + block] = words[block * block_words + plane];
    }
}

void join_block_planes(std::span<const uint32_t> planes, uint32_t block_words, std::span<uint32_t> words) {
    assert(block_words > 0 && planes.size() % block_words == 0 && words.size() == planes.size());
    const size_t blocks = planes.size() / block_words;
    for (size_t plane = 0; plane < block_words; ++plane) {
        for (size_t block = 0; block < blocks; ++block)
            words[block * block_words + plane] = planes[plane * blocks + block];
    }
}

}  // namespace citystream::codec::atlas

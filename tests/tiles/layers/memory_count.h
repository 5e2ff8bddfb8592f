// Counts what the program holds through operator new, so that tests can assert it. Not under sanitizers, which have
// operators of their own.
#pragma once

#include <cstdint>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CITYSTREAM_COUNTS_MEMORY
#endif

namespace citystream::tiles::layers::memory_count {

/// Counts from here on.
void start();
/// The most that was held at a time since start(), beyond what was held then.
uint64_t peak();

}  // namespace citystream::tiles::layers::memory_count

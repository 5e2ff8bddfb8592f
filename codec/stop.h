// How long work is given up from outside: a flag that another thread, or a signal handler, sets and never takes back.
// Work that is told of one looks at it now and then.
#pragma once

#include <atomic>

#include "codec/result.h"

namespace citystream {

/// Null: never.
inline bool is_stopped(const std::atomic<bool>* stop) {
    return stop != nullptr && stop->load(std::memory_order_relaxed);
}

/// Of work that was given up: nothing is wrong with what it was given.
inline Error stopped_error() {
    return Error{"stopped"};
}

}  // namespace citystream

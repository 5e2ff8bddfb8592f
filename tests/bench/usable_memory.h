// How much memory a program may take without being ended for it.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>

namespace citystream::bench {

/// Bytes: three quarters of what the machine, the control group and the shell's limit (ulimit -v) all allow.
inline uint64_t usable_memory() {
    uint64_t bytes = static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) == 0) bytes = std::min<uint64_t>(bytes, limit.rlim_cur);
    std::ifstream group("/sys/fs/cgroup/memory.max");
    if (uint64_t most = 0; group >> most) bytes = std::min(bytes, most);
    return bytes / 4 * 3;
}

}  // namespace citystream::bench

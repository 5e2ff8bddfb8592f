// Runs a fuzz target without libFuzzer: every file of a seed folder, truncations of each, then seeded mutations until
// the time is up.
//   NAME_fuzz [--seconds N | --mutations N] DIR...
// A failure is a crash (or a sanitizer's report); the mutations are the same in every run, only their number depends on
// the machine, unless it is given.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string_view>
#include <system_error>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

using Bytes = std::vector<uint8_t>;
using Clock = std::chrono::steady_clock;

/// Most truncations tried of one file; longer files are cut at evenly spread places.
constexpr size_t kMostTruncations = 2048;
constexpr uint8_t kAwkwardBytes[] = {0x00, 0x01, 0x7f, 0x80, 0xfe, 0xff, ' ', '"', '{', '/'};

struct Options {
    double seconds = 4;
    uint64_t mutations = 0;  ///< given: as many, however long they take
    std::vector<std::filesystem::path> folders;
};

bool parse(int argc, char** argv, Options& options) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view option = argv[i];
        if (option != "--seconds" && option != "--mutations") {
            options.folders.emplace_back(argv[i]);
            continue;
        }
        char* end = nullptr;
        if (++i >= argc) return false;
        const double number = std::strtod(argv[i], &end);
        if (*end != '\0' || !(number >= 0 && number < 1e15)) return false;
        if (option == "--seconds")
            options.seconds = number;
        else
            options.mutations = static_cast<uint64_t>(number);
    }
    return !options.folders.empty();
}

/// The files of the folders in order of their names. A folder that is missing is no seeds: the mutations start from
/// nothing then.
std::vector<Bytes> read_seeds(const std::vector<std::filesystem::path>& folders) {
    std::vector<std::filesystem::path> files;
    for (const auto& folder : folders) {
        std::error_code missing;
        for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
            if (entry.is_regular_file()) files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    std::vector<Bytes> seeds;
    for (const auto& file : files) {
        std::ifstream in(file, std::ios::binary);
        seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
    if (seeds.empty()) seeds.emplace_back();
    return seeds;
}

class Runner {
  public:
    explicit Runner(const Options& options)
        : mutations_(options.mutations),
          end_(Clock::now() +
               std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.seconds))) {}

    bool time_left() const { return mutations_ > 0 || Clock::now() < end_; }
    /// Whether a mutation is to follow `done`.
    bool goes_on(uint64_t done) const { return mutations_ > 0 ? done < mutations_ : time_left(); }
    uint64_t executions() const { return executions_; }

    /// In a buffer of exactly this size, so that a sanitizer sees the first byte past the end.
    void run(const uint8_t* data, size_t size) {
        const Bytes exact(data, data + size);
        LLVMFuzzerTestOneInput(exact.data(), exact.size());
        ++executions_;
    }

  private:
    uint64_t mutations_;
    Clock::time_point end_;
    uint64_t executions_ = 0;
};

void run_truncations(Runner& runner, const Bytes& seed) {
    const size_t stride = seed.size() / kMostTruncations + 1;
    for (size_t size = 0; size < seed.size() && runner.time_left(); size += stride) runner.run(seed.data(), size);
}

size_t below(std::mt19937_64& random, size_t limit) {
    return limit == 0 ? 0 : static_cast<size_t>(random() % limit);
}

/// One small change somewhere.
void mutate_once(std::mt19937_64& random, Bytes& bytes, const std::vector<Bytes>& seeds) {
    const size_t at = below(random, bytes.size());
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const size_t length = std::min(1 + below(random, 16), bytes.size() - at);
    const auto place_end = place + static_cast<std::ptrdiff_t>(length);
    switch (bytes.empty() ? 4 : below(random, 8)) {
        case 0:
            *place ^= static_cast<uint8_t>(1u << below(random, 8));
            break;
        case 1:
            *place = kAwkwardBytes[below(random, std::size(kAwkwardBytes))];
            break;
        case 2:
            *place = static_cast<uint8_t>(random());
            break;
        case 3:
            bytes.erase(place, place_end);
            break;
        case 4:
            bytes.insert(place, 1 + below(random, 8), static_cast<uint8_t>(random()));
            break;
        case 5:
            bytes.resize(at);
            break;
        case 6:
            std::fill(place, place_end, kAwkwardBytes[below(random, std::size(kAwkwardBytes))]);
            break;
        default: {
            const Bytes& other = seeds[below(random, seeds.size())];
            const size_t from = below(random, other.size());
            const size_t count = std::min(length, other.size() - from);
            std::copy_n(other.begin() + static_cast<std::ptrdiff_t>(from), count, place);
        }
    }
}

void run_mutations(Runner& runner, const std::vector<Bytes>& seeds) {
    std::mt19937_64 random(1);
    for (uint64_t done = 0; runner.goes_on(done); ++done) {
        Bytes bytes = seeds[below(random, seeds.size())];
        for (size_t changes = 1 + below(random, 6); changes > 0; --changes) mutate_once(random, bytes, seeds);
        runner.run(bytes.data(), bytes.size());
    }
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    if (!parse(argc, argv, options)) {
        std::fprintf(stderr, "usage: %s [--seconds N | --mutations N] DIR...\n", argv[0]);
        return 2;
    }
    const std::vector<Bytes> seeds = read_seeds(options.folders);
    Runner runner(options);
    for (const Bytes& seed : seeds) runner.run(seed.data(), seed.size());
    for (const Bytes& seed : seeds) run_truncations(runner, seed);
    run_mutations(runner, seeds);
    std::printf("%zu seeds, %llu executions\n", seeds.size(), static_cast<unsigned long long>(runner.executions()));
    return 0;
}

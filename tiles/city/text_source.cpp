#include "tiles/city/text_source.h"

#include <lzma.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

namespace citystream::tiles::city {
namespace {

constexpr size_t kChunkBytes = size_t{1} << 18;
constexpr uint64_t kMaxXzMemory = uint64_t{256} << 20;

enum class Packing : uint8_t { kPlain, kXz, kGzip };

Packing packing_of(std::string_view head) {
    if (head.starts_with(std::string_view("\xFD"
                                          "7zXZ\0",
                                          6)))
        return Packing::kXz;
    if (head.starts_with("\x1F\x8B")) return Packing::kGzip;
    return Packing::kPlain;
}

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

struct TextSource::State {
    std::string name;
    std::unique_ptr<std::FILE, CloseFile> file;  ///< null when reading `memory`
    std::string_view memory;
    uint64_t total = 0;
    uint64_t done = 0;

    Packing packing = Packing::kPlain;
    std::vector<char> input;
    size_t input_begin = 0, input_end = 0;
    bool input_over = false;
    bool output_over = false;
    lzma_stream xz = LZMA_STREAM_INIT;
    z_stream gzip = {};
    bool gzip_open = false;

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { close_decoder(); }

    void close_decoder() {
        lzma_end(&xz);
        xz = LZMA_STREAM_INIT;
        if (gzip_open) inflateEnd(&gzip);
        gzip = {};
        gzip_open = false;
    }

    Error error(const std::string& what) const { return Error{name + ": " + what, done}; }

    /// Stored bytes into `out`; 0 at the end.
    Result<size_t> read_stored(std::span<char> out) {
        size_t count = 0;
        if (file) {
            count = std::fread(out.data(), 1, out.size(), file.get());
            if (count == 0 && std::ferror(file.get()) != 0)
                return error(std::string("read failed: ") + std::strerror(errno));
        } else {
            count = std::min(out.size(), memory.size() - static_cast<size_t>(done));
            std::copy_n(memory.data() + done, count, out.data());
        }
        done += count;
        return count;
    }

    Status refill() {
        if (input_begin < input_end || input_over) return Done{};
        const auto count = read_stored(input);
        if (!count) return count.error();
        input_begin = 0;
        input_end = *count;
        input_over = *count == 0;
        return Done{};
    }

    Status start() {
        close_decoder();
        done = 0;
        input_over = output_over = false;
        if (file) std::rewind(file.get());
        input.resize(kChunkBytes);
        input_begin = input_end = 0;
        if (auto status = refill(); !status) return status;
        packing = packing_of(std::string_view(input.data(), input_end));
        if (packing == Packing::kXz && lzma_stream_decoder(&xz, kMaxXzMemory, LZMA_CONCATENATED) != LZMA_OK) {
            return error("cannot start the xz decoder");
        }
        if (packing == Packing::kGzip) {
            constexpr int kGzipWindow = 15 + 16;
            if (inflateInit2(&gzip, kGzipWindow) != Z_OK) return error("cannot start the gzip decoder");
            gzip_open = true;
        }
        return Done{};
    }

    Result<size_t> read_plain(std::span<char> out) {
        if (const auto status = refill(); !status) return status.error();
        const size_t count = std::min(out.size(), input_end - input_begin);
        std::copy_n(input.data() + input_begin, count, out.data());
        input_begin += count;
        return count;
    }

    Result<size_t> read_xz(std::span<char> out) {
        xz.next_out = reinterpret_cast<uint8_t*>(out.data());
        xz.avail_out = out.size();
        while (xz.avail_out == out.size() && !output_over) {
            if (const auto status = refill(); !status) return status.error();
            xz.next_in = reinterpret_cast<const uint8_t*>(input.data() + input_begin);
            xz.avail_in = input_end - input_begin;
            const lzma_ret code = lzma_code(&xz, input_over ? LZMA_FINISH : LZMA_RUN);
            input_begin = input_end - xz.avail_in;
            if (code == LZMA_STREAM_END) {
                output_over = true;
            } else if (code == LZMA_BUF_ERROR) {
                return error("xz data ends too early");
            } else if (code == LZMA_MEMLIMIT_ERROR) {
                return error("xz data needs more than 256 MiB to decompress");
            } else if (code != LZMA_OK) {
                return error("xz data is damaged");
            }
        }
        return out.size() - xz.avail_out;
    }

    Result<size_t> read_gzip(std::span<char> out) {
        constexpr size_t kMost = size_t{1} << 30;
        const size_t wanted = std::min(out.size(), kMost);
        gzip.next_out = reinterpret_cast<Bytef*>(out.data());
        gzip.avail_out = static_cast<uInt>(wanted);
        while (gzip.avail_out == wanted && !output_over) {
            if (const auto status = refill(); !status) return status.error();
            if (input_over) return error("gzip data ends too early");
            gzip.next_in = reinterpret_cast<Bytef*>(input.data() + input_begin);
            gzip.avail_in = static_cast<uInt>(input_end - input_begin);
            const int code = inflate(&gzip, Z_NO_FLUSH);
            input_begin = input_end - gzip.avail_in;
            if (code == Z_STREAM_END) {
                if (const auto status = refill(); !status) return status.error();
                output_over = input_over;
                if (!output_over) inflateReset(&gzip);  // further members follow
            } else if (code != Z_OK && code != Z_BUF_ERROR) {
                return error("gzip data is damaged");
            }
        }
        return wanted - gzip.avail_out;
    }
};

TextSource::TextSource(std::unique_ptr<State> state) : state_(std::move(state)) {}
TextSource::TextSource(TextSource&&) noexcept = default;
TextSource& TextSource::operator=(TextSource&&) noexcept = default;
TextSource::~TextSource() = default;

Result<TextSource> TextSource::open(const std::string& path) {
    auto state = std::make_unique<State>();
    state->name = path;
    std::error_code code;
    if (std::filesystem::is_directory(path, code)) return Error{path + ": is a folder, not a city model"};
    state->file.reset(std::fopen(path.c_str(), "rb"));
    if (!state->file) return Error{path + ": cannot be opened: " + std::strerror(errno)};
    const auto size = std::filesystem::file_size(path, code);
    state->total = code ? 0 : size;
    if (const auto status = state->start(); !status) return status.error();
    return TextSource(std::move(state));
}

Result<TextSource> TextSource::from_memory(std::string name, std::string_view bytes) {
    auto state = std::make_unique<State>();
    state->name = std::move(name);
    state->memory = bytes;
    state->total = bytes.size();
    if (const auto status = state->start(); !status) return status.error();
    return TextSource(std::move(state));
}

Result<size_t> TextSource::read(std::span<char> out) {
    switch (state_->packing) {
        case Packing::kXz:
            return state_->read_xz(out);
        case Packing::kGzip:
            return state_->read_gzip(out);
        case Packing::kPlain:
            break;
    }
    return state_->read_plain(out);
}

Status TextSource::rewind() {
    return state_->start();
}
const std::string& TextSource::name() const {
    return state_->name;
}
bool TextSource::compressed() const {
    return state_->packing != Packing::kPlain;
}
uint64_t TextSource::stored_bytes_done() const {
    return state_->done;
}
uint64_t TextSource::stored_bytes_total() const {
    return state_->total;
}

Result<bool> LineReader::refill() {
    chunk_.resize(kChunkBytes);
    const auto count = source_.read(chunk_);
    if (!count) {
        chunk_.clear();
        position_ = 0;
        return count.error();
    }
    chunk_.resize(*count);
    position_ = 0;
    return *count > 0;
}

Status LineReader::check_length(uint64_t length) const {
    uint64_t most = kMaxLineBytes;
    if (source_.compressed()) most = std::min(most, kFreeBytes + kMaxExpansion * source_.stored_bytes_done());
    if (length <= most) return Done{};
    return Error{
        source_.name() + ": line " + std::to_string(line_number_) + ": longer than " + std::to_string(most) + " bytes",
        line_offset_};
}

Result<bool> LineReader::next(std::string& line) {
    line.clear();
    ++line_number_;
    line_offset_ = next_offset_;
    while (true) {
        if (position_ == chunk_.size()) {
            const auto more = refill();
            if (!more) return more.error();
            if (!*more) return !line.empty();
        }
        const size_t end = chunk_.find('\n', position_);
        const size_t count = (end == std::string::npos ? chunk_.size() : end) - position_;
        line.append(chunk_, position_, count);
        position_ += count;
        next_offset_ += count;
        if (const auto status = check_length(line.size()); !status) return status.error();
        if (end == std::string::npos) continue;
        ++position_;
        ++next_offset_;
        if (!line.empty() && line.back() == '\r') line.pop_back();
        return true;
    }
}

Status LineReader::rest(std::string& text) {
    while (true) {
        text.append(chunk_, position_);
        position_ = chunk_.size();
        if (auto status = check_length(text.size()); !status) return status;
        const auto more = refill();
        if (!more) return more.error();
        if (!*more) return Done{};
    }
}

}  // namespace citystream::tiles::city

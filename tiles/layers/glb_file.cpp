#include "tiles/layers/glb_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <vector>

namespace citystream::tiles::layers {
namespace {

constexpr uint32_t kMagic = 0x46546c67, kVersion = 2, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr uint64_t kCopyBytes = 4 << 20;
constexpr int kFloat = 5126, kUnsignedInt = 5125;
constexpr uint32_t kIndexTarget = 34963;

}  // namespace

Result<std::unique_ptr<GlbFile>> GlbFile::create(const std::string& path, const std::string& folder) {
    auto binary = quadtree::SpoolFile::create(folder + "/glb");
    if (!binary) return binary.error();
    return std::unique_ptr<GlbFile>(new GlbFile(path, std::move(binary).value()));
}

uint32_t GlbFile::add(const char* array, nlohmann::json value) {
    nlohmann::json& list = json_[array];
    list.push_back(std::move(value));
    return static_cast<uint32_t>(list.size() - 1);
}

Result<uint32_t> GlbFile::add_view(std::span<const std::byte> bytes, uint32_t target) {
    auto range = binary_->append(bytes);
    if (!range) return range.error();
    static constexpr std::array<std::byte, 4> kPadding{};
    if (bytes.size() % 4 != 0) {
        if (auto pad = binary_->append(std::span(kPadding).first(4 - bytes.size() % 4)); !pad) return pad.error();
    }
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", range->offset}, {"byteLength", range->size}};
    if (target != 0) view["target"] = target;
    return add("bufferViews", std::move(view));
}

Result<uint32_t> GlbFile::add_floats(std::span<const float> values, uint32_t components, bool bounds, uint32_t target) {
    static constexpr std::array<const char*, 5> kTypes = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    auto view = add_view(std::as_bytes(values), target);
    if (!view) return view;
    nlohmann::json accessor = {{"bufferView", *view},
                               {"componentType", kFloat},
                               {"count", values.size() / components},
                               {"type", kTypes[components]}};
    if (bounds && !values.empty()) {
        std::vector<float> low(values.begin(), values.begin() + components), high = low;
        for (size_t i = 0; i < values.size(); ++i) {
            low[i % components] = std::min(low[i % components], values[i]);
            high[i % components] = std::max(high[i % components], values[i]);
        }
        accessor["min"] = low;
        accessor["max"] = high;
    }
    return add("accessors", std::move(accessor));
}

Result<uint32_t> GlbFile::add_indices(std::span<const uint32_t> values) {
    auto view = add_view(std::as_bytes(values), kIndexTarget);
    if (!view) return view;
    return add("accessors",
               {{"bufferView", *view}, {"componentType", kUnsignedInt}, {"count", values.size()}, {"type", "SCALAR"}});
}

Status GlbFile::finish() {
    const std::string temporary = path_ + ".part";
    Status status = write(temporary);
    if (status && std::rename(temporary.c_str(), path_.c_str()) != 0)
        status = Error{"cannot rename " + temporary + ": " + std::strerror(errno)};
    if (!status) std::remove(temporary.c_str());
    return status;
}

Status GlbFile::write(const std::string& temporary) {
    json_["buffers"] = {{{"byteLength", binary_->size()}}};
    std::string text = json_.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const uint64_t total = 12 + 8 + text.size() + 8 + binary_->size();
    if (total > UINT32_MAX)
        return Error{"the reference would take " + std::to_string(total >> 20) +
                     " MiB, more than the 4 GiB that a .glb can hold"};
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(temporary.c_str(), "wb"), std::fclose);
    if (!file) return Error{"cannot create " + temporary + ": " + std::strerror(errno)};
    const std::array<uint32_t, 5> head = {kMagic, kVersion, static_cast<uint32_t>(total),
                                          static_cast<uint32_t>(text.size()), kJsonChunk};
    const std::array<uint32_t, 2> middle = {static_cast<uint32_t>(binary_->size()), kBinaryChunk};
    bool good = std::fwrite(head.data(), sizeof(head), 1, file.get()) == 1 &&
                std::fwrite(text.data(), text.size(), 1, file.get()) == 1 &&
                std::fwrite(middle.data(), sizeof(middle), 1, file.get()) == 1;
    std::vector<std::byte> scratch;
    for (uint64_t at = 0; good && at < binary_->size(); at += kCopyBytes) {
        scratch.clear();
        if (Status status = binary_->read({at, std::min(kCopyBytes, binary_->size() - at)}, scratch); !status)
            return status;
        good = std::fwrite(scratch.data(), scratch.size(), 1, file.get()) == 1;
    }
    if (!good || std::fflush(file.get()) != 0 || fsync(fileno(file.get())) != 0)
        return Error{"cannot write " + temporary + ": " + std::strerror(errno)};
    return Done{};
}

}  // namespace citystream::tiles::layers

// Request targets and Range fields: whatever comes in, what comes out names an archive's entry and a part of it.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/http_target.h"
#include "server/responses.h"

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

bool has_unsafe_segment(std::string_view path) {
    for (;;) {
        const size_t slash = path.find('/');
        const std::string_view segment = path.substr(0, slash);
        if (segment == "." || segment == "..") return true;
        if (slash == std::string_view::npos) return false;
        if (segment.empty()) return true;
        path.remove_prefix(slash + 1);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::server;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (const auto target = parse_http_target(text); target.ok()) {
        require(!target->entry.starts_with('/') && !has_unsafe_segment(target->entry) &&
                !has_unsafe_segment(target->city));
        for (const std::string_view part : {std::string_view(target->city), std::string_view(target->entry)}) {
            require(part.find('\0') == std::string_view::npos && part.find('\\') == std::string_view::npos &&
                    part.find('\n') == std::string_view::npos);
        }
        require(target->city.find('/') == std::string::npos);
    } else {
        require(!target.error().message.empty());
    }

    for (const uint64_t entity : {uint64_t{0}, uint64_t{1}, uint64_t{1000}, ~uint64_t{0}}) {
        const RangeChoice choice = choose_range(text, entity);
        if (choice.kind != RangeKind::kPart) continue;
        require(choice.part.length > 0 && choice.part.first < entity &&
                choice.part.length <= entity - choice.part.first);
    }
    etag_listed(text, "\"00000000-1\"", true);
    return 0;
}

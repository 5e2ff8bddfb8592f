#include "tiles/city/xml_stream.h"

#include <expat.h>

#include <cstring>
#include <memory>
#include <utility>

namespace citystream::tiles::city {
namespace {

constexpr size_t kMostLevels = 256;
constexpr size_t kMostText = size_t{1} << 28;
constexpr int kChunkBytes = 1 << 18;

std::string_view without_prefix(const char* name) {
    const char* colon = std::strrchr(name, ':');
    return colon == nullptr ? name : colon + 1;
}

struct FreeParser {
    void operator()(XML_ParserStruct* parser) const { XML_ParserFree(parser); }
};

}  // namespace

std::string_view XmlAttributes::operator[](std::string_view local_name) const {
    for (const char** pair = pairs_; *pair != nullptr; pair += 2) {
        if (without_prefix(pair[0]) == local_name) return pair[1];
    }
    return {};
}

class XmlParsing {
  public:
    XmlParsing(TextSource& source, XmlHandler& handler)
        : source_(source), handler_(handler), parser_(XML_ParserCreate(nullptr)) {
        XML_SetUserData(parser_.get(), this);
        XML_SetElementHandler(parser_.get(), &on_start, &on_end);
        XML_SetCharacterDataHandler(parser_.get(), &on_text);
        XML_SetStartDoctypeDeclHandler(parser_.get(), &on_doctype);
        XML_SetHashSalt(parser_.get(), 1);  // same run, same order, same time
        handler_.line_now_ = [this] { return static_cast<uint64_t>(XML_GetCurrentLineNumber(parser_.get())); };
    }
    ~XmlParsing() { handler_.line_now_ = nullptr; }
    XmlParsing(const XmlParsing&) = delete;
    XmlParsing& operator=(const XmlParsing&) = delete;

    Status run(const std::function<void()>& after_chunk) {
        while (true) {
            void* buffer = XML_GetBuffer(parser_.get(), kChunkBytes);
            if (buffer == nullptr) return fault("out of memory");
            const auto count = source_.read({static_cast<char*>(buffer), kChunkBytes});
            if (!count) return count.error();
            const auto code =
                XML_ParseBuffer(parser_.get(), static_cast<int>(*count), *count == 0 ? XML_TRUE : XML_FALSE);
            if (!handler_.fault_.empty()) return fault(handler_.fault_);
            if (handler_.stopped_) return Done{};
            if (code != XML_STATUS_OK) {
                return fault(std::string("not well-formed XML: ") + XML_ErrorString(XML_GetErrorCode(parser_.get())));
            }
            if (*count == 0) return Done{};
            after_chunk();
        }
    }

  private:
    Error fault(const std::string& what) const {
        const auto byte = XML_GetCurrentByteIndex(parser_.get());
        return Error{source_.name() + ": line " + std::to_string(XML_GetCurrentLineNumber(parser_.get())) + ": " + what,
                     byte < 0 ? Error::kNoOffset : static_cast<uint64_t>(byte)};
    }

    void check() {
        if (!handler_.fault_.empty() || handler_.stopped_) XML_StopParser(parser_.get(), XML_FALSE);
    }

    bool over() const { return !handler_.fault_.empty() || handler_.stopped_; }

    static void on_start(void* self, const char* name, const char** attributes) {
        auto& parsing = *static_cast<XmlParsing*>(self);
        if (parsing.over()) return;
        if (++parsing.level_ > kMostLevels) parsing.handler_.refuse("nested more than 256 levels deep");
        parsing.handler_.collecting_ = false;
        if (!parsing.over()) parsing.handler_.start(without_prefix(name), XmlAttributes(attributes));
        parsing.check();
    }

    static void on_end(void* self, const char* name) {
        auto& parsing = *static_cast<XmlParsing*>(self);
        if (parsing.over()) return;
        --parsing.level_;
        parsing.handler_.collecting_ = false;
        parsing.handler_.end(without_prefix(name));
        parsing.check();
    }

    static void on_text(void* self, const char* text, int length) {
        auto& parsing = *static_cast<XmlParsing*>(self);
        if (!parsing.handler_.collecting_ || parsing.over()) return;
        parsing.handler_.text_.append(text, static_cast<size_t>(length));
        if (parsing.handler_.text_.size() > kMostText)
            parsing.handler_.refuse("more than 256 MiB of text in one element");
        parsing.check();
    }

    static void on_doctype(void* self, const char*, const char*, const char*, int) {
        auto& parsing = *static_cast<XmlParsing*>(self);
        parsing.handler_.refuse("has a document type declaration; those are refused");
        parsing.check();
    }

    TextSource& source_;
    XmlHandler& handler_;
    std::unique_ptr<XML_ParserStruct, FreeParser> parser_;
    size_t level_ = 0;
};

Status parse_xml(TextSource& source, XmlHandler& handler, const std::function<void()>& after_chunk) {
    return XmlParsing(source, handler).run(after_chunk);
}

}  // namespace citystream::tiles::city

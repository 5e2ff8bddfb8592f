// XML as a stream of elements (expat), with the limits that hostile files need.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "codec/result.h"
#include "tiles/city/text_source.h"

namespace citystream::tiles::city {

/// Attributes of one element, by name without prefix.
class XmlAttributes {
  public:
    explicit XmlAttributes(const char** pairs) : pairs_(pairs) {}
    /// Empty when absent.
    std::string_view operator[](std::string_view local_name) const;

  private:
    const char** pairs_;
};

/// Takes the elements in document order. Names come without prefix.
class XmlHandler {
  public:
    virtual ~XmlHandler() = default;
    virtual void start(std::string_view name, const XmlAttributes& attributes) = 0;
    virtual void end(std::string_view name) = 0;

    /// Text of the innermost element for which collect_text() was called in start(), complete when its end() is called.
    const std::string& text() const { return text_; }

  protected:
    void collect_text() {
        text_.clear();
        collecting_ = true;
    }
    void refuse(std::string why) {
        if (fault_.empty()) fault_ = std::move(why);
    }
    void stop() { stopped_ = true; }
    uint64_t line() const { return line_now_ ? line_now_() : 0; }

  private:
    friend class XmlParsing;
    std::string text_, fault_;
    bool collecting_ = false, stopped_ = false;
    std::function<uint64_t()> line_now_;
};

/// Parses the source to its end, or until the handler stops. Error (with line and byte): not well-formed, a document
/// type declaration (entities are refused), more than 256 levels, more than 256 MiB of text in one element, or what the
/// handler refused.
Status parse_xml(TextSource& source, XmlHandler& handler, const std::function<void()>& after_chunk);

}  // namespace citystream::tiles::city

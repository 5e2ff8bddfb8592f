// Text for HTML and SVG, whose author may be anyone (a city's title, a file's name).
#pragma once

#include <string>
#include <string_view>

namespace citystream {

/// `text` with & < > " ' as entities: safe as content and within quoted attributes. O(n).
inline std::string escape_html(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

}  // namespace citystream

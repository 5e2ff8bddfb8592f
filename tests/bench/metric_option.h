// The --metric option of benches that compare pictures.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "codec/atlas/image_metric.h"

namespace citystream::bench {

/// "METRIC:TOLERANCE,...". False: one of them is none; `metrics` then holds those before it.
inline bool take_metrics(const std::string& text, std::vector<codec::atlas::Metric>& metrics) {
    metrics.clear();
    for (size_t start = 0; start <= text.size();) {
        const size_t comma = std::min(text.find(',', start), text.size());
        const auto metric = codec::atlas::parse_metric(std::string_view(text).substr(start, comma - start));
        if (!metric) return false;
        metrics.push_back(*metric);
        start = comma + 1;
    }
    return true;
}

}  // namespace citystream::bench

#include "tiles/city/citygml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tiles/city/citygml_appearance.h"
#include "tiles/city/citygml_drawing.h"
#include "tiles/city/citygml_feature.h"
#include "tiles/city/crs_name.h"
#include "tiles/city/xml_stream.h"

namespace citystream::tiles::city {
namespace {

bool is_membership(std::string_view name) {
    constexpr std::array<std::string_view, 5> kNames = {"cityObjectMember", "featureMember", "featureMembers",
                                                        "cityObjectMembers", "member"};
    return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

bool is_root(std::string_view name) {
    return name == "CityModel" || name == "FeatureCollection";
}

constexpr size_t kMostAppearance = size_t{1} << 26;

/// First reading: the CRS, the title, and the appearance that belongs to no single feature.
class ModelScan : public XmlHandler {
  public:
    GmlAppearance appearance;
    GmlAppearanceParser appearance_parser;
    int32_t epsg = 0;
    std::string title;
    bool root_is_good = false;

    void start(std::string_view name, const XmlAttributes& attributes) override {
        ++level_;
        if (level_ == 1) {
            root_is_good = is_root(name);
            if (!root_is_good) stop();
            return;
        }
        if (epsg == 0) {
            if (const std::string_view srs = attributes["srsName"]; !srs.empty()) epsg = epsg_of(srs);
        }
        if (feature_level_ > 0) return;
        if (level_ == 2 && name == "name") collect_text();
        if (in_membership_) {
            if (!is_root(name)) feature_level_ = level_;
            return;
        }
        if (appearance_level_ == 0 && is_membership(name)) in_membership_ = true;
        if (appearance_level_ == 0 && name == "Appearance") appearance_level_ = level_;
        if (appearance_level_ > 0 && appearance_parser.start(name, attributes)) collect_text();
    }

    void end(std::string_view name) override {
        if (appearance_level_ > 0) {
            appearance_parser.end(name, text(), appearance);
            if (appearance.size() > kMostAppearance) refuse("appearance of the model is too large");
        }
        if (level_ == 2 && name == "name" && title.empty()) title = text();
        if (level_ == feature_level_) feature_level_ = 0;
        if (level_ == appearance_level_) appearance_level_ = 0;
        if (feature_level_ == 0 && is_membership(name)) in_membership_ = false;
        --level_;
    }

  private:
    size_t level_ = 0, feature_level_ = 0, appearance_level_ = 0;
    bool in_membership_ = false;
};

/// Second reading: the features, one at a time.
class FeatureScan : public XmlHandler {
  public:
    FeatureScan(CityReading& reading, const std::string& file, const GmlAppearance& model)
        : reading_(reading), model_(model), parser_(feature_), drawer_(reading, file) {}

    const std::map<std::string, uint64_t>& unsupported() const { return parser_.unsupported(); }
    uint64_t unsupported_appearance() const { return appearance_parser_.unsupported(); }

    void start(std::string_view name, const XmlAttributes& attributes) override {
        ++level_;
        if (!parser_.inside()) {
            if (!in_membership_) {
                in_membership_ = is_membership(name) && level_ > 1;
                return;
            }
            parser_.begin_feature();
            own_.clear();
        }
        if (appearance_level_ == 0 && name == "Appearance" && parser_.inside()) appearance_level_ = level_;
        if (appearance_level_ > 0) {
            if (appearance_parser_.start(name, attributes)) collect_text();
        } else if (parser_.start(name, attributes, line())) {
            collect_text();
        }
        if (parser_.too_large() || own_.size() > kMostAppearance) refuse("a single feature is too large");
    }

    void end(std::string_view name) override {
        if (appearance_level_ > 0) {
            appearance_parser_.end(name, text(), own_);
            if (level_ == appearance_level_) appearance_level_ = 0;
        } else if (parser_.inside()) {
            parser_.end(name, text());
            if (!parser_.inside()) finish_feature();
        } else if (is_membership(name)) {
            in_membership_ = false;
        }
        --level_;
    }

  private:
    void finish_feature() {
        drawer_.draw(feature_, own_, model_);
        if (reading_.stopped()) stop();
    }

    CityReading& reading_;
    const GmlAppearance& model_;
    GmlFeature feature_;
    GmlAppearance own_;
    GmlFeatureParser parser_;
    GmlAppearanceParser appearance_parser_;
    GmlDrawer drawer_;
    size_t level_ = 0, appearance_level_ = 0;
    bool in_membership_ = false;
};

void report_unsupported(CityReading& reading, const std::string& file, const std::map<std::string, uint64_t>& counts,
                        uint64_t appearance) {
    for (const auto& [what, count] : counts) {
        reading.report.add(
            {.feature = file, .what = fmt::format("not supported: {} ({} times)", what, count), .where = file});
    }
    if (appearance == 0) return;
    reading.report.add(
        {.feature = file,
         .what = fmt::format("not supported: generated or georeferenced texture coordinates ({} times)", appearance),
         .where = file});
}

}  // namespace

Status read_citygml(TextSource& source, CityReading& reading) {
    const std::string& file = source.name();
    ModelScan model;
    // A fault here comes up again below, after the features before it have been sent.
    auto scanned = parse_xml(source, model, [&] { reading.tell_progress(source.stored_bytes_done() / 2); });
    if (!model.root_is_good) {
        return scanned
                   ? Status(Error{file + ": XML, but no CityGML (its root is neither CityModel nor FeatureCollection)"})
                   : scanned;
    }
    if (auto status = reading.agree_on_crs(model.epsg, file); !status) return status;
    if (reading.header.title.empty()) reading.header.title = model.title;
    const uint64_t half = source.stored_bytes_total() / 2;
    if (auto status = source.rewind(); !status) return status;
    FeatureScan features(reading, file, model.appearance);
    auto status = parse_xml(source, features, [&] { reading.tell_progress(half + source.stored_bytes_done() / 2); });
    report_unsupported(reading, file, features.unsupported(),
                       model.appearance_parser.unsupported() + features.unsupported_appearance());
    return status;
}

}  // namespace citystream::tiles::city

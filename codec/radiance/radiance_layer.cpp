#include "codec/radiance/radiance_layer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <unordered_map>
#include <utility>

#include "codec/radiance/place_wire.h"
#include "codec/radiance/radiance_layer_layout.h"
#include "codec/radiance/radiance_resident.h"
#include "codec/radiance/transfer.h"
#include "codec/radiance/visibility_wire.h"
#include "codec/stop.h"

namespace citystream::codec::radiance {

namespace {

using Steps = std::span<const std::span<const std::byte>>;

/// Of the first step: bake hash, log2 of the spacing and transport, local side, bytes of the places; then these and the
/// visibility or the matrix.
constexpr size_t kHashBytes = 8, kSpacingAt = 8, kLocalSideAt = 9, kPlacesAt = 10, kHeadBytes = 14;
constexpr uint32_t kSpacingBits = 5;
constexpr uint64_t kMostRows = 1 << 24;
/// More than a layer can take.
constexpr uint64_t kAnyBytes = uint64_t{1} << 40;

void put_number(std::vector<std::byte>& bytes, uint64_t number, size_t count) {
    for (size_t i = 0; i < count; ++i) bytes.push_back(static_cast<std::byte>(number >> 8 * i));
}

uint64_t get_number(std::span<const std::byte> bytes, size_t at, size_t count) {
    uint64_t number = 0;
    for (size_t i = 0; i < count; ++i) number |= std::to_integer<uint64_t>(bytes[at + i]) << 8 * i;
    return number;
}

/// Numbers the frames of places by their first use.
void set_frames(VisibilityTile& tile, std::span<const ReceiverPlace> places) {
    std::unordered_map<uint32_t, uint32_t> known;
    tile.frame_of.reserve(places.size());
    for (const ReceiverPlace& place : places) {
        const uint32_t key = place.surface_class << 16 | uint32_t{static_cast<uint8_t>(place.tilt[0])} << 8 |
                             static_cast<uint8_t>(place.tilt[1]);
        const auto [at, is_new] = known.emplace(key, static_cast<uint32_t>(tile.frames.size()));
        if (is_new) tile.frames.push_back(frame_of_place(place));
        tile.frame_of.push_back(at->second);
    }
}

/// Words that write_receiver_table would make.
uint64_t table_words(std::span<const ReceiverPlace> places) {
    uint64_t words = RECEIVER_HEADER_WORDS + places.size();
    for (size_t first = 0, i = 1; i <= places.size(); ++i) {
        const ReceiverPlace &last = places[i - 1], &begin = places[first];
        const bool same_class = i < places.size() && places[i].surface_class == begin.surface_class;
        if (same_class && places[i].column[1] == begin.column[1]) continue;
        words += (static_cast<uint64_t>(last.column[0] - begin.column[0]) + 3) / 2;
        const int32_t rows = same_class ? places[i].column[1] - begin.column[1] : 1;
        words += static_cast<uint64_t>(rows) * RECEIVER_ROW_WORDS;
        first = i;
    }
    return words;
}

/// What the first steps hold: the tile without its bits, and where they, or the matrix, are.
struct Prefix {
    RadianceTile tile;
    uint32_t local_side = 0;
    RadianceTransport transport = RadianceTransport::kVisibility;
    std::vector<std::span<const std::byte>> messages;
    std::vector<uint32_t> table;
    RadianceLimits limits;
};

Result<Prefix> read_prefix(Steps steps, uint64_t decoded_bytes) {
    if (steps.empty() || steps.size() > kVisibilitySteps) return Error{"a radiance layer has 1 to 3 steps"};
    const auto first = steps[0];
    if (first.size() < kHeadBytes) return Error{"a radiance layer's first step is shorter than its head", first.size()};
    const auto transport = read_radiance_transport(first);
    if (!transport) return transport.error();
    Prefix prefix;
    prefix.transport = *transport;
    if (prefix.transport != RadianceTransport::kVisibility && steps.size() != 1)
        return Error{"a radiance layer of " + std::string(name_of(prefix.transport)) + " has one step"};
    prefix.tile.spacing_log2 = std::to_integer<uint32_t>(first[kSpacingAt]) % (1 << kSpacingBits);
    prefix.local_side = std::to_integer<uint32_t>(first[kLocalSideAt]);
    if (prefix.tile.spacing_log2 < RECEIVER_LEAST_SPACING || prefix.tile.spacing_log2 > RECEIVER_MOST_SPACING)
        return Error{"a radiance layer's spacing of 2^" + std::to_string(prefix.tile.spacing_log2), kSpacingAt};
    if (prefix.local_side < 1 || prefix.local_side > kMostLocalSide)
        return Error{"a radiance layer's local directions: " + std::to_string(prefix.local_side) + " on a side",
                     kLocalSideAt};
    const uint64_t place_bytes = get_number(first, kPlacesAt, kHeadBytes - kPlacesAt);
    if (place_bytes > first.size() - kHeadBytes) return Error{"a radiance layer's places end behind it", kPlacesAt};
    constexpr uint64_t kFixedWords = RECEIVER_HEADER_WORDS + RADIANCE_HEADER_WORDS;
    const uint64_t words = decoded_bytes / sizeof(uint32_t);
    if (words < kFixedWords) return Error{"a radiance layer of too few decoded bytes"};
    const uint64_t locals = uint64_t{prefix.local_side} * prefix.local_side;
    prefix.limits.receivers = static_cast<uint32_t>(
        std::min({(words - kFixedWords) / (1 + IRRADIANCE_WORDS), kMostRows / locals, uint64_t{RECEIVER_MOST}}));
    prefix.limits.entries = ~uint64_t{0};
    auto places =
        decode_places(first.subspan(kHeadBytes, place_bytes), prefix.tile.spacing_log2, prefix.limits.receivers);
    if (!places) return Error{places.error().message, places.error().offset + kHeadBytes};
    prefix.tile.places = std::move(*places);
    if (table_words(prefix.tile.places) > words) return Error{"a radiance layer's receivers take more than its bytes"};
    auto table = write_receiver_table(prefix.tile.places, prefix.tile.spacing_log2);
    if (!table) return table.error();
    prefix.table = std::move(*table);
    set_frames(prefix.tile.visibility, prefix.tile.places);
    prefix.messages.assign(steps.begin(), steps.end());
    prefix.messages[0] = first.subspan(kHeadBytes + place_bytes);
    return prefix;
}

/// The rows of visibility that travelled. No more entries than fit into so many words.
Result<DistinctRows> rows_of_visibility(const Prefix& prefix, const LocalDirections& local, uint64_t words,
                                        const std::atomic<bool>* stop) {
    const auto side = visibility_side(prefix.messages[0]);
    if (!side) return side.error();
    const VisibilityTile& tile = prefix.tile.visibility;
    DistinctRowMaker rows(*side, local);
    const uint64_t most = most_entries(words, texel_count(*side));
    bool fits = true;
    const Status status =
        visit_visibility(tile, prefix.messages, [&](uint32_t receiver, std::span<const uint32_t> bits) {
            const uint32_t frame = tile.frame_of[receiver];
            rows.add(frame, tile.frames[frame], bits);
            fits = rows.nonzeros() <= most;
            return fits && !is_stopped(stop);
        });
    if (is_stopped(stop)) return stopped_error();
    if (!status) return status.error();
    if (!fits) return Error{"a radiance layer's rows take more than its decoded bytes"};
    return rows.take();
}

/// The matrix of a prefix in at most so many words.
Result<std::vector<uint32_t>> matrix_words(const Prefix& prefix, uint64_t words, const MatrixOptions& options,
                                           MatrixLoss* loss) {
    const LocalDirections local(prefix.local_side);
    const auto receivers = static_cast<uint32_t>(prefix.tile.places.size());
    const MatrixBounds bounds{receivers, local.count(), words};
    if (prefix.transport == RadianceTransport::kBiclusters && options.form == MatrixForm::kBiclusters &&
        options.row_error <= 0) {
        const auto clustered = decode_matrix_clusters(prefix.messages[0], bounds);
        if (!clustered) return clustered.error();
        if (loss != nullptr) *loss = {};
        return make_resident_radiance(clustered->clusters, clustered->row_of, local.count());
    }
    auto distinct = prefix.transport == RadianceTransport::kVisibility
                        ? rows_of_visibility(prefix, local, words, options.stop)
                        : decode_matrix_rows(prefix.transport, prefix.messages[0], bounds);
    if (!distinct) return distinct.error();
    return make_matrix_words(std::move(*distinct), local.count(), options, loss);
}

Result<std::vector<uint32_t>> words_of(const Prefix& prefix, uint64_t decoded_bytes, const MatrixOptions& options,
                                       MatrixLoss* loss) {
    const uint64_t most = decoded_bytes / sizeof(uint32_t);
    const auto matrix = matrix_words(prefix, most, options, loss);
    if (!matrix) return matrix.error();
    if (matrix->empty() && is_stopped(options.stop)) return stopped_error();
    if (matrix->empty()) return Error{"a radiance layer's matrix is larger than it can be"};
    std::vector<uint32_t> words = prefix.table;
    words.resize(words.size() + IRRADIANCE_WORDS * prefix.tile.places.size(), 0);
    words.insert(words.end(), matrix->begin(), matrix->end());
    if (words.size() > most)
        return Error{"a radiance layer of " + std::to_string(sizeof(uint32_t) * words.size()) + " bytes, not " +
                     std::to_string(decoded_bytes)};
    return words;
}

Status check_tile(const RadianceTile& tile, uint32_t local_side) {
    const VisibilityTile& visibility = tile.visibility;
    if (local_side < 1 || local_side > kMostLocalSide || visibility.side < 1 || visibility.side > kMostCubeSide)
        return Error{"a radiance layer of directions that cannot be"};
    if (visibility.receivers() != tile.places.size() ||
        visibility.words.size() != size_t{visibility.receivers()} * visibility.words_a_receiver())
        return Error{"a radiance layer's visibility is not that of its receivers"};
    if (tile.places.size() * local_side * local_side > kMostRows)
        return Error{"a radiance layer of " + std::to_string(tile.places.size()) + " receivers with " +
                     std::to_string(local_side * local_side) + " local directions each"};
    for (size_t i = 0; i < tile.places.size(); ++i) {
        if (std::abs(int64_t{tile.places[i].depth}) > kMostDepth)
            return Error{"a radiance layer's receiver " + std::to_string(i) + " is too far away"};
        const uint32_t frame = visibility.frame_of[i];
        if (frame >= visibility.frames.size() || visibility.frames[frame] != frame_of_place(tile.places[i]))
            return Error{"a radiance layer's receiver " + std::to_string(i) + " has a frame that is not its place's"};
    }
    return Done{};
}

/// What stands behind the places, step by step.
struct Message {
    std::vector<std::byte> bytes;
    float error = 0;
};

Result<std::vector<Message>> encode_messages(const VisibilityTile& tile, uint32_t local_side,
                                             RadianceTransport transport) {
    std::vector<Message> messages;
    if (transport == RadianceTransport::kVisibility) {
        for (VisibilityStep& step : encode_visibility(tile)) messages.push_back({std::move(step.bytes), step.error});
        return messages;
    }
    const LocalDirections local(local_side);
    if (uint64_t{tile.receivers()} * local.count() >= kMostRows)
        return Error{"a radiance layer of too many rows to travel as " + std::string(name_of(transport))};
    DistinctRowMaker rows(tile.side, local);
    for (uint32_t r = 0; r < tile.receivers(); ++r)
        rows.add(tile.frame_of[r], tile.frames[tile.frame_of[r]], tile.of(r));
    messages.push_back({encode_matrix(transport, rows.take(), local.count())});
    return messages;
}

}  // namespace

uint32_t frame_of_place(const ReceiverPlace& place) {
    const uint32_t own = place.surface_class / 2;
    const double a = place.tilt[0], b = place.tilt[1],
                 one = place.surface_class % 2 == 0 ? RECEIVER_TILT_ONE : -RECEIVER_TILT_ONE;
    std::array<double, 3> normal{};
    normal[own] = one;
    normal[(own + 1) % 3] = a;
    normal[(own + 2) % 3] = b;
    const double length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    return pack_frame({normal[0] / length, normal[1] / length, normal[2] / length});
}

Result<std::vector<RadianceLayerStep>> encode_radiance_layer(const RadianceTile& tile, uint32_t local_side,
                                                             uint64_t bake_hash, double bits_error,
                                                             RadianceTransport transport) {
    if (const Status good = check_tile(tile, local_side); !good) return good.error();
    if (const auto table = write_receiver_table(tile.places, tile.spacing_log2); !table) return table.error();
    const std::vector<std::byte> places = encode_places(tile.places, tile.spacing_log2);
    std::vector<std::byte> head;
    put_number(head, bake_hash, kHashBytes);
    put_number(head, tile.spacing_log2 | static_cast<uint32_t>(transport) << kSpacingBits, 1);
    put_number(head, local_side, 1);
    put_number(head, places.size(), kHeadBytes - kPlacesAt);
    head.insert(head.end(), places.begin(), places.end());

    const auto messages = encode_messages(tile.visibility, local_side, transport);
    if (!messages) return messages.error();
    std::vector<RadianceLayerStep> steps;
    std::vector<std::span<const std::byte>> wires;
    uint64_t told = 0;
    for (const Message& message : *messages) {
        RadianceLayerStep& step = steps.emplace_back();
        step.wire = std::exchange(head, {});
        step.wire.insert(step.wire.end(), message.bytes.begin(), message.bytes.end());
        // A directory has no steps without bytes; the coder reads zeros behind its end anyway.
        if (step.wire.empty()) step.wire.push_back(std::byte{0});
        step.error = message.error + static_cast<float>(bits_error);
    }
    for (RadianceLayerStep& step : steps) {
        wires.emplace_back(step.wire);
        auto words = decode_radiance_layer(wires, kAnyBytes, MatrixForm::kRows);
        if (!words) return words.error();
        const uint64_t bytes = std::max<uint64_t>(sizeof(uint32_t) * words->size(), told);
        if (bytes > ~uint32_t{0}) return Error{"a radiance layer of more than 4 GiB"};
        step.decoded_bytes = static_cast<uint32_t>(bytes - told);
        told = bytes;
    }
    return steps;
}

Result<uint64_t> read_bake_hash(std::span<const std::byte> first_step) {
    if (first_step.size() < kHeadBytes)
        return Error{"a radiance layer's first step is shorter than its head", first_step.size()};
    return get_number(first_step, 0, kHashBytes);
}

Result<RadianceTransport> read_radiance_transport(std::span<const std::byte> first_step) {
    if (first_step.size() < kHeadBytes)
        return Error{"a radiance layer's first step is shorter than its head", first_step.size()};
    const uint32_t transport = std::to_integer<uint32_t>(first_step[kSpacingAt]) >> kSpacingBits;
    if (transport >= kRadianceTransportNames.size())
        return Error{"a radiance layer with a transport of another version", kSpacingAt};
    return static_cast<RadianceTransport>(transport);
}

Result<uint32_t> read_receiver_count(std::span<const std::byte> first_step, uint64_t decoded_bytes) {
    const auto prefix = read_prefix({&first_step, 1}, decoded_bytes);
    if (!prefix) return prefix.error();
    return static_cast<uint32_t>(prefix->tile.places.size());
}

Result<RadianceTile> decode_radiance_tile(Steps steps, uint64_t decoded_bytes) {
    auto prefix = read_prefix(steps, decoded_bytes);
    if (!prefix) return prefix.error();
    if (prefix->transport != RadianceTransport::kVisibility)
        return Error{"a radiance layer of " + std::string(name_of(prefix->transport)) + " has no visibility bits"};
    auto visibility = decode_visibility(std::move(prefix->tile.visibility), prefix->messages, prefix->limits);
    if (!visibility) return visibility.error();
    prefix->tile.visibility = std::move(*visibility);
    return std::move(prefix->tile);
}

Result<std::vector<uint32_t>> decode_radiance_layer(Steps steps, uint64_t decoded_bytes, const MatrixOptions& options,
                                                    MatrixLoss* loss) {
    if (is_stopped(options.stop)) return stopped_error();
    auto prefix = read_prefix(steps, decoded_bytes);
    if (!prefix) return prefix.error();
    return words_of(*prefix, decoded_bytes, options, loss);
}

Result<RadianceLayerShape> radiance_layer_shape(std::span<const uint32_t> table_header, uint64_t words) {
    if (table_header.size() < RECEIVER_HEADER_WORDS) return Error{"a radiance layer shorter than its header", 0};
    if (table_header[RECEIVER_WORD_MAGIC] != RECEIVER_MAGIC) return Error{"not a radiance layer", 0};
    RadianceLayerShape shape;
    shape.receivers = table_header[RECEIVER_WORD_COUNT];
    const uint64_t irradiance = uint64_t{table_header[RECEIVER_WORD_ENTRIES]} + shape.receivers;
    const uint64_t matrix = irradiance + uint64_t{IRRADIANCE_WORDS} * shape.receivers;
    if (shape.receivers > RECEIVER_MOST || words > ~uint32_t{0} || matrix + RADIANCE_HEADER_WORDS > words)
        return Error{"a radiance layer's parts end behind it", RECEIVER_WORD_ENTRIES * sizeof(uint32_t)};
    shape.irradiance_word = static_cast<uint32_t>(irradiance);
    shape.matrix_word = static_cast<uint32_t>(matrix);
    return shape;
}

Result<RadianceLayerView> RadianceLayerView::create(std::span<const uint32_t> words) {
    const auto shape = radiance_layer_shape(words, words.size());
    if (!shape) return shape.error();
    RadianceLayerView view;
    view.words_ = words;
    view.shape_ = *shape;
    if (const auto table = ReceiverTableView::create(view.table()); !table) return table.error();
    const auto matrix = ResidentRadianceView::create(view.matrix());
    if (!matrix)
        return Error{matrix.error().message, matrix.error().offset + sizeof(uint32_t) * uint64_t{shape->matrix_word}};
    if (matrix->receivers() != view.receivers())
        return Error{"a radiance layer's matrix is not that of its receivers",
                     sizeof(uint32_t) * (uint64_t{shape->matrix_word} + RADIANCE_WORD_RECEIVERS)};
    return view;
}

}  // namespace citystream::codec::radiance

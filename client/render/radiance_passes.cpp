#include "client/render/radiance_passes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "codec/radiance/irradiance.h"
#include "codec/radiance/local_light.h"
#include "codec/radiance/radiance_resident.h"
#include "shaders/radiance_clusters.comp.h"
#include "shaders/radiance_local.comp.h"
#include "shaders/radiance_receivers.comp.h"
#include "shaders/radiance_rows.comp.h"

namespace citystream::client {
namespace {

constexpr uint64_t kSumBytes = RADIANCE_SUM_WORDS * sizeof(uint32_t);
/// Sums of a batch are numbered in words by 32 bits.
constexpr uint64_t kMostSums = (uint64_t{1} << 32) / RADIANCE_SUM_WORDS - 1;

uint32_t groups_of(uint32_t items) {
    return items / RADIANCE_PASS_GROUP + (items % RADIANCE_PASS_GROUP != 0 ? 1 : 0);
}

std::array<uint32_t, RADIANCE_PASSES> items_of(const RadianceJob& job) {
    return {job.clusters, job.rows, job.receivers, job.local_receivers * LOCAL_LIGHT_DIRECTIONS};
}

void split(VkDeviceAddress address, uint (&words)[2]) {
    std::memcpy(words, &address, sizeof words);
}

void reserve(const Device& device, Buffer& buffer, uint64_t bytes, BufferPlace place) {
    if (buffer.bytes >= bytes) return;
    destroy_buffer(device, buffer);
    buffer = create_buffer(device, bytes, place);
}

/// Texel by texel x, y and z.
void append_vectors(std::vector<uint32_t>& words, const codec::radiance::LightVectors& vectors) {
    for (size_t k = 0; k < vectors[0].size(); ++k) {
        for (const auto& axis : vectors) words.insert(words.end(), axis[k].begin(), axis[k].end());
    }
}

/// Whether a layer can have so many local directions.
bool is_square_of_directions(uint32_t locals) {
    for (uint32_t side = 1; side <= codec::radiance::kMostLocalSide; ++side) {
        if (side * side == locals) return true;
    }
    return false;
}

RadianceJob job_of(const codec::radiance::RadianceLayerShape& shape, std::span<const uint32_t> matrix) {
    RadianceJob job{};
    job.irradiance_word = shape.irradiance_word;
    job.receivers = shape.receivers;
    job.locals = matrix[RADIANCE_WORD_LOCALS];
    job.columns = matrix[RADIANCE_WORD_COLUMNS];
    job.rows = matrix[RADIANCE_WORD_ROWS];
    job.clusters = matrix[RADIANCE_WORD_CLUSTERS];
    job.terms = matrix[RADIANCE_WORD_TERMS];
    job.links = matrix[RADIANCE_WORD_LINKS];
    job.term_starts = shape.matrix_word + matrix[RADIANCE_WORD_TERM_STARTS];
    job.link_starts = shape.matrix_word + matrix[RADIANCE_WORD_LINK_STARTS];
    job.term_fields = shape.matrix_word + matrix[RADIANCE_WORD_TERM_FIELDS];
    job.link_fields = shape.matrix_word + matrix[RADIANCE_WORD_LINK_FIELDS];
    job.row_fields = shape.matrix_word + matrix[RADIANCE_WORD_ROW_FIELDS];
    job.bits = matrix[RADIANCE_WORD_BITS];
    job.start_bits = matrix[RADIANCE_WORD_START_BITS];
    return job;
}

}  // namespace

RadiancePasses::RadiancePasses(const Device& device, SlotPool& pool, uint64_t sum_bytes)
    : device_(device), pool_(pool), sum_bytes_(sum_bytes), pages_(device, pool) {}

RadiancePasses::~RadiancePasses() {
    for (auto& [layer, known] : known_) drop_local(known);
    for (Pass& pass : passes_) destroy_pass(device_, pass);
    for (Buffer* buffer : {&light_buffer_, &job_buffer_, &sum_buffer_}) destroy_buffer(device_, *buffer);
}

void RadiancePasses::set_light(const FrameLight& light) {
    if (number_ == light.number) return;
    number_ = light.number;
    light_is_uploaded_ = false;
    light_.clear();
    const size_t texels = light.sky.values.size();
    if (directions_.size() != texels)
        directions_ = codec::radiance::texel_directions(codec::radiance::texels_across_of(texels));
    if (directions_.size() == texels) append_vectors(light_, codec::radiance::light_vectors(light.sky, directions_));
    unit_ = codec::radiance::irradiance_unit(light.sky);
}

RadiancePasses::Known RadiancePasses::read_header(LayerId layer) const {
    Known known;
    known.words = pool_.layers[layer].words;
    const auto shape =
        codec::radiance::radiance_layer_shape(read_words(pool_, layer, RECEIVER_HEADER_WORDS), known.words);
    if (!shape) return known;
    const auto matrix = read_words(pool_, layer, RADIANCE_HEADER_WORDS, shape->matrix_word);
    if (!codec::radiance::check_resident_header(matrix, known.words - shape->matrix_word)) return known;
    known.job = job_of(*shape, matrix);
    const RadianceJob& job = known.job;
    // Every row is some receiver's, and where there are links or rows there is what they name.
    known.usable = matrix[RADIANCE_WORD_RECEIVERS] == shape->receivers && is_square_of_directions(job.locals) &&
                   job.columns > 0 && job.rows <= job.receivers * job.locals && (job.rows > 0 || job.receivers == 0) &&
                   (job.clusters > 0 || job.links == 0) && job.clusters <= job.links && known.sums() <= kMostSums;
    if (known.usable && job.locals == LOCAL_LIGHT_DIRECTIONS) {
        // The row tables lie before the receivers.
        const uint64_t rows_end = shape->irradiance_word - shape->receivers;
        known.walls = codec::radiance::wall_receivers(read_words(pool_, layer, rows_end));
    }
    return known;
}

bool RadiancePasses::is_for_light(const Known& known) const {
    return known.usable && uint64_t{known.job.columns} * RADIANCE_SUM_WORDS == light_.size();
}

// Words of local light take slots of the pool, where there is room.
void RadiancePasses::ensure_local(Known& known) {
    if (known.local != kNoLayer || known.walls == 0) return;
    const LayerId layer = create_layer(pool_);
    if (!move_layer(pool_, layer, uint64_t{known.walls} * LOCAL_LIGHT_DIRECTIONS)) {
        destroy_layer(pool_, layer);
        return;
    }
    known.local = layer;
    known.local_is_lit = false;
    local_slots_ += pool_.layers[layer].slots.size();
}

void RadiancePasses::drop_local(Known& known) {
    if (known.local == kNoLayer) return;
    local_slots_ -= pool_.layers[known.local].slots.size();
    destroy_layer(pool_, known.local);
    known.local = kNoLayer;
}

void RadiancePasses::make_room(uint64_t slots) {
    for (auto& [layer, known] : known_) {
        if (free_slots(pool_) >= slots) return;
        drop_local(known);
    }
}

LayerId RadiancePasses::local_light(LayerId layer) const {
    const auto found = known_.find(layer);
    if (found == known_.end()) return kNoLayer;
    const Known& known = found->second;
    const bool is_planned = std::ranges::find(todo_, layer) != todo_.end();
    return known.local_is_lit || is_planned ? known.local : kNoLayer;
}

uint32_t RadiancePasses::local_receivers(LayerId layer) const {
    const auto found = known_.find(layer);
    return found == known_.end() ? 0 : found->second.walls;
}

Status RadiancePasses::plan(std::span<const LayerId> layers, std::span<const LayerId> with_local) {
    todo_.clear();
    counts_ = {};
    if (!number_) return Done{};
    for (const LayerId layer : layers) {
        if (!is_live(pool_, layer)) return Error{"a radiance layer that does not exist cannot be lit"};
        Known& known = known_[layer];
        if (known.words != pool_.layers[layer].words) {
            drop_local(known);
            known = read_header(layer);
        }
        if (!is_for_light(known)) {
            ++counts_.unlit;
            continue;
        }
        const bool wants_local = std::ranges::find(with_local, layer) != with_local.end();
        if (wants_local) ensure_local(known);
        if (known.lit != number_) known.local_is_lit = false;
        const bool makes_local = wants_local && known.local != kNoLayer && !known.local_is_lit;
        if (known.lit == number_ && !makes_local) continue;
        known.job.local_receivers = makes_local ? known.walls : 0;
        todo_.push_back(layer);
        ++counts_.tiles;
        counts_.receivers += known.job.receivers;
        counts_.clusters += known.job.clusters;
        counts_.rows += known.job.rows;
        counts_.local_receivers += known.job.local_receivers;
    }
    return Done{};
}

std::vector<RadiancePasses::Batch> RadiancePasses::batches() const {
    std::vector<Batch> batches;
    uint64_t sums = 0;
    const uint64_t most = std::min(sum_bytes_ / kSumBytes, kMostSums);
    for (size_t i = 0; i < todo_.size(); ++i) {
        const Known& known = known_.at(todo_[i]);
        if (batches.empty() || sums + known.sums() > most) {
            batches.push_back({.first = i, .end = i});
            sums = 0;
        }
        Batch& batch = batches.back();
        batch.end = i + 1;
        sums += known.sums();
        const auto items = items_of(known.job);
        for (size_t pass = 0; pass < RADIANCE_PASSES; ++pass) batch.groups[pass] += groups_of(items[pass]);
    }
    return batches;
}

void RadiancePasses::make_buffers(const std::vector<Batch>& batches) {
    if (!has_pipeline()) {
        passes_[RADIANCE_PASS_CLUSTERS] =
            create_compute_pass(device_, k_radiance_clusters_comp, sizeof(RadiancePassConstants));
        passes_[RADIANCE_PASS_ROWS] = create_compute_pass(device_, k_radiance_rows_comp, sizeof(RadiancePassConstants));
        passes_[RADIANCE_PASS_RECEIVERS] =
            create_compute_pass(device_, k_radiance_receivers_comp, sizeof(RadiancePassConstants));
    }
    if (counts_.local_receivers > 0 && passes_[RADIANCE_PASS_LOCAL].handle == VK_NULL_HANDLE)
        passes_[RADIANCE_PASS_LOCAL] =
            create_compute_pass(device_, k_radiance_local_comp, sizeof(RadiancePassConstants));
    if (!light_is_uploaded_) {
        reserve(device_, light_buffer_, sizeof(uint32_t) * light_.size(), BufferPlace::kUpload);
        std::memcpy(light_buffer_.mapped, light_.data(), sizeof(uint32_t) * light_.size());
        light_is_uploaded_ = true;
    }
    uint64_t most_sums = 1;
    for (const Batch& batch : batches) {
        uint64_t sums = 0;
        for (size_t i = batch.first; i < batch.end; ++i) sums += known_.at(todo_[i]).sums();
        most_sums = std::max(most_sums, sums);
    }
    std::vector<LayerId> referred = todo_;
    for (const LayerId layer : todo_) {
        const LayerId local = known_.at(layer).local;
        if (local != kNoLayer) referred.push_back(local);
    }
    pages_.begin(referred);
    reserve(device_, sum_buffer_, kSumBytes * most_sums, BufferPlace::kDevice);
    const uint64_t job_bytes = sizeof(RadianceJob) * todo_.size();
    if (job_buffer_.bytes < job_bytes)
        reserve(device_, job_buffer_, std::max<uint64_t>(16 << 10, job_bytes + job_bytes / 2), BufferPlace::kUpload);
}

void RadiancePasses::write_jobs(const std::vector<Batch>& batches) {
    auto* const bytes = static_cast<std::byte*>(job_buffer_.mapped);
    for (const Batch& batch : batches) {
        std::array<uint32_t, RADIANCE_PASSES> groups{};
        uint64_t sums = 0;
        for (size_t i = batch.first; i < batch.end; ++i) {
            const Known& known = known_.at(todo_[i]);
            RadianceJob job = known.job;
            split(pages_.reference(todo_[i]), job.layer);
            if (job.local_receivers > 0) split(pages_.reference(known.local), job.local_layer);
            const auto items = items_of(job);
            for (size_t pass = 0; pass < RADIANCE_PASSES; ++pass) {
                job.first_group[pass] = groups[pass];
                groups[pass] += groups_of(items[pass]);
            }
            job.first_sum = static_cast<uint32_t>(sums);
            sums += known.sums();
            std::memcpy(bytes + sizeof(RadianceJob) * i, &job, sizeof job);
        }
    }
}

void RadiancePasses::record_batch(VkCommandBuffer commands, const Batch& batch) const {
    RadiancePassConstants constants{};
    split(job_buffer_.address + sizeof(RadianceJob) * batch.first, constants.jobs);
    split(light_buffer_.address, constants.light);
    split(sum_buffer_.address, constants.sums);
    constants.job_count = static_cast<uint32_t>(batch.end - batch.first);
    for (size_t pass = 0; pass < RADIANCE_PASSES; ++pass) {
        constants.groups = batch.groups[pass];
        if (constants.groups > 0) {
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, passes_[pass].handle);
            vkCmdPushConstants(commands, passes_[pass].layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants,
                               &constants);
            const uint32_t rows = (constants.groups + RADIANCE_PASS_ROW_GROUPS - 1) / RADIANCE_PASS_ROW_GROUPS;
            vkCmdDispatch(commands, std::min<uint32_t>(constants.groups, RADIANCE_PASS_ROW_GROUPS), rows, 1);
        }
        // The next pass reads the sums; that of the next batch writes them anew.
        memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                       VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
    }
}

void RadiancePasses::record(VkCommandBuffer commands) {
    if (todo_.empty()) return;
    const std::vector<Batch> all = batches();
    counts_.batches = all.size();
    make_buffers(all);
    write_jobs(all);
    for (const Batch& batch : all) record_batch(commands, batch);
    memory_barrier(
        commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
        VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT,
        VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT | VK_ACCESS_HOST_READ_BIT | VK_ACCESS_HOST_WRITE_BIT);
}

void RadiancePasses::finish() {
    for (const LayerId layer : todo_) {
        Known& known = known_.at(layer);
        known.lit = number_;
        known.local_is_lit = known.local_is_lit || known.job.local_receivers > 0;
    }
    todo_.clear();
}

void RadiancePasses::forget(LayerId layer) {
    const auto found = known_.find(layer);
    if (found != known_.end()) {
        drop_local(found->second);
        known_.erase(found);
    }
    std::erase(todo_, layer);
}

uint64_t RadiancePasses::buffer_bytes() const {
    return light_buffer_.bytes + job_buffer_.bytes + sum_buffer_.bytes + pages_.bytes();
}

}  // namespace citystream::client

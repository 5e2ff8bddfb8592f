// BTFs made on the device: the CPU's bytes, but for rays that graze; their lookups; and where they lie.
#include "client/render/btf_store.h"

#include <bit>
#include <cmath>
#include <cstdio>

#include "client/render/facade_map_facts.h"
#include "codec/facade/facade_form.h"
#include "shaders/twin_btf.comp.h"
#include "tests/client/render/facade_scene.h"
#include "tests/client/render/gpu_twin.h"
#include "tests/shaders/facade_rays.h"

namespace citystream::client::test {
namespace {

using codec::facade::FacadeForm;
using codec::facade::RunGrid;
using codec::radiance::BtfOptions;
using codec::radiance::BtfView;
using codec::radiance::ReliefMaskView;

/// Steps between numbers of 0..1 in bytes.
constexpr float kStep = 1.0F / 255;

class BtfStoreTest : public GpuTwin {
  protected:
    void TearDown() override {
        store_.reset();
        masks_.reset();
        GpuTwin::TearDown();
    }

    void begin(uint64_t budget_bytes, const BtfOptions& options, const ReliefMaking& making = {}) {
        store_.reset();
        masks_.emplace(device_, pool_, ReliefMaking{making.on_host, 0});
        store_.emplace(device_, pool_, *masks_, budget_bytes, options, making);
    }

    /// Raw maps are cast by the pass that compiles in the least time.
    ReliefMap upload(const RunGrid& grid, FacadeForm form = FacadeForm::kRaw, bool scattered = false) {
        const auto words = codec::facade::encode_form(form, grid);
        EXPECT_TRUE(words.ok());
        const FacadeRenderer renderer = form == FacadeForm::kRaw ? FacadeRenderer::kFdm : FacadeRenderer::kPatch;
        const auto caster = caster_for(renderer, static_cast<uint32_t>(form));
        return {upload_words(*words, scattered), caster.value(), codec::radiance::palette_slots(grid),
                !grid.has_open_cells()};
    }

    void make(std::span<const ReliefMap> maps) {
        ASSERT_TRUE(masks_->plan(maps).ok());
        ASSERT_TRUE(store_->plan(maps).ok());
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            masks_->record(commands);
            store_->record(commands);
        });
        masks_->finish();
        store_->finish();
    }

    /// Back from the device, in a copy of its words.
    std::vector<uint32_t> words_of(const ReliefMap& map, uint64_t count) {
        const uint64_t begin = store_->reference(map.map) - LAYER_REF_DIRECT - store_->buffer().address;
        Buffer& back = host_buffer(4 * count);
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            const VkBufferCopy copy{begin, 0, 4 * count};
            vkCmdCopyBuffer(commands, store_->buffer().handle, back.handle, 1, &copy);
            memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                           VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
        });
        const auto* words = static_cast<const uint32_t*>(back.mapped);
        return {words, words + count};
    }

    std::vector<uint32_t> on_cpu(const RunGrid& grid, const BtfOptions& options) {
        const std::vector<uint32_t> mask = codec::radiance::make_relief_mask(grid);
        return *make_btf(grid, *ReliefMaskView::create(mask), options);
    }

    std::optional<ReliefMasks> masks_;
    std::optional<BtfStore> store_;
};

struct ByteTally {
    uint64_t bytes = 0, wrong = 0;
    double sum = 0, wanted_sum = 0;

    void add(std::span<const uint32_t> got, std::span<const uint32_t> wanted) {
        for (size_t i = 0; i < 4 * got.size(); ++i) {
            const uint32_t a = got[i / 4] >> 8 * (i % 4) & 255, b = wanted[i / 4] >> 8 * (i % 4) & 255;
            ++bytes;
            wrong += a != b ? 1 : 0;
            sum += a;
            wanted_sum += b;
        }
    }
};

TEST_F(BtfStoreTest, HaveTheBytesOfRaysOnTheCpu) {
    struct Case {
        RunGrid grid;
        FacadeForm form;
        BtfOptions options;
    };
    const std::vector<Case> cases = {{window_facade(true), FacadeForm::kQuotient, {8, 4}},
                                     {shaders_test::random_facade(3, 230, 170, 20), FacadeForm::kTiled, {4, 12}},
                                     {shaders_test::random_facade(4, 150, 260, 14, true), FacadeForm::kTiled, {16, 5}}};
    ByteTally tally;
    for (const Case& facade : cases) {
        store_.reset();
        begin(16 << 20, facade.options);
        const ReliefMap map = upload(facade.grid, facade.form, facade.options.patch == 16);
        make(std::span(&map, 1));
        const std::vector<uint32_t> wanted = on_cpu(facade.grid, facade.options);
        ASSERT_NE(store_->reference(map.map), 0U);
        const std::vector<uint32_t> got = words_of(map, wanted.size());
        const auto view = BtfView::create(got);
        ASSERT_TRUE(view.ok()) << view.error().text();
        const uint32_t head = view->shape().records_word();
        EXPECT_TRUE(std::equal(wanted.begin(), wanted.begin() + head, got.begin()));
        tally.add(std::span(got).subspan(head), std::span(wanted).subspan(head));
    }
    std::printf("{\"bytes\":%llu,\"wrong\":%llu}\n", static_cast<unsigned long long>(tally.bytes),
                static_cast<unsigned long long>(tally.wrong));
    EXPECT_LE(static_cast<double>(tally.wrong), 0.02 * static_cast<double>(tally.bytes));
    EXPECT_NEAR(tally.sum / tally.wanted_sum, 1, 1e-3);
}

TEST_F(BtfStoreTest, AreLookedUpAsOnTheCpu) {
    const RunGrid grid = window_facade(true);
    const std::vector<uint32_t> words = on_cpu(grid, {8, 8});
    const auto btf = BtfView::create(words);
    ASSERT_TRUE(btf.ok());
    Random random;
    constexpr uint32_t kLookups = 2000;
    std::vector<float> in;
    std::vector<uint32_t> input;
    for (uint32_t i = 0; i < kLookups; ++i) {
        in = {static_cast<float>(random.unit()), static_cast<float>(random.unit())};
        for (int k = 0; k < 2; ++k) {
            const double z = random.unit(), turn = random.unit() * 6.2831853, r = std::sqrt(1 - z * z);
            for (const double c : {r * std::cos(turn), r * std::sin(turn), z}) in.push_back(static_cast<float>(c));
        }
        for (const float value : in) input.push_back(std::bit_cast<uint32_t>(value));
        input.push_back(i % 5);
    }
    TwinConstants constants{};
    constants.count = kLookups;
    const auto got = run(k_twin_btf_comp, upload_words(words, true), constants, TWIN_BTF_WORDS, input);
    for (uint32_t i = 0; i < kLookups; ++i) {
        const uint32_t* const from = &input[size_t{i} * TWIN_BTF_INPUT_WORDS];
        const uint32_t* const to = &got[size_t{i} * TWIN_BTF_WORDS];
        const auto number = [&](size_t k) { return std::bit_cast<float>(from[k]); };
        const auto place = btf->place({number(0), number(1)}, {number(2), number(3), number(4)}, from[8]);
        for (uint32_t j = 0; j < BTF_DIRECTIONS; ++j)
            ASSERT_NEAR(std::bit_cast<float>(to[j]), btf->value(place, j), 2e-4) << i << ", " << j;
        const auto shares = btf->slot_shares(place);
        for (uint32_t s = 0; s < BTF_SLOTS; ++s) ASSERT_NEAR(std::bit_cast<float>(to[64 + s]), shares[s], 2e-4) << i;
        ASSERT_NEAR(std::bit_cast<float>(to[80]), btf->coverage(place), 2e-4) << i;
        ASSERT_NEAR(std::bit_cast<float>(to[81]), btf->sun_cosine(place, {number(5), number(6), number(7)}), 1e-3) << i;
        ASSERT_EQ(to[82], btf->slots());
        ASSERT_NEAR(std::bit_cast<float>(to[83]), btf->openness(place), 5e-4) << i;
    }
}

TEST_F(BtfStoreTest, SeveralLieBesideEachOther) {
    const BtfOptions options{8, 4};
    begin(4 << 20, options);
    const std::vector<RunGrid> grids = {window_facade(), shaders_test::random_facade(1, 90, 60, 5),
                                        shaders_test::random_facade(2, 70, 80, 5, true)};
    std::vector<ReliefMap> maps;
    for (const RunGrid& grid : grids) maps.push_back(upload(grid));
    make(maps);
    EXPECT_EQ(store_->counts().btfs, 3U);
    EXPECT_EQ(store_->counts().made, 3U);
    for (size_t i = 0; i < maps.size(); ++i) {
        const std::vector<uint32_t> wanted = on_cpu(grids[i], options);
        const std::vector<uint32_t> got = words_of(maps[i], wanted.size());
        ASSERT_TRUE(BtfView::create(got).ok());
        ByteTally tally;
        tally.add(got, wanted);
        EXPECT_LE(static_cast<double>(tally.wrong), 0.02 * static_cast<double>(tally.bytes)) << i;
    }
    const uint64_t first = store_->reference(maps[0].map);
    make(maps);
    EXPECT_EQ(store_->counts().made, 0U);
    EXPECT_EQ(store_->reference(maps[0].map), first);
}

// The host's rays give the CPU's words; a frame's rays are bounded, and a BTF is there once it is done.
TEST_F(BtfStoreTest, AreMadeInPiecesOfAFramesRays) {
    const BtfOptions options{8, 4};
    constexpr uint64_t kViewRays = 8 * 8 * BTF_RAYS;
    const RunGrid grid = shaders_test::random_facade(2, 70, 80, 5, true);
    const std::vector<uint32_t> wanted = on_cpu(grid, options);
    for (const bool on_host : {false, true}) {
        begin(4 << 20, options, {on_host, 5 * kViewRays});
        if (on_host && !device_.is_cpu) continue;
        const ReliefMap map = upload(grid);
        for (uint32_t frame = 0; frame < 4; ++frame) {
            EXPECT_EQ(store_->reference(map.map), 0U);
            EXPECT_TRUE(store_->is_missing(map.map));
            make(std::span(&map, 1));
            EXPECT_EQ(store_->counts().rays, (frame < 3 ? 5 : 1) * kViewRays);
        }
        ASSERT_NE(store_->reference(map.map), 0U);
        EXPECT_FALSE(store_->is_missing(map.map));
        EXPECT_EQ(store_->has_pipeline(), !on_host);
        const std::vector<uint32_t> got = words_of(map, wanted.size());
        if (on_host) {
            EXPECT_EQ(got, wanted);
        }
        ByteTally tally;
        tally.add(got, wanted);
        EXPECT_LE(static_cast<double>(tally.wrong), 0.02 * static_cast<double>(tally.bytes));
        make(std::span(&map, 1));
        EXPECT_EQ(store_->counts().rays, 0U);
    }
}

TEST_F(BtfStoreTest, TheBudgetHoldsAndUnusedOnesGiveTheirRoom) {
    const BtfOptions options{8, 4};
    const auto shape = codec::radiance::btf_shape(options, false);
    ASSERT_TRUE(shape.ok());
    const uint64_t budget = 2 * (4 * shape->words() + 16);
    begin(budget, options);
    std::vector<ReliefMap> maps;
    for (uint32_t i = 0; i < 3; ++i) maps.push_back(upload(shaders_test::random_facade(i, 60, 60, 3)));
    EXPECT_EQ(store_->buffer_bytes(), 0U);
    EXPECT_FALSE(store_->has_pipeline());
    make(maps);
    EXPECT_TRUE(store_->has_pipeline());
    EXPECT_GE(store_->buffer_bytes(), budget);
    EXPECT_EQ(store_->counts().btfs, 2U);
    EXPECT_EQ(store_->counts().refused, 1U);
    EXPECT_LE(store_->counts().bytes, budget);
    EXPECT_TRUE(store_->is_missing(maps[2].map));
    make(std::span(maps).subspan(1));
    EXPECT_EQ(store_->counts().made, 1U);
    EXPECT_EQ(store_->reference(maps[0].map), 0U);
    EXPECT_NE(store_->reference(maps[2].map), 0U);
    store_->forget(maps[1].map);
    EXPECT_EQ(store_->counts().btfs, 1U);
}

TEST_F(BtfStoreTest, MapsWithoutAMaskHaveNone) {
    begin(4 << 20, {8, 4});
    const ReliefMap map = upload(shaders_test::random_facade(1, 60, 60, 3));
    ASSERT_TRUE(store_->plan(std::span(&map, 1)).ok());
    EXPECT_EQ(store_->reference(map.map), 0U);
    EXPECT_EQ(store_->counts().refused, 1U);
    const ReliefMap missing{kNoLayer};
    EXPECT_FALSE(store_->plan(std::span(&missing, 1)).ok());
}

TEST_F(BtfStoreTest, OpenTexelsCountAsNotCovered) {
    const BtfOptions options{16, 4};
    begin(16 << 20, options);
    const RunGrid grid = window_facade(true);
    const ReliefMap map = upload(grid);
    make(std::span(&map, 1));
    const std::vector<uint32_t> words = words_of(map, on_cpu(grid, options).size());
    const auto btf = BtfView::create(words);
    ASSERT_TRUE(btf.ok());
    // Of 600 x 400 texels 280..360 x 0..240 are open.
    EXPECT_NEAR(btf->coverage(btf->place({320.0F / 600, 100.0F / 400}, {0, 0, 1})), 0, 0.1F);
    EXPECT_NEAR(btf->coverage(btf->place({100.0F / 600, 300.0F / 400}, {0, 0, 1})), 1, kStep);
}

}  // namespace
}  // namespace citystream::client::test

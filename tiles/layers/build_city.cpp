#include "tiles/layers/build_city.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "tiles/layers/city_archive.h"
#include "tiles/layers/flat_ground.h"
#include "tiles/layers/memory_plan.h"
#include "tiles/layers/radiance_stage.h"
#include "tiles/layers/reference_glb.h"
#include "tiles/layers/tile_pipeline.h"

namespace citystream::tiles::layers {
namespace {

uint64_t peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

/// One build from start to end; its members are what the passes share.
class CityBuild {
  public:
    CityBuild(const BuildOptions& options, city::CityReport& report) : options_(options), report_(report) {
        if (options_.dress_seed) dresser_.emplace(*options_.dress_seed, catalog_);
        if (!options_.aerial.empty()) drape_.emplace(options_.aerial, catalog_);
        if (options_.extract_relief) extractor_.emplace(catalog_, ReliefExtractionOptions{});
    }

    Result<BuildSummary> run(const CitySource& source) {
        const auto begin = std::chrono::steady_clock::now();
        if (Status status = open_spools(); !status) return status.error();
        if (Status status = take_objects(source); !status) return status.error();
        clock_.lap("objects");
        if (Status status = build(); !status) return status.error();
        BuildSummary summary;
        summary.manifest = manifest_;
        summary.report = report_;
        summary.archive_bytes = std::filesystem::file_size(options_.output);
        if (reference_) summary.reference_bytes = std::filesystem::file_size(options_.reference);
        summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        summary.stages = clock_.times();
        summary.peak_memory_bytes = peak_memory();
        summary.images = images_;
        summary.tiles_kept_in_charts = tiles_kept_in_charts_;
        if (dresser_) {
            summary.dressing = dresser_->report();
            summary.dressing->hidden_by_neighbours = hidden_facades_;
        }
        if (extractor_ && extractor_->report().buildings > 0) summary.relief = extractor_->report();
        if (radiance_) summary.radiance = radiance_->report();
        return summary;
    }

  private:
    Status open_spools() {
        std::filesystem::path parent = options_.temporary_parent;
        if (parent.empty()) parent = std::filesystem::path(options_.output).parent_path();
        if (parent.empty()) parent = ".";
        auto folder = quadtree::SpoolFolder::create(parent.string());
        if (!folder) return folder.error();
        folder_ = std::move(folder).value();
        auto objects = quadtree::ObjectSpool::create(folder_->path());
        if (!objects) return objects.error();
        objects_ = std::move(objects).value();
        auto layers = quadtree::SpoolFile::create(folder_->path() + "/layers");
        if (!layers) return layers.error();
        layer_spool_ = std::move(layers).value();
        auto content = quadtree::SpoolFile::create(folder_->path() + "/content");
        if (!content) return content.error();
        content_spool_ = std::move(content).value();
        auto facades = quadtree::SpoolFile::create(folder_->path() + "/facades");
        if (!facades) return facades.error();
        facade_spool_ = std::move(facades).value();
        auto charts = quadtree::SpoolFile::create(folder_->path() + "/charts");
        if (!charts) return charts.error();
        chart_spool_ = std::move(charts).value();
        if (options_.reference.empty()) return Done{};
        auto reference = ReferenceWriter::create(options_.reference, folder_->path());
        if (!reference) return reference.error();
        reference_ = std::move(reference).value();
        return Done{};
    }

    bool cancelled() const { return options_.cancel != nullptr && options_.cancel->load(); }

    Status take_objects(const CitySource& source) {
        std::optional<Error> failed;
        Status read = source(header_, catalog_, report_, [&](city::CityObject&& object) {
            if (Status status = take(object); !status) failed = status.error();
            if (cancelled()) failed = Error{"interrupted"};
            return !failed;
        });
        if (failed) return *failed;
        if (!read) return read;
        if (objects_->extent().empty()) return Error{"no object with geometry was found: there is nothing to build"};
        if (!drape_ || !options_.auto_ground || objects_->has_ground()) return Done{};
        city::CityObject ground = flat_ground_of_city(objects_->extent(), catalog_);
        ground_made_to_drape_ = true;
        return take(ground);
    }

    /// Made-up facades are part of the city; extracted ones only another form of what the reference shows as triangles.
    Status take(city::CityObject& object) {
        if (dresser_) dresser_->dress(object);
        if (drape_) drape_->drape(object);
        if (reference_) {
            if (Status status = reference_->add(object); !status) return status;
        }
        if (extractor_) extractor_->extract(object);
        return objects_->add(object, catalog_, report_);
    }

    Status build() {
        const bool made_up_ground = options_.auto_ground && !objects_->has_ground();
        auto tree = quadtree::make_tile_tree(*objects_, tree_options(made_up_ground));
        if (!tree) return tree.error();
        clock_.lap("tree");
        const auto prepared = prepare_city_images();
        if (!prepared) return prepared.error();
        clock_.lap("images");
        const MemoryPlan memory = plan_memory(options_.memory_limit, resident_memory());
        ImageCache images(catalog_, static_cast<size_t>(memory.images), prepared->get());
        FacadePainter facades(catalog_, images, static_cast<size_t>(memory.facades));
        const auto numbers = number_facades(*objects_, catalog_.facade_maps, options_.merge_tolerance_mm);
        if (!numbers) return numbers.error();
        const auto dictionary = encode_facades(*numbers);
        if (!dictionary) return dictionary.error();
        clock_.lap("facades");
        Preview preview(objects_->extent(), images);
        TileWorkshop workshop{
            catalog_, images, facades, *numbers, options_.layers, tree->origin, {options_.rate_distortion}};
        workshop.mesh = options_.mesh;
        ChartDictionary charts;
        if (Status status = prepare_radiance(*tree, memory.work); !status) return status;
        auto tiles = build_tiles({options_, *tree, *objects_, *layer_spool_, *content_spool_, workshop, charts,
                                  *chart_spool_, preview, clock_, memory.work, made_up_ground, radiance_.get()});
        if (!tiles) return tiles.error();
        for (const BuiltTile& tile : *tiles) {
            hidden_facades_ += tile.hidden_facades;
            tiles_kept_in_charts_ += tile.kept_in_charts ? 1 : 0;
        }
        if (radiance_) {
            for (city::Defect& defect : radiance_->take_defects()) report_.add(std::move(defect));
        }
        fill_manifest(*tree, tiles->front().record.bounds, made_up_ground);
        manifest_.build_options += merging_text(*numbers);
        const std::vector<std::byte> picture = preview.encode(folder_->path() + "/preview.png");
        if (Status status = write_city_archive({manifest_, *tree, *tiles, *layer_spool_, *dictionary, *facade_spool_,
                                                charts, *chart_spool_, picture, options_});
            !status)
            return status;
        clock_.lap("archive");
        for (city::Defect& defect : images.take_defects()) report_.add(std::move(defect));
        if (!reference_) return Done{};
        if (made_up_ground) {
            if (Status status = reference_->add(flat_ground_of_city(objects_->extent(), catalog_)); !status)
                return status;
        }
        return reference_->finish(catalog_, facades, objects_->extent(), tree->origin);
    }

    /// Before any tile is made; nothing for a city without images.
    Result<std::unique_ptr<PreparedImages>> prepare_city_images() {
        if (catalog_.images.empty()) return std::unique_ptr<PreparedImages>();
        auto prepared = PreparedImages::create(folder_->path(), catalog_.images.size());
        if (!prepared) return prepared.error();
        const auto uses = find_image_uses(*objects_, catalog_, options_.jobs);
        if (!uses) return uses.error();
        ImagePreparationOptions how;
        if (has_atlas()) how.saliency = options_.saliency;
        how.texel_metres = options_.texture_law.finest;
        how.jobs = options_.jobs;
        how.budget_bytes = options_.memory_limit / 2;  // what an image becomes depends on it, so on nothing else
        how.cancel = options_.cancel;
        how.progress = options_.progress;
        std::vector<city::Defect> defects;
        auto report = prepare_images(catalog_, *uses, how, **prepared, defects);
        if (!report) return report.error();
        for (city::Defect& defect : defects) report_.add(std::move(defect));
        images_ = std::move(report).value();
        return prepared;
    }

    /// Leaves are split so that the lattice of a tile has no more columns than it is meant to.
    quadtree::TreeOptions tree_options(bool made_up_ground) const {
        quadtree::TreeOptions tree{options_.leaf_triangles, made_up_ground};
        if (has_radiance()) tree.widest_leaf_metres = kLatticeColumns * options_.radiance.lattice_metres;
        return tree;
    }

    Status prepare_radiance(const quadtree::TileTree& tree, uint64_t work_bytes) {
        if (!has_radiance()) return Done{};
        auto stage = RadianceStage::create(
            {options_, tree, objects_->extent().lo.z, folder_->path(), *layer_spool_, work_bytes});
        if (!stage) return stage.error();
        radiance_ = std::move(stage).value();
        return Done{};
    }

    bool in_pages() const { return options_.atlas_form == codec::atlas::AtlasForm::kPages; }
    bool has_atlas() const { return options_.layers[static_cast<size_t>(tileset::Layer::kAtlas)]; }
    bool has_radiance() const { return options_.layers[static_cast<size_t>(tileset::Layer::kRadiance)]; }

    /// The dictionary; empty where no tile will name its maps.
    Result<EncodedFacades> encode_facades(const FacadeNumbers& numbers) {
        if (!options_.layers[static_cast<size_t>(tileset::Layer::kFacade)]) return EncodedFacades();
        return EncodedFacades::encode(numbers, catalog_.facade_maps, options_, *facade_spool_);
    }

    std::string merging_text(const FacadeNumbers& numbers) const {
        if (options_.merge_tolerance_mm == 0) return {};
        return fmt::format(" merge-tolerance={}mm ({} maps merged, {} mm apart at most)", options_.merge_tolerance_mm,
                           numbers.merged, numbers.greatest_difference_mm);
    }

    void fill_manifest(const quadtree::TileTree& tree, const tileset::Bounds& drawn, bool made_up_ground) {
        manifest_.title = header_.title;
        manifest_.epsg = header_.epsg;
        manifest_.origin = tree.origin;
        manifest_.root_side_log2 = tree.root_side_log2;
        manifest_.levels = tree.levels();
        const quadtree::GridBox& box = objects_->extent();
        manifest_.extent.min = {to_metres(box.lo.x - tree.origin.x), to_metres(box.lo.y - tree.origin.y),
                                to_metres(box.lo.z)};
        manifest_.extent.max = {to_metres(box.hi.x - tree.origin.x), to_metres(box.hi.y - tree.origin.y),
                                to_metres(box.hi.z)};
        // Skirts hang below the city, and the root's box has to hold them.
        manifest_.extent.min[2] = std::min(manifest_.extent.min[2], drawn.min[2]);
        manifest_.extent.max[2] = std::max(manifest_.extent.max[2], drawn.max[2]);
        double square = 0;
        for (size_t axis = 0; axis < 3; ++axis)
            square += std::pow(manifest_.extent.max[axis] - manifest_.extent.min[axis], 2);
        manifest_.root_geometric_error = std::max(std::sqrt(square), 1.0);
        manifest_.buildings = report_.buildings_emitted;
        manifest_.facades = objects_->facades() - hidden_facades_;
        manifest_.facades_made_up = dresser_ && dresser_->report().facades > 0;
        manifest_.build_options =
            options_.description + (made_up_ground || ground_made_to_drape_ ? " ground=made-up" : "");
        if (drape_) manifest_.build_options += fmt::format(" aerial={}", options_.aerial.size());
        if (options_.saliency.kind != codec::atlas::MetricKind::kNone && has_atlas())
            manifest_.build_options += " saliency=" + codec::atlas::to_string(options_.saliency);
        if (const std::string law = to_string(options_.texture_law); law != to_string(TextureLaw()) && has_atlas())
            manifest_.build_options += " texture-law=" + law;
        if (options_.rate_distortion > 0 && has_atlas())
            manifest_.build_options += fmt::format(" rate-distortion={}", options_.rate_distortion);
        if (in_pages() && has_atlas()) manifest_.build_options += pages_text();
        manifest_.build_options += to_string(options_.mesh);
        if (!has_radiance()) return;
        manifest_.radiance_texels_across = options_.radiance.texels_across;
        manifest_.radiance_local_across = options_.radiance.local_across;
        manifest_.radiance_lattice_metres = options_.radiance.lattice_metres;
        manifest_.build_options += to_string(options_.radiance);
    }

    std::string pages_text() const {
        return fmt::format(" atlas-form=pages page-mips={}{}",
                           options_.page_mips ? std::to_string(*options_.page_mips) : "law",
                           options_.page_shape == codec::atlas::PageShape::kTight ? "" : " page-shape=power-of-two");
    }

    const BuildOptions& options_;
    city::CityReport& report_;
    StageClock clock_;
    city::CityHeader header_;
    city::CityCatalog catalog_;
    std::optional<Dresser> dresser_;
    std::optional<AerialDrape> drape_;
    bool ground_made_to_drape_ = false;
    std::optional<ReliefExtractor> extractor_;
    tileset::Manifest manifest_;
    uint64_t hidden_facades_ = 0, tiles_kept_in_charts_ = 0;
    std::optional<ImagePreparationReport> images_;
    std::unique_ptr<quadtree::SpoolFolder> folder_;  // before the files in it, so that it goes last
    std::unique_ptr<quadtree::ObjectSpool> objects_;
    std::unique_ptr<quadtree::SpoolFile> layer_spool_, content_spool_, facade_spool_, chart_spool_;
    std::unique_ptr<ReferenceWriter> reference_;
    std::unique_ptr<RadianceStage> radiance_;
};

}  // namespace

Result<BuildSummary> build_city(const BuildOptions& options, const CitySource& source, city::CityReport& report) {
    if (options.atlas_form == codec::atlas::AtlasForm::kPages) {
        if (options.shared_charts) return Error{"pages share no charts (their charts lie in the tiles)"};
        if (!options.page_mips && !options.texture_law.levels)
            return Error{"a texture law without levels does not say how many mips pages have"};
        if (options.page_mips > PAGES_MOST_MIPS)
            return Error{fmt::format("pages of {} mips; at most {} are possible", *options.page_mips, PAGES_MOST_MIPS)};
    }
    if (Status good = check_mesh_form(options.mesh); !good) return good.error();
    if (options.layers[static_cast<size_t>(tileset::Layer::kRadiance)]) {
        if (Status good = check_radiance_form(options.radiance); !good) return good.error();
    }
    return CityBuild(options, report).run(source);
}

}  // namespace citystream::tiles::layers

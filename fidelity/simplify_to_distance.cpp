// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "fidelity/budget_search.h"
#include "fidelity/failing_places.h"
#include "fidelity/judge.h"
#include "fidelity/kept_mesh.h"
#include "fidelity/neighbourhood.h"
#include "fidelity/repair.h"
#include "hewer/certify.h"
#include "hewer/error.h"
#include "hewer/measure.h"
#include "hewer/simplify.h"
#include "hewer/topology_limit.h"
#include "ooc/memory_budget.h"
#include "ooc/result_hash.h"

namespace hewer {

namespace {

using fidelity::BudgetSearch;
using fidelity::KeptMesh;

// The first try, as a share of the input's triangles.
constexpr double kFirstShare = 0.05;
constexpr std::uint64_t kLeastTriangles = 4;
constexpr std::uint64_t kLeastFirst = 500;
// Below the bound by this factor: a file's rounding of positions comes on top.
constexpr double kSafety = 0.995;
// Places that are farther than this part of the bound get more of the budget.
constexpr double kFar = 0.7;
constexpr unsigned kFeedbackRounds = 3;
// Of the square of its edge: the area of an equilateral triangle.
constexpr double kTriangleArea = 0.43;

std::string hash_of(const Mesh& mesh) {
    ooc::ResultHash hash;
    for (const Vec3& p : mesh.positions) hash.add(p);
    for (const Triangle& t : mesh.triangles) hash.add(t);
    return hash.hex();
}

/// Progress of a run whose end nobody knows: each try takes a quarter of what is left.
class SearchProgress {
  public:
    explicit SearchProgress(const Hooks& hooks) : hooks_(hooks) {}

    void begin_try() {
        if (n_tries_++ > 0) done_ += kPart * (1 - done_);
    }
    /// For the part of the try from `from` to `to`.
    [[nodiscard]] Hooks hooks(double from, double to) const {
        Hooks hooks = hooks_;
        // What there is to warn of has been said in the first try.
        if (n_tries_ > 1) hooks.on_warning = nullptr;
        if (!hooks_.on_progress) return hooks;
        hooks.on_progress = [=, this](const Progress& progress) {
            Progress whole = progress;
            whole.stage = "try " + std::to_string(n_tries_) + ": " + progress.stage;
            whole.fraction = done_ + kPart * (1 - done_) * (from + (to - from) * progress.fraction);
            whole.elapsed_seconds = elapsed();
            whole.remaining_seconds = -1;
            hooks_.on_progress(whole);
        };
        return hooks;
    }
    [[nodiscard]] double elapsed() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    static constexpr double kPart = 0.25;
    const Hooks& hooks_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    unsigned n_tries_ = 0;
    double done_ = 0;
};

struct Try {
    std::uint64_t budget = 0;
    bool is_repaired = false;
    KeptMesh mesh;
    SimplifyReport report;
};

class Search {
  public:
    Search(const InputPaths& input, const SimplifyOptions& options, const Hooks& hooks)
        : source_(
              open_mesh(input, opening(options),
                        {.on_progress = {}, .on_warning = hooks.on_warning, .stop = hooks.stop})),
          options_(options),
          target_(options.targets.front()),
          limit_(options.memory_bytes != 0 ? options.memory_bytes : ooc::default_memory_limit()),
          progress_(hooks),
          search_(kLeastTriangles,
                  std::max(kLeastFirst,
                           static_cast<std::uint64_t>(
                               kFirstShare * static_cast<double>(source_->info().n_faces))),
                  source_->info().n_faces) {
        if (target_.kind == Target::Kind::Error) set_bound(target_.value);
    }

    /// The best try, with the search in its report.
    std::unique_ptr<Try> run() {
        unsigned n_refused = 0;
        while (const auto budget = search_.next()) {
            try {
                std::unique_ptr<Try> one = try_budget(*budget);
                search_.add(*budget,
                            fidelity::largest_distance(*one->report.lods.front().measured));
                if (search_.best() == one->budget) best_ = std::move(one);
            } catch (const TopologyLimit& limit) {
                // The topology is to stay: what can be met begins higher up.
                if (limit.least_triangles() > source_->info().n_faces || ++n_refused > 2) throw;
                search_.raise_least(limit.least_triangles());
            }
        }
        if (!best_) refuse();
        // As `hewer measure` does, for the report.
        best_->report.lods.front().measured =
            measure(*source_, *best_->mesh.source("result"), measuring(), progress_.hooks(1, 1));
        best_->report.search = steps_;
        // Of the file, whose rounding the safety is for.
        best_->report.lods.front().proven_within /= kSafety;
        if (best_->is_repaired) best_->report.result_hash = hash_of(best_->mesh.mesh());
        best_->report.seconds = source_->opening_seconds() + progress_.elapsed();
        return std::move(best_);
    }

  private:
    void set_bound(double bound) {
        bound_ = kSafety * bound;
        search_.set_bound(bound_);
        options_.feedback_distance = kFar * bound_;
        if (!options_.feedback_rounds && options_.method != Method::Uniform) {
            options_.feedback_rounds = kFeedbackRounds;
        }
    }

    /// A run with this budget, and repairs. Places that fail all the same get more of the budgets
    /// to come.
    std::unique_ptr<Try> try_budget(std::uint64_t budget) {
        std::unique_ptr<Try> one = run_with(budget);
        LodReport& lod = one->report.lods.front();
        const auto note = [&](const LodReport& now) {
            steps_.push_back({now.triangles, fidelity::largest_distance(*now.measured)});
        };
        note(lod);
        const double area = one->report.input.area / static_cast<double>(budget);
        const double spacing = std::sqrt(area / kTriangleArea);
        MeasureOptions besides = measuring();
        besides.memory_bytes -=
            std::min(besides.memory_bytes / 2, fidelity::Neighbourhood::kMostBytes);
        one->is_repaired = fidelity::repair({*source_, besides}, bound_, spacing, one->mesh, lod,
                                            progress_.hooks(0.8, 1), note);
        if (fidelity::largest_distance(*lod.measured) > bound_ &&
            fidelity::fails_in_places(*lod.measured, bound_)) {
            fidelity::focus_on_failures(*lod.measured, bound_, spacing, options_.focus);
        }
        return one;
    }

    std::unique_ptr<Try> run_with(std::uint64_t budget) {
        progress_.begin_try();
        auto one = std::make_unique<Try>();
        one->budget = budget;
        const std::uint64_t kept =
            KeptMesh::kBytesPerTriangle * (budget + (best_ ? best_->budget : 0));
        options_.memory_bytes = limit_ - std::min(limit_ - 1, kept);
        SimplifyOptions options = options_;
        if (budget < source_->info().n_faces) {
            options.targets = {{Target::Kind::Triangles, static_cast<double>(budget)}};
        } else {
            // The input itself, unless the user has chosen otherwise: that is near enough for sure.
            options.targets = {{Target::Kind::Ratio, 1}};
            options.feedback_distance = 0;
            options.feedback_rounds = asked_feedback_;
            options.focus = asked_focus_;
        }
        one->report = simplify(
            *source_, [&](std::size_t) { return one->mesh.sink(); }, options,
            progress_.hooks(0, 0.6));
        const std::unique_ptr<MeshSource> level = one->mesh.source("try");
        MeasureReport& found = one->report.lods.front().measured.emplace(
            judge().look(*level, progress_.hooks(0.6, 0.8)));
        if (bound_ == 0) set_bound(target_.value * found.bounds.diagonal());
        if (fidelity::largest_distance(found) <= bound_ &&
            judge().prove(*level, bound_, found, progress_.hooks(0.8, 1))) {
            one->report.lods.front().proven_within = bound_;
        }
        return one;
    }

    [[nodiscard]] fidelity::Judge judge() { return {*source_, measuring()}; }
    [[nodiscard]] MeasureOptions measuring() const {
        MeasureOptions how;
        how.memory_bytes = options_.memory_bytes;
        how.n_threads = options_.n_threads;
        how.temp_dir = options_.temp_dir;
        how.max_temp_bytes = options_.max_temp_bytes;
        return how;
    }

    [[noreturn]] void refuse() const {
        const auto nearest =
            std::min_element(steps_.begin(), steps_.end(),
                             [](const auto& a, const auto& b) { return a.distance < b.distance; });
        throw InvalidArgument(source_->info().name + ": no level of detail is within " +
                              std::to_string(bound_ / kSafety) +
                              " of it; the nearest of those tried has " +
                              std::to_string(nearest->triangles) + " triangles and is " +
                              std::to_string(nearest->distance) + " away; allow more");
    }

    std::unique_ptr<MeshSource> source_;
    SimplifyOptions options_;
    std::optional<unsigned> asked_feedback_ = options_.feedback_rounds;
    std::vector<FocusBox> asked_focus_ = options_.focus;
    Target target_;
    std::uint64_t limit_;
    SearchProgress progress_;
    BudgetSearch search_;
    double bound_ = 0;
    std::vector<SearchStep> steps_;
    std::unique_ptr<Try> best_;
};

}  // namespace

SimplifyReport simplify_to_distance(const InputPaths& input, const std::filesystem::path& output,
                                    const SimplifyOptions& options, const Hooks& hooks,
                                    bool overwrite) {
    const bool is_error =
        options.targets.size() == 1 && (options.targets[0].kind == Target::Kind::Error ||
                                        options.targets[0].kind == Target::Kind::RelativeError);
    if (!is_error) throw InvalidArgument("simplify_to_distance() takes one target, a distance");
    if (options.file.quantization.kind != Quantization::Kind::None) {
        throw InvalidArgument(
            "quantisation would come on top of the distance that is asked for; leave it out");
    }
    // A bad place for the output costs nothing.
    MeshFileOptions file = options.file;
    file.overwrite = overwrite;
    const std::unique_ptr<MeshSink> sink = create_mesh_file(output, file);
    const std::unique_ptr<Try> best = Search(input, options, hooks).run();
    best->mesh.write(*sink);
    SimplifyReport report = std::move(best->report);
    LodReport& lod = report.lods.front();
    lod.target = options.targets.front();
    lod.path = output.string();
    lod.bytes = sink->bytes_written();
    report.bytes_written = lod.bytes;
    return report;
}

}  // namespace hewer

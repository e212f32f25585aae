// SPDX-License-Identifier: MIT
#include "rsimp/finish.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "ooc/parallel.h"
#include "rsimp/block_collapse.h"
#include "rsimp/box_groups.h"
#include "rsimp/collapse_cut.h"
#include "rsimp/manifold.h"
#include "rsimp/mesh_merge.h"
#include "rsimp/piece_store.h"
#include "rsimp/seams.h"

namespace hewer::rsimp {

namespace {

// A block's mesh while it is made manifold or cut: vertices, faces, and as much again on the way.
constexpr std::uint64_t bytes_to_prepare(std::uint64_t n_vertices, AttributeKinds attributes) {
    return n_vertices * 2 * (sizeof(StoredVertex) + attributes.bytes() + 130);
}

std::uint64_t excess(std::uint64_t have, std::uint64_t most) {
    return have > most ? have - most : 0;
}

}  // namespace

/// One level: blocks, the faces between them, and what came of the level before.
class Finisher::Level {
  public:
    /// The first level.
    Level(Finisher& finisher, const BlockInput& input)
        : finisher_(finisher),
          input_(&input),
          counts_(input.counts()),
          block_vertices_(finisher.block_vertices_),
          attributes_(input.attributes()) {
        group();
        ooc::Spool<Face> crossing(finisher_.context_, "faces between blocks");
        finisher_.context_.workers().in_order(
            n_blocks(), finisher_.context_.n_threads(),
            [&](std::uint64_t b) { return input.crossing(first_box_[b], first_box_[b + 1]); },
            [&](std::uint64_t, const std::vector<Face>& faces) { crossing.append(faces); });
        seams_ = std::make_unique<Seams>(
            finisher_.context_,
            settle_crossing(finisher_.context_, std::move(crossing), finisher_.kind_.is_closed),
            ranges_);
    }

    /// What is left after `before`.
    Level(Finisher& finisher, Level& before)
        : finisher_(finisher),
          counts_(std::move(before.next_counts_)),
          rims_(std::move(before.next_rims_)),
          rim_boxes_(std::move(before.first_box_)),
          block_vertices_(before.block_vertices_),
          attributes_(before.attributes_) {
        group();
        // Rims that hardly shrink would go on for ever.
        while (n_blocks() > 1 && n_blocks() + 1 >= rim_boxes_.size()) {
            block_vertices_ *= 2;
            group();
        }
        seams_ =
            std::make_unique<Seams>(finisher_.context_, before.seams_->take_crossing(), ranges_);
    }

    /// Loads the blocks and makes them manifold.
    void prepare(FinishReport& report) {
        ooc::Context& context = finisher_.context_;
        prepared_ = std::make_unique<PieceStore>(context, attributes_);
        std::uint64_t most = 0;
        for (const std::uint64_t n : block_counts_) most = std::max(most, n);
        struct Prepared {
            BlockMesh mesh;
            ManifoldCounts counts;
            std::uint64_t n_open = 0;
        };
        context.workers().in_order(
            n_blocks(), most_blocks_alive(context, bytes_to_prepare(most, attributes_)),
            [&](std::uint64_t b) {
                const ooc::Reservation bytes = context.budget().reserve(
                    "a block", bytes_to_prepare(block_counts_[b], attributes_));
                Prepared block{load(b), {}, 0};
                block.counts = make_manifold(block.mesh, finisher_.kind_);
                for (const StoredVertex& v : block.mesh.vertices) {
                    if (VertexFlags::is_free(v.flags) && (v.flags & VertexFlags::kProcessed) == 0) {
                        ++block.n_open;
                    }
                }
                context.check_stop();
                return block;
            },
            [&](std::uint64_t, const Prepared& block) {
                report.joined_necks += block.counts.joined_necks;
                report.lost_cells += block.counts.lost_cells;
                append_lost(context, block.counts.lost, report.lost);
                n_bubble_faces_ += block.counts.bubble_faces;
                n_open_.push_back(block.n_open);
                n_vertices_ += block.mesh.vertices.size();
                for (const StoredVertex& v : block.mesh.vertices) {
                    if ((v.flags & VertexFlags::kLocked) != 0) --n_vertices_;
                    if ((v.flags & VertexFlags::kFrozen) != 0) ++n_frozen_;
                }
                prepared_->append(block.mesh);
            });
        rims_.reset();
        input_ = nullptr;
    }

    /// Without the bubbles that are to be expected where faces still run between blocks.
    [[nodiscard]] std::uint64_t n_faces() const {
        const std::uint64_t n = prepared_->n_faces() + seams_->crossing().size();
        const double bubbles = static_cast<double>(n_bubble_faces_) *
                               static_cast<double>(n_frozen_) /
                               static_cast<double>(std::max<std::uint64_t>(1, n_open()));
        return n - std::min(n, static_cast<std::uint64_t>(bubbles));
    }
    /// Without those that are written already.
    [[nodiscard]] std::uint64_t n_vertices() const { return n_vertices_; }
    /// The share of what still has to go that is to go on this level: that of the vertices whose
    /// turn it is.
    [[nodiscard]] double share() const {
        if (n_frozen_ == 0) return 1;
        return static_cast<double>(n_open()) / static_cast<double>(n_open() + n_frozen_);
    }

    /// Collapses, and hands the finished parts of all blocks to `core`.
    void collapse(const CollapseNeed& need, bool with_merges, FinishReport& report,
                  MeshStore& core) {
        ooc::Context& context = finisher_.context_;
        const CollapseLogs logs = collapse_blocks(context, *prepared_, n_open_, need);
        next_rims_ = std::make_unique<PieceStore>(context, attributes_);
        next_counts_.assign(counts_.size(), 0);
        using Merges = std::vector<std::pair<VertexId, VertexId>>;
        struct Cut {
            SortedCore core;
            BlockMesh rim;
            Merges merges;
            std::vector<LostPart> lost;
        };
        std::uint64_t most = 0;
        for (std::size_t b = 0; b < n_blocks(); ++b) {
            most = std::max(most, bytes_to_prepare(prepared_->n_vertices(b), attributes_));
        }
        context.workers().in_order(
            n_blocks(), most_blocks_alive(context, most),
            [&](std::uint64_t b) {
                const ooc::Reservation bytes = context.budget().reserve(
                    "a block", bytes_to_prepare(prepared_->n_vertices(b), attributes_));
                BlockMesh mesh = prepared_->load(b, b + 1);
                const auto steps = logs.logs.load(b, logs.n_steps[b]);
                Cut cut;
                cut.lost = apply_steps(mesh, steps, with_merges ? &cut.merges : nullptr);
                CoreAndRim parts = split_rim(std::move(mesh));
                cut.core = sort_core(std::move(parts.core));
                cut.rim = std::move(parts.rim);
                return cut;
            },
            [&](std::uint64_t b, const Cut& cut) {
                report.collapses += logs.n_steps[b];
                append_lost(context, cut.lost, report.lost);
                for (const LostPart& part : cut.lost) report.lost_cells += part.n_cells;
                report.merges.insert(report.merges.end(), cut.merges.begin(), cut.merges.end());
                count_rim(b, cut.rim);
                next_rims_->append(cut.rim);
                append_core(core, cut.core);
                context.advance(logs.n_steps[b]);
            });
        prepared_.reset();
    }

    [[nodiscard]] bool is_last() const { return seams_->crossing().empty(); }
    [[nodiscard]] AttributeKinds attributes() const { return attributes_; }

  private:
    [[nodiscard]] std::uint64_t n_open() const {
        return std::accumulate(n_open_.begin(), n_open_.end(), std::uint64_t{0});
    }
    [[nodiscard]] std::size_t n_blocks() const { return first_box_.size() - 1; }

    void group() {
        first_box_ = group_boxes(finisher_.boxes_, counts_, block_vertices_);
        std::vector<VertexId> first;
        block_counts_.assign(n_blocks(), 0);
        for (const std::size_t box : first_box_) {
            first.push_back(vertex_id(finisher_.first_cluster_[box], 0));
        }
        ranges_ = IdRanges(std::move(first));
        for (std::size_t b = 0; b < n_blocks(); ++b) {
            for (std::size_t i = first_box_[b]; i < first_box_[b + 1]; ++i) {
                block_counts_[b] += counts_[i];
            }
        }
    }

    [[nodiscard]] BlockMesh load(std::size_t b) const {
        BlockMesh mesh;
        if (input_ != nullptr) {
            mesh = input_->load(first_box_[b], first_box_[b + 1]);
        } else {
            const auto piece = [&](std::size_t box) {
                return static_cast<std::size_t>(
                    std::lower_bound(rim_boxes_.begin(), rim_boxes_.end(), box) -
                    rim_boxes_.begin());
            };
            mesh = rims_->load(piece(first_box_[b]), piece(first_box_[b + 1]));
        }
        for (const Face& face : seams_->inside(b)) mesh.faces.push_back(local_face(mesh, face));
        for (const VertexId id : seams_->frozen(b)) {
            mesh.vertices[find_vertex(mesh, id)].flags |= VertexFlags::kFrozen;
        }
        return mesh;
    }

    void count_rim(std::size_t b, const BlockMesh& rim) {
        std::size_t box = first_box_[b];
        for (const StoredVertex& v : rim.vertices) {
            while (cluster_of(v.id) >= finisher_.first_cluster_[box + 1]) ++box;
            ++next_counts_[box];
        }
    }

    Finisher& finisher_;
    const BlockInput* input_ = nullptr;
    std::vector<std::uint64_t> counts_;   // vertices of each box
    std::unique_ptr<PieceStore> rims_;    // of the blocks of the level before,
    std::vector<std::size_t> rim_boxes_;  // which began with these boxes
    std::uint64_t block_vertices_;
    AttributeKinds attributes_;
    std::vector<std::size_t> first_box_;  // of each block, and the end
    std::vector<std::uint64_t> block_counts_;
    IdRanges ranges_;
    std::unique_ptr<Seams> seams_;
    std::unique_ptr<PieceStore> prepared_;
    std::vector<std::uint64_t> n_open_;
    std::uint64_t n_frozen_ = 0;
    std::uint64_t n_bubble_faces_ = 0;
    std::uint64_t n_vertices_ = 0;
    std::unique_ptr<PieceStore> next_rims_;
    std::vector<std::uint64_t> next_counts_;
};

Finisher::Finisher(ooc::Context& context, std::vector<cluster::OctreeBox> boxes,
                   std::vector<std::uint64_t> first_cluster, SurfaceKind kind,
                   std::uint64_t block_vertices)
    : context_(context),
      boxes_(std::move(boxes)),
      first_cluster_(std::move(first_cluster)),
      kind_(kind),
      block_vertices_(block_vertices) {}

Finisher::~Finisher() = default;

std::uint64_t Finisher::begin(const BlockInput& input, FinishReport& report) {
    origin_ = input.origin();
    level_ = std::make_unique<Level>(*this, input);
    level_->prepare(report);
    return level_->n_faces();
}

MeshStore Finisher::run(const std::optional<CollapseTarget>& target, bool with_merges,
                        FinishReport& report) {
    std::vector<MeshStore> parts;
    std::uint64_t n_faces = 0;  // finished
    std::uint64_t n_vertices = 0;
    for (;;) {
        CollapseNeed need;
        if (target) {
            const auto share = [&](std::uint64_t n) {
                return static_cast<std::uint64_t>(
                    std::llround(static_cast<double>(n) * level_->share()));
            };
            const std::uint64_t faces = excess(n_faces + level_->n_faces(), target->most_triangles);
            const std::uint64_t vertices =
                excess(n_vertices + level_->n_vertices(), target->most_vertices);
            need.rules = target->rules;
            // An inner edge takes two faces with it.
            if (faces >= 2 * vertices) {
                need.faces = share(faces);
            } else {
                need.vertices = share(vertices);
            }
        }
        parts.push_back(make_mesh_store(context_, origin_, level_->attributes()));
        level_->collapse(need, with_merges, report, parts.back());
        n_faces += parts.back().faces.size();
        n_vertices += parts.back().vertices.size();
        if (level_->is_last()) break;
        level_ = std::make_unique<Level>(*this, *level_);
        level_->prepare(report);
    }
    level_.reset();
    return merge_parts(context_, std::move(parts));
}

}  // namespace hewer::rsimp

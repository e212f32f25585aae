// SPDX-License-Identifier: MIT
#include "rsimp/cell_weights.h"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include "ooc/vec3.h"

namespace hewer::rsimp {

using cluster::CellAttributes;
using cluster::CellBlocks;
using cluster::CellRecord;

namespace {

void weigh(CellRecord& cell, float weight) {
    for (float& x : cell.quadric) x *= weight;
    cell.area *= weight;
}

void warn_of_empty(ooc::Context& context, std::span<const FocusBox> focus,
                   const std::vector<std::uint64_t>& n_cells) {
    for (std::size_t i = 0; i < focus.size(); ++i) {
        if (n_cells[i] > 0 || focus[i].may_be_empty) continue;
        const Bounds& b = focus[i].box;
        std::ostringstream text;
        text << "--focus: no part of the surface lies in the box " << b.min[0] << ',' << b.min[1]
             << ',' << b.min[2] << ',' << b.max[0] << ',' << b.max[1] << ',' << b.max[2];
        context.warn(text.str());
    }
}

}  // namespace

void weigh_cells(ooc::Context& context, std::span<const FocusBox> focus, CellBlocks& blocks) {
    if (focus.empty() && blocks.weights.empty()) return;
    ooc::Spool<CellRecord> weighed(context, "cells");
    ooc::Spool<CellAttributes> weighed_attributes;
    const bool has_attributes = !blocks.attributes.empty();
    if (has_attributes) weighed_attributes = {context, "cell attributes"};
    std::vector<std::uint64_t> n_cells(focus.size());
    ooc::SpoolReader<CellRecord> records(blocks.cells);
    ooc::SpoolReader<std::uint64_t> codes(blocks.codes);
    ooc::SpoolReader<CellAttributes> attributes(blocks.attributes);
    ooc::SpoolReader<float> weights(blocks.weights);
    std::vector<CellRecord> piece;
    for (auto run = records.next_piece(); !run.empty(); run = records.next_piece()) {
        piece.assign(run.begin(), run.end());
        for (CellRecord& cell : piece) {
            const float* const of_vertices = weights.next();
            double weight = of_vertices != nullptr ? static_cast<double>(*of_vertices) : 1;
            const Vec3 mean{static_cast<double>(cell.mean[0]), static_cast<double>(cell.mean[1]),
                            static_cast<double>(cell.mean[2])};
            const Vec3 place = blocks.to_model(cluster::center_of(*codes.next()) + mean);
            for (std::size_t i = 0; i < focus.size(); ++i) {
                if (!is_inside(focus[i].box, place)) continue;
                weight *= focus[i].weight;
                ++n_cells[i];
            }
            const auto w =
                static_cast<float>(std::clamp(weight, kLeastCellWeight, kMostCellWeight));
            weigh(cell, w);
            if (!has_attributes) continue;
            CellAttributes a = *attributes.next();
            for (float& x : a.face_normal) x *= w;
            weighed_attributes.push(a);
        }
        weighed.append(piece);
        context.check_stop();
    }
    blocks.cells = std::move(weighed);
    if (has_attributes) blocks.attributes = std::move(weighed_attributes);
    blocks.weights.release();
    warn_of_empty(context, focus, n_cells);
}

}  // namespace hewer::rsimp

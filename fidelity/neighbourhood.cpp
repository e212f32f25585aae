// SPDX-License-Identifier: MIT
#include "fidelity/neighbourhood.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "hewer/surface_part.h"
#include "ooc/vec3.h"

namespace hewer::fidelity {

namespace {

Bounds widened(Bounds box, double by) {
    for (std::size_t k = 0; k < 3; ++k) {
        box.min[k] -= by;
        box.max[k] += by;
    }
    return box;
}

}  // namespace

bool Neighbourhood::has(const Bounds& box) const {
    return std::any_of(boxes_.begin(), boxes_.end(), [&](const Bounds& own) {
        return is_inside(own, box.min) && is_inside(own, box.max);
    });
}

bool Neighbourhood::include(std::span<const Bounds> boxes, const Hooks& hooks) {
    std::vector<Bounds> all = boxes_;
    for (const Bounds& box : boxes) {
        const Bounds wanted = widened(box, reach_);
        // Twice the reach: the next ones will be near.
        if (!has(wanted)) all.push_back(widened(wanted, reach_));
    }
    if (all.size() == boxes_.size()) return true;
    std::optional<Mesh> part =
        part_of_surface(judge_->original(), all, kMostTriangles, judge_->options(), hooks);
    if (!part) return false;
    mesh_ = std::move(*part);
    boxes_ = std::move(all);
    return true;
}

}  // namespace hewer::fidelity

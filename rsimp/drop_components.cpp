// SPDX-License-Identifier: MIT
/// EdgeCollapse::drop_components(): what goes when collapsing can go no further.
#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "rsimp/edge_collapse.h"

namespace hewer::rsimp {

std::uint64_t EdgeCollapse::drop_components(const CollapseTarget& target) {
    std::vector<std::uint32_t> label(parent_.size());
    std::iota(label.begin(), label.end(), 0U);
    const auto find = [&](std::uint32_t v) {
        while (label[v] != v) v = label[v] = label[label[v]];
        return v;
    };
    for (const CellTriple& t : mesh_.triangles) {
        if (t[0] == kNoIndex) continue;
        for (std::size_t i = 1; i < 3; ++i) {
            const std::uint32_t a = find(t[0]);
            const std::uint32_t b = find(t[i]);
            label[std::max(a, b)] = std::min(a, b);
        }
    }
    struct Component {
        double size_sq = 0;
        std::uint32_t label = 0;
        std::uint64_t n_triangles = 0;
        std::uint64_t n_vertices = 0;
        std::array<float, 6> box{};
    };
    std::vector<Component> components;
    std::vector<std::uint32_t> index(parent_.size(), kNoIndex);
    for (std::uint64_t i = 0; i < n_live_; ++i) {
        const std::uint32_t v = live_[i];
        std::uint32_t& at = index[find(v)];
        if (at == kNoIndex) {
            at = static_cast<std::uint32_t>(components.size());
            components.push_back({0, find(v), 0, 0, mesh_.vertices[v].box});
        }
        Component& c = components[at];
        ++c.n_vertices;
        for (std::size_t k = 0; k < 3; ++k) {
            c.box[k] = std::min(c.box[k], mesh_.vertices[v].box[k]);
            c.box[3 + k] = std::max(c.box[3 + k], mesh_.vertices[v].box[3 + k]);
        }
    }
    for (const CellTriple& t : mesh_.triangles) {
        if (t[0] != kNoIndex) ++components[index[find(t[0])]].n_triangles;
    }
    for (Component& c : components) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double d = static_cast<double>(c.box[3 + k]) - static_cast<double>(c.box[k]);
            c.size_sq += d * d;
        }
    }
    std::sort(components.begin(), components.end(), [](const Component& a, const Component& b) {
        return a.size_sq != b.size_sq ? a.size_sq < b.size_sq : a.label < b.label;
    });
    std::uint64_t n_dropped = 0;
    std::vector<bool> is_dropped(parent_.size());
    for (std::size_t i = 0; i + 1 < components.size() && !is_met(target); ++i) {
        is_dropped[components[i].label] = true;
        n_triangles_ -= components[i].n_triangles;
        n_vertices_ -= components[i].n_vertices;
        ++n_dropped;
    }
    for (CellTriple& t : mesh_.triangles) {
        if (t[0] != kNoIndex && is_dropped[find(t[0])]) t = {kNoIndex, kNoIndex, kNoIndex};
    }
    std::uint64_t kept = 0;
    for (std::uint64_t i = 0; i < n_live_; ++i) {
        const std::uint32_t v = live_[i];
        if (is_dropped[find(v)]) {
            parent_[v] = kNoIndex;
        } else {
            live_[kept++] = v;
        }
    }
    n_live_ = kept;
    return n_dropped;
}

}  // namespace hewer::rsimp

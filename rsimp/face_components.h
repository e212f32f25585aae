// SPDX-License-Identifier: MIT
/// Which vertices of a mesh in memory hang together by faces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace hewer::rsimp {

/// For each of `n` vertices the smallest vertex of its component; itself where it has no face.
/// Faces have three corners each, below n.
template <typename Faces>
std::vector<std::uint32_t> component_labels(std::size_t n, const Faces& faces) {
    std::vector<std::uint32_t> label(n);
    std::iota(label.begin(), label.end(), 0U);
    const auto find = [&](std::uint32_t v) {
        while (label[v] != v) v = label[v] = label[label[v]];
        return v;
    };
    for (const auto& t : faces) {
        for (std::size_t i = 1; i < 3; ++i) {
            const std::uint32_t a = find(t[0]);
            const std::uint32_t b = find(t[i]);
            label[std::max(a, b)] = std::min(a, b);
        }
    }
    // Parents are smaller than their children, so each is final when its children ask.
    for (std::uint32_t v = 0; v < n; ++v) label[v] = label[label[v]];
    return label;
}

}  // namespace hewer::rsimp

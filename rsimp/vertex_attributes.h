// SPDX-License-Identifier: MIT
/// What vertices carry beside their place, in memory and on spools.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "cluster/attribute_quadric.h"
#include "cluster/cell_record.h"
#include "ooc/spool.h"

namespace hewer::rsimp {

/// Which of them there are.
struct AttributeKinds {
    bool sums = false;      ///< normals and colours of the original vertices
    bool quadrics = false;  ///< what the error metric knows of them

    [[nodiscard]] constexpr std::uint64_t bytes() const {
        return (sums ? sizeof(cluster::CellAttributes) : 0) +
               (quadrics ? sizeof(cluster::AttributeQuadric) : 0);
    }
    bool operator==(const AttributeKinds&) const = default;
};

/// Parallel to the vertices of a mesh; a list of a kind that there is not is empty.
struct VertexAttributes {
    std::vector<cluster::CellAttributes> sums;
    std::vector<cluster::AttributeQuadric> quadrics;  ///< relative to the origin of the mesh

    [[nodiscard]] AttributeKinds kinds() const { return {!sums.empty(), !quadrics.empty()}; }
    void resize(std::size_t n, AttributeKinds kinds) {
        sums.resize(kinds.sums ? n : 0);
        quadrics.resize(kinds.quadrics ? n : 0);
    }
    /// The first `n` stay.
    void truncate(std::size_t n) {
        if (!sums.empty()) sums.resize(n);
        if (!quadrics.empty()) quadrics.resize(n);
    }
    /// Those of `from` in the place of those of `to`.
    void copy(std::size_t from, std::size_t to) {
        if (!sums.empty()) sums[to] = sums[from];
        if (!quadrics.empty()) quadrics[to] = quadrics[from];
    }
    /// Vertex `gone` becomes part of `kept`.
    void merge(std::size_t kept, std::size_t gone) {
        if (!sums.empty()) sums[kept] += sums[gone];
        if (!quadrics.empty()) quadrics[kept] += quadrics[gone];
    }
    /// One more vertex, like `v`.
    void repeat(std::size_t v) {
        if (!sums.empty()) {
            const cluster::CellAttributes copy = sums[v];
            sums.push_back(copy);
        }
        if (!quadrics.empty()) {
            const cluster::AttributeQuadric copy = quadrics[v];
            quadrics.push_back(copy);
        }
    }
    /// order[i] becomes i.
    void reorder(std::span<const std::uint32_t> order) {
        const auto reordered = [&](auto& list) {
            if (list.empty()) return;
            auto before = std::move(list);
            list.clear();
            list.reserve(order.size());
            for (const std::uint32_t i : order) list.push_back(before[i]);
        };
        reordered(sums);
        reordered(quadrics);
    }
};

/// The same on spools.
struct AttributeSpools {
    ooc::Spool<cluster::CellAttributes> sums;
    ooc::Spool<cluster::AttributeQuadric> quadrics;

    AttributeSpools() = default;
    AttributeSpools(ooc::Context& context, AttributeKinds kinds) {
        if (kinds.sums) sums = {context, "attributes"};
        if (kinds.quadrics) quadrics = {context, "attribute quadrics"};
    }
    /// Of what has been written.
    [[nodiscard]] AttributeKinds kinds() const { return {!sums.empty(), !quadrics.empty()}; }

    void append(const VertexAttributes& attributes) {
        if (!attributes.sums.empty()) sums.append(attributes.sums);
        if (!attributes.quadrics.empty()) quadrics.append(attributes.quadrics);
    }
    /// Of the vertices first .. first + n - 1.
    void read(std::uint64_t first, std::size_t n, VertexAttributes& attributes) const {
        attributes.resize(n, kinds());
        if (!sums.empty()) sums.read(first, attributes.sums);
        if (!quadrics.empty()) quadrics.read(first, attributes.quadrics);
    }
    void release() {
        sums.release();
        quadrics.release();
    }
};

}  // namespace hewer::rsimp

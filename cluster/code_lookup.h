// SPDX-License-Identifier: MIT
/// From Morton codes of cells to their ids.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "cluster/cell_blocks.h"

namespace hewer::cluster {

/// Keeps the codes of the last few blocks that were asked for: triangles reach into blocks that are
/// near. One thread. Memory: 8 bytes for each cell of kBlocks blocks.
class CodeLookup {
  public:
    explicit CodeLookup(const CellBlocks& blocks) : blocks_(blocks) {}

    /// The block whose box holds the code.
    [[nodiscard]] static std::size_t block_of(const CellBlocks& blocks, std::uint64_t code) {
        const auto it = std::upper_bound(
            blocks.blocks.begin(), blocks.blocks.end() - 1, code,
            [](std::uint64_t c, const CellBlocks::Block& b) { return c < b.box.code; });
        return static_cast<std::size_t>(it - blocks.blocks.begin()) - 1;
    }

    /// Id, or nothing if there is no cell with that code.
    std::optional<std::uint64_t> find(std::uint64_t code) {
        if (blocks_.n_blocks() == 0 || code < blocks_.blocks.front().box.code) return {};
        if (!holds(blocks_.blocks[block_of(blocks_, code)].box, code)) return {};
        const Entry& entry = entry_of(code);
        const auto at = std::lower_bound(entry.codes.begin(), entry.codes.end(), code);
        if (at == entry.codes.end() || *at != code) return {};
        return blocks_.blocks[entry.block].first_cell +
               static_cast<std::uint64_t>(at - entry.codes.begin());
    }
    /// Precondition: there is a cell with that code.
    std::uint32_t id_of(std::uint64_t code) {
        const Entry& entry = entry_of(code);
        const auto at = std::lower_bound(entry.codes.begin(), entry.codes.end(), code);
        return static_cast<std::uint32_t>(blocks_.blocks[entry.block].first_cell +
                                          static_cast<std::uint64_t>(at - entry.codes.begin()));
    }

    static constexpr std::size_t kBlocks = 8;

  private:
    struct Entry {
        std::size_t block = 0;
        std::uint64_t last_use = 0;  // 0: empty
        std::vector<std::uint64_t> codes;
    };
    static bool holds(const OctreeBox& box, std::uint64_t code) {
        return code >= box.code && (code - box.code) >> box.shift == 0;
    }
    const Entry& entry_of(std::uint64_t code) {
        for (Entry& entry : entries_) {
            if (entry.last_use != 0 && holds(blocks_.blocks[entry.block].box, code)) {
                entry.last_use = ++clock_;
                return entry;
            }
        }
        Entry& entry = *std::min_element(
            entries_.begin(), entries_.end(),
            [](const Entry& a, const Entry& b) { return a.last_use < b.last_use; });
        entry.block = block_of(blocks_, code);
        entry.last_use = ++clock_;
        const std::uint64_t first = blocks_.blocks[entry.block].first_cell;
        entry.codes.resize(blocks_.blocks[entry.block + 1].first_cell - first);
        blocks_.codes.read(first, entry.codes);
        return entry;
    }

    const CellBlocks& blocks_;
    std::array<Entry, kBlocks> entries_;
    std::uint64_t clock_ = 0;
};

}  // namespace hewer::cluster

// SPDX-License-Identifier: MIT
#include "rsimp/blocks_in_flight.h"

#include <algorithm>

#include "hewer/error.h"

namespace hewer::rsimp {

namespace {
constexpr std::uint64_t kShareOfLimit = 4;
}  // namespace

LargestBlock::LargestBlock(const cluster::CellBlocks& blocks) {
    for (std::size_t b = 0; b < blocks.n_blocks(); ++b) {
        const auto& first = blocks.blocks[b];
        const auto& last = blocks.blocks[b + 1];
        n_cells = std::max(n_cells, last.first_cell - first.first_cell);
        n_faces = std::max(n_faces, last.first_face - first.first_face);
    }
}

BlocksInFlight::BlocksInFlight(ooc::Context& context, std::string_view what, std::uint64_t bytes)
    : context_(context) {
    const std::uint64_t share = context.budget().limit() / kShareOfLimit;
    const std::uint64_t most =
        context.n_threads() == 1 ? 1 : 2 * std::uint64_t{context.n_threads()};
    std::uint64_t n = std::clamp<std::uint64_t>(share / std::max<std::uint64_t>(1, bytes), 1, most);
    for (;; n /= 2) {
        try {
            reservation_ = context.budget().reserve(what, n * bytes);
            most_alive_ = static_cast<std::size_t>(n);
            return;
        } catch (const OutOfMemoryBudget&) {
            if (n == 1) throw;
        }
    }
}

}  // namespace hewer::rsimp

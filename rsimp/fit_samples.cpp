// SPDX-License-Identifier: MIT
#include "rsimp/fit_samples.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hewer::rsimp {

namespace {
constexpr std::uint64_t kPiece = 1 << 12;
}

ooc::Spool<FitSample> collect_samples(ooc::Context& context, const cluster::CellBlocks& cells) {
    ooc::Spool<FitSample> samples(context, "samples of the surface");
    std::vector<cluster::CellRecord> records;
    std::vector<std::uint64_t> codes;
    std::vector<FitSample> piece;
    for (std::uint64_t first = 0; first < cells.n_cells(); first += kPiece) {
        const std::uint64_t n = std::min(kPiece, cells.n_cells() - first);
        records.resize(n);
        codes.resize(n);
        piece.clear();
        cells.cells.read(first, records);
        cells.codes.read(first, codes);
        for (std::uint64_t i = 0; i < n; ++i) {
            const cluster::CellRecord& record = records[i];
            if (!(record.area > 0)) continue;
            FitSample sample{codes[i], {}, 0};
            const auto beyond = record.mean_beyond();
            for (std::size_t k = 0; k < 3; ++k) {
                const double offset = static_cast<double>(record.mean[k]) + beyond[k];
                sample.offset[k] = static_cast<std::int16_t>(
                    std::clamp(std::lround(offset * 32768), -16384L, 16384L));
            }
            constexpr std::uint32_t kLeast = 1;  // subnormal, but above 0
            const std::uint32_t bits = std::bit_cast<std::uint32_t>(record.area) >> 16;
            sample.area_bits = static_cast<std::uint16_t>(std::max(bits, kLeast));
            piece.push_back(sample);
        }
        samples.append(piece);
        context.check_stop();
    }
    return samples;
}

}  // namespace hewer::rsimp

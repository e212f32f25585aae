// SPDX-License-Identifier: MIT
#include "rsimp/border_samples.h"

namespace hewer::rsimp {

ooc::Spool<FitSample> collect_border_samples(ooc::Context& context,
                                             const cluster::CellBlocks& cells) {
    ooc::Spool<FitSample> samples(context, "samples of the borders");
    ooc::SpoolReader<cluster::BorderLine> lines(cells.borders);
    while (const cluster::BorderLine* line = lines.next()) {
        const auto& d = line->direction;
        samples.push({line->position, {d[0], d[1], d[2]}, line->length});
    }
    return samples;
}

}  // namespace hewer::rsimp

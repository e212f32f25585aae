// SPDX-License-Identifier: MIT
#include "rsimp/step_selection.h"

#include <algorithm>
#include <bit>

namespace hewer::rsimp {

namespace {

constexpr unsigned kHalf = 16;

/// Keys are not negative, so their bits are in the order of the numbers.
std::uint32_t bits_of(const CollapseStep& step) {
    return std::bit_cast<std::uint32_t>(step.key);
}

}  // namespace

std::vector<std::uint64_t> select_steps(const StepStore& logs, std::uint64_t n_faces,
                                        std::uint64_t n_vertices) {
    const auto weight = [&](const CollapseStep& step) -> std::uint64_t {
        return n_faces != 0 ? step.n_faces : step.n_vertices;
    };
    const std::uint64_t wanted = n_faces != 0 ? n_faces : n_vertices;
    std::vector<std::uint64_t> chosen(logs.size());
    if (wanted == 0) return chosen;
    // The upper half of the key that the cut is at, then the lower.
    std::vector<std::uint64_t> histogram(1U << kHalf);
    logs.for_each([&](std::size_t, const CollapseStep& step) {
        histogram[bits_of(step) >> kHalf] += weight(step);
    });
    std::uint64_t below = 0;
    std::uint32_t upper = 0;
    while (upper < histogram.size() && below + histogram[upper] < wanted) {
        below += histogram[upper++];
    }
    if (upper == histogram.size()) {
        for (std::size_t log = 0; log < logs.size(); ++log) chosen[log] = logs.n_steps(log);
        return chosen;
    }
    std::fill(histogram.begin(), histogram.end(), 0);
    logs.for_each([&](std::size_t, const CollapseStep& step) {
        if (bits_of(step) >> kHalf == upper) {
            histogram[bits_of(step) & ((1U << kHalf) - 1)] += weight(step);
        }
    });
    std::uint32_t lower = 0;
    while (below + histogram[lower] < wanted) below += histogram[lower++];
    const std::uint32_t cut = upper << kHalf | lower;
    logs.for_each([&](std::size_t log, const CollapseStep& step) {
        const std::uint32_t bits = bits_of(step);
        if (bits > cut || (bits == cut && below >= wanted)) return;
        if (bits == cut) below += weight(step);
        ++chosen[log];
    });
    return chosen;
}

}  // namespace hewer::rsimp

// SPDX-License-Identifier: MIT
#include "rsimp/duplicate_faces.h"

#include <utility>

namespace hewer::rsimp {

namespace {

void rotate_smallest_first(LocalFace& t) {
    const std::size_t i = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
    t = {t[i], t[(i + 1) % 3], t[(i + 2) % 3]};
}

/// The smallest corner is a place in an array: counting sorts by it.
void sort_faces(std::vector<LocalFace>& faces) {
    std::uint32_t n = 0;
    for (const LocalFace& t : faces) n = std::max(n, t[0] + 1);
    std::vector<std::uint32_t> start(n + 1);
    for (const LocalFace& t : faces) ++start[t[0] + 1];
    for (std::uint32_t v = 0; v < n; ++v) start[v + 1] += start[v];
    std::vector<LocalFace> sorted(faces.size());
    std::vector<std::uint32_t> at(start.begin(), start.end());
    for (const LocalFace& t : faces) sorted[at[t[0]]++] = t;
    for (std::uint32_t v = 0; v < n; ++v) {
        std::sort(sorted.begin() + start[v], sorted.begin() + start[v + 1], ByUnwound());
    }
    faces = std::move(sorted);
}

}  // namespace

std::uint64_t settle_duplicates(std::vector<LocalFace>& faces, bool is_closed) {
    std::erase_if(faces, is_degenerate);
    for (LocalFace& t : faces) rotate_smallest_first(t);
    sort_faces(faces);
    const std::uint64_t before = faces.size();
    std::vector<LocalFace> settled;
    settled.reserve(before);
    const auto visit = [&](const auto& take) {
        for (const LocalFace& t : faces) take(t);
    };
    const auto emit = [&](const LocalFace& t) { settled.push_back(t); };
    DuplicateSettler<LocalFace, decltype(emit)> settler(keeps_copies<LocalFace>(is_closed, visit),
                                                        emit);
    visit([&](const LocalFace& t) { settler.add(t); });
    settler.finish();
    faces = std::move(settled);
    return before - faces.size();
}

}  // namespace hewer::rsimp

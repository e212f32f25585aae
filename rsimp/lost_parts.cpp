// SPDX-License-Identifier: MIT
#include "rsimp/lost_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <vector>

#include "ooc/external_sort.h"
#include "ooc/vec3.h"

namespace hewer::rsimp {

namespace {

struct CodedPart {
    std::uint64_t code;
    LostPart part;
};

bool is_before(const CodedPart& a, const CodedPart& b) {
    return std::tie(a.code, a.part.box, a.part.n_cells, a.part.is_unseen) <
           std::tie(b.code, b.part.box, b.part.n_cells, b.part.is_unseen);
}

/// Morton code of the low corner. The frame's origin lies in the middle of the grid, so that no
/// axis leaves the 21 bits when it is moved by half of them.
std::uint64_t code_of(const LostPart& part) {
    std::uint64_t code = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto at = static_cast<std::int64_t>(std::floor(part.box[k])) + (1 << 20);
        code |= cluster::spread_bits(static_cast<std::uint64_t>(std::max<std::int64_t>(at, 0)))
                << k;
    }
    return code;
}

bool touch(const LostPart& a, const LostPart& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (a.box[k] > b.box[3 + k] || b.box[k] > a.box[3 + k]) return false;
    }
    return true;
}

bool is_inside(const LostPart& a, const LostPart& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (a.box[k] < b.box[k] || a.box[3 + k] > b.box[3 + k]) return false;
    }
    return true;
}

bool is_larger(const LostPlace& a, const LostPlace& b) {
    return a.size != b.size ? a.size > b.size
                            : std::tie(a.center, a.cells) < std::tie(b.center, b.cells);
}

std::size_t longest_axis(std::span<const LostPart> parts) {
    std::size_t longest = 0;
    float most = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto [low, high] =
            std::minmax_element(parts.begin(), parts.end(),
                                [&](const auto& a, const auto& b) { return a.box[k] < b.box[k]; });
        if (high->box[k] - low->box[k] > most) {
            most = high->box[k] - low->box[k];
            longest = k;
        }
    }
    return longest;
}

constexpr std::uint64_t kBytesPerPart = 96;

void group(std::vector<LostPart>& parts, const PlaceFrame& frame, LostPlaces& places) {
    const std::size_t axis = longest_axis(parts);
    std::sort(parts.begin(), parts.end(), [&](const LostPart& a, const LostPart& b) {
        return std::tie(a.box[axis], a.box, a.n_cells) < std::tie(b.box[axis], b.box, b.n_cells);
    });
    std::vector<std::uint32_t> label(parts.size());
    std::iota(label.begin(), label.end(), 0U);
    const auto find = [&](std::uint32_t i) {
        while (label[i] != i) i = label[i] = label[label[i]];
        return i;
    };
    std::vector<std::uint32_t> open;  // those that the plane of the sweep cuts
    std::vector<bool> is_counted(parts.size(), true);
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
        const LostPart& part = parts[i];
        std::erase_if(open,
                      [&](std::uint32_t j) { return parts[j].box[3 + axis] < part.box[axis]; });
        for (const std::uint32_t j : open) {
            const LostPart& other = parts[j];
            if (!touch(part, other)) continue;
            const std::uint32_t a = find(i);
            const std::uint32_t b = find(j);
            label[std::max(a, b)] = std::min(a, b);
            if (part.is_unseen > other.is_unseen && is_inside(part, other)) is_counted[i] = false;
            if (part.is_unseen < other.is_unseen && is_inside(other, part)) is_counted[j] = false;
        }
        open.push_back(i);
    }
    // A label is never larger than its place, so what is added to is there.
    struct Group {
        std::array<float, 6> box;
        std::uint64_t n_cells = 0;
    };
    std::vector<Group> groups;
    std::vector<std::uint32_t> group_of(parts.size());
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
        const std::uint32_t root = find(i);
        if (root == i) {
            group_of[i] = static_cast<std::uint32_t>(groups.size());
            groups.push_back({parts[i].box, 0});
        }
        Group& g = groups[group_of[root]];
        widen(g.box, parts[i].box);
        if (is_counted[i]) g.n_cells += parts[i].n_cells;
    }
    for (const Group& g : groups) {
        Vec3 center{};
        double squares = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto low = static_cast<double>(g.box[k]);
            const auto high = static_cast<double>(g.box[3 + k]);
            center[k] = frame.origin[k] + frame.cell_size * (0.5 * (low + high));
            squares += (high - low) * (high - low);
        }
        add_place(places, {center, frame.cell_size * std::sqrt(squares), g.n_cells});
    }
}

}  // namespace

void append_lost(ooc::Context& context, std::span<const LostPart> parts,
                 ooc::Spool<LostPart>& lost) {
    if (parts.empty()) return;
    if (lost.empty()) lost = {context, "lost parts"};
    lost.append(parts);
}

void add_place(LostPlaces& places, const LostPlace& place) {
    ++places.places;
    places.cells += place.cells;
    std::vector<LostPlace>& list = places.list;
    if (list.size() == LostPlaces::kMostListed) {
        if (!is_larger(place, list.front())) return;
        std::pop_heap(list.begin(), list.end(), is_larger);
        list.pop_back();
    }
    list.push_back(place);
    std::push_heap(list.begin(), list.end(), is_larger);
}

void sort_places(LostPlaces& places) {
    std::sort_heap(places.list.begin(), places.list.end(), is_larger);
}

LostPlaces find_places(ooc::Context& context, const ooc::Spool<LostPart>& parts,
                       const PlaceFrame& frame) {
    LostPlaces places;
    if (parts.empty()) return places;
    const ooc::Reservation bytes = context.budget().reserve(
        "lost parts", kBytesPerPart * std::min(parts.size(), kPartsAtOnce));
    if (parts.size() <= kPartsAtOnce) {
        std::vector<LostPart> all(parts.size());
        parts.read(0, all);
        group(all, frame, places);
        sort_places(places);
        return places;
    }
    ooc::ExternalSorter<CodedPart, decltype(&is_before)> sorter(context, "lost parts", &is_before,
                                                                context.sort_bytes());
    ooc::SpoolReader<LostPart> reader(parts);
    while (const LostPart* part = reader.next()) sorter.add({code_of(*part), *part});
    const ooc::Spool<CodedPart> sorted = sorter.finish();
    ooc::SpoolReader<CodedPart> in_order(sorted);
    std::vector<LostPart> some;
    some.reserve(kPartsAtOnce);
    while (const CodedPart* part = in_order.next()) {
        some.push_back(part->part);
        if (some.size() < kPartsAtOnce) continue;
        group(some, frame, places);
        some.clear();
        context.check_stop();
    }
    if (!some.empty()) group(some, frame, places);
    sort_places(places);
    return places;
}

}  // namespace hewer::rsimp

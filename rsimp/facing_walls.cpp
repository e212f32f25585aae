// SPDX-License-Identifier: MIT
#include "rsimp/facing_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "ooc/vec3.h"
#include "rsimp/face_components.h"

namespace hewer::rsimp {

namespace {

constexpr double kFlat = 0.1;

struct Edge {
    std::uint32_t low;
    std::uint32_t high;
    std::uint32_t patch;
    std::int32_t sign;
};

struct Patch {
    bool is_cycle = true;
    double area = 0;
    double volume = 0;
};

}  // namespace

std::vector<bool> kept_walls(std::span<const WallFace> faces, double distance) {
    std::vector<std::uint32_t> cells;
    for (const WallFace& f : faces) cells.insert(cells.end(), f.cells.begin(), f.cells.end());
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    const auto place = [&](std::uint32_t cell) {
        return static_cast<std::uint32_t>(std::lower_bound(cells.begin(), cells.end(), cell) -
                                          cells.begin());
    };
    std::vector<std::array<std::uint32_t, 3>> corners;
    for (const WallFace& f : faces) {
        corners.push_back({place(f.cells[0]), place(f.cells[1]), place(f.cells[2])});
    }
    const std::vector<std::uint32_t> label = component_labels(cells.size(), corners);
    std::vector<Patch> patches(cells.size());
    std::vector<Edge> edges;
    for (const WallFace& f : faces) {
        const std::uint32_t p = label[place(f.cells[0])];
        const Vec3 n = cross(f.corners[1] - f.corners[0], f.corners[2] - f.corners[0]);
        patches[p].area += 0.5 * std::sqrt(dot(n, n));
        // Of a cycle it does not matter from where the volume is seen; from near by it is exact.
        patches[p].volume += dot(n, f.corners[0] - faces[0].corners[0]) / 6;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = f.cells[k];
            const std::uint32_t b = f.cells[(k + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), p, a < b ? 1 : -1});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high) < std::tie(b.low, b.high);
    });
    for (std::size_t i = 0; i < edges.size();) {
        std::int32_t sum = 0;
        std::size_t j = i;
        for (; j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high;
             ++j) {
            sum += edges[j].sign;
        }
        if (sum != 0) patches[edges[i].patch].is_cycle = false;
        i = j;
    }
    std::vector<bool> is_kept(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const Patch& patch = patches[label[place(faces[f].cells[0])]];
        const double most = kFlat * distance * 0.5 * patch.area;
        is_kept[f] = !patch.is_cycle || std::abs(patch.volume) > most;
    }
    return is_kept;
}

}  // namespace hewer::rsimp

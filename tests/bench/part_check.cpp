// SPDX-License-Identifier: MIT
/// Whether every part of a mesh is in its simplified form or told of as lost.
///
///     part_check ORIGINAL.ply SIMPLIFIED.ply REPORT.json
///
/// Both with equal positions as one vertex. A part is a component of the original. A component of
/// the simplified mesh stands for the part that most of its vertices are nearest to. If several
/// would stand for one part, the largest does; of two parts that touch, the small one's four
/// vertices are as often nearest to the large one as to its own. Another of the several then
/// stands for a part that any of its vertices is nearest to, if all of it is within that part's
/// size of its bounding box. A part for which none stands is missing, and told of if a place in
/// the report's lods[0].lost.list reaches into its bounding box. Prints JSON: how many parts there
/// are, how many of them are missing, told of and untold, and the size of the largest that is
/// untold.
///
/// Memory: about 100 bytes a vertex, and FLANN's tree of the original's.
#include <flann/flann.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/bench/disjoint_sets.h"
#include "tests/bench/plain_ply.h"

namespace {

using nlohmann::ordered_json;
using Point = std::array<float, 3>;

struct Part {
    Point low{INFINITY, INFINITY, INFINITY};
    Point high{-INFINITY, -INFINITY, -INFINITY};
    bool is_there = false;

    void add(const Point& p) {
        for (std::size_t i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], p[i]);
            high[i] = std::max(high[i], p[i]);
        }
    }
    [[nodiscard]] double size() const {
        return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    }
    /// Distance of a point from the box.
    [[nodiscard]] double distance(const std::array<double, 3>& p) const {
        std::array<double, 3> gap{};
        for (std::size_t i = 0; i < 3; ++i) {
            gap[i] = std::max({low[i] - p[i], p[i] - high[i], 0.0});
        }
        return std::hypot(gap[0], gap[1], gap[2]);
    }
};

/// Of the simplified mesh.
struct Component {
    Part box;
    std::uint64_t n_vertices = 0;
    std::map<std::uint32_t, std::uint64_t> votes;  // vertices by the part that they are nearest to

    void add(const Point& p, std::uint32_t part) {
        box.add(p);
        ++n_vertices;
        ++votes[part];
    }
    [[nodiscard]] std::uint32_t most() const {
        return std::max_element(votes.begin(), votes.end(),
                                [](const auto& a, const auto& b) { return a.second < b.second; })
            ->first;
    }
    /// Whether all of it is within that part's size of it.
    [[nodiscard]] bool is_near(const Part& part) const {
        for (std::size_t i = 0; i < 3; ++i) {
            if (part.low[i] - box.low[i] > part.size() || box.high[i] - part.high[i] > part.size())
                return false;
        }
        return true;
    }
};

/// Marks the parts for which a component stands.
void assign(const std::map<std::uint32_t, Component>& components,
            std::map<std::uint32_t, Part>& parts) {
    std::vector<const Component*> by_size;
    for (const auto& [root, component] : components) by_size.push_back(&component);
    std::stable_sort(by_size.begin(), by_size.end(), [](const Component* a, const Component* b) {
        return a->n_vertices > b->n_vertices;
    });
    std::vector<const Component*> spare;
    for (const Component* component : by_size) {
        Part& part = parts.at(component->most());
        if (part.is_there) spare.push_back(component);
        part.is_there = true;
    }
    for (const Component* component : spare) {
        for (const auto& [root, n] : component->votes) {
            Part& part = parts.at(root);
            if (part.is_there || !component->is_near(part)) continue;
            part.is_there = true;
            break;
        }
    }
}

Point point(const bench::PlainMesh& mesh, std::uint32_t v) {
    const float* const p = mesh.positions.data() + std::size_t{3} * v;
    return {p[0], p[1], p[2]};
}

/// Vertices that a triangle has, each position once.
std::vector<std::uint32_t> used_vertices(const bench::PlainMesh& mesh,
                                         const std::vector<std::uint32_t>& first) {
    std::vector<std::uint32_t> used;
    for (const std::uint32_t v : mesh.indices) used.push_back(first[v]);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

/// Joins the corners of each triangle.
bench::DisjointSets components(const bench::PlainMesh& mesh,
                               const std::vector<std::uint32_t>& first) {
    bench::DisjointSets sets(first.size());
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        sets.join(first[mesh.indices[t]], first[mesh.indices[t + 1]]);
        sets.join(first[mesh.indices[t]], first[mesh.indices[t + 2]]);
    }
    return sets;
}

ordered_json check(const bench::PlainMesh& original, const bench::PlainMesh& simplified,
                   const ordered_json& lost) {
    const std::vector<std::uint32_t> first = bench::first_at_position(original);
    bench::DisjointSets sets = components(original, first);
    const std::vector<std::uint32_t> used = used_vertices(original, first);
    std::map<std::uint32_t, Part> parts;
    std::vector<float> coordinates;
    for (const std::uint32_t v : used) {
        const Point p = point(original, v);
        parts[sets.root(v)].add(p);
        coordinates.insert(coordinates.end(), p.begin(), p.end());
    }
    flann::KDTreeSingleIndex<flann::L2_3D<float>> index(
        flann::Matrix<float>(coordinates.data(), used.size(), 3),
        flann::KDTreeSingleIndexParams(16));
    index.buildIndex();
    const std::vector<std::uint32_t> first_simplified = bench::first_at_position(simplified);
    bench::DisjointSets after = components(simplified, first_simplified);
    std::map<std::uint32_t, Component> components_after;
    for (const std::uint32_t v : used_vertices(simplified, first_simplified)) {
        Point p = point(simplified, v);
        std::size_t nearest = 0;
        float squared = 0;
        flann::Matrix<std::size_t> indices(&nearest, 1, 1);
        flann::Matrix<float> distances(&squared, 1, 1);
        index.knnSearch(flann::Matrix<float>(p.data(), 1, 3), indices, distances, 1,
                        flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
        components_after[after.root(v)].add(p, sets.root(used[nearest]));
    }
    assign(components_after, parts);
    std::uint64_t n_missing = 0;
    std::uint64_t n_told = 0;
    double largest = 0;
    for (const auto& [root, part] : parts) {
        if (part.is_there) continue;
        ++n_missing;
        const bool is_told = std::any_of(lost.begin(), lost.end(), [&](const ordered_json& place) {
            const auto center = place.at("center").get<std::array<double, 3>>();
            return part.distance(center) <= place.at("size").get<double>() / 2;
        });
        if (is_told) {
            ++n_told;
        } else {
            largest = std::max(largest, part.size());
        }
    }
    return {{"parts", parts.size()},
            {"missing", n_missing},
            {"told", n_told},
            {"untold", n_missing - n_told},
            {"largest_untold", largest}};
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc != 4) {
            std::fprintf(stderr, "usage: part_check ORIGINAL.ply SIMPLIFIED.ply REPORT.json\n");
            return 2;
        }
        std::ifstream file(argv[3]);
        const ordered_json report = ordered_json::parse(file);
        const ordered_json result =
            check(bench::read_plain_ply(argv[1]), bench::read_plain_ply(argv[2]),
                  report.at("lods").at(0).at("lost").at("list"));
        std::printf("%s\n", result.dump(2).c_str());
    } catch (const std::exception& e) {
        std::fprintf(stderr, "part_check: %s\n", e.what());
        return 1;
    }
    return 0;
}

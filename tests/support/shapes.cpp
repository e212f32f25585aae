// SPDX-License-Identifier: MIT
#include "shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "ooc/vec3.h"

namespace hewer::test {

namespace {

double ratio(std::uint64_t i, std::uint64_t n) {
    return static_cast<double>(i) / static_cast<double>(n);
}

/// Two triangles for each square of a grid; id(i, j) names its corners.
template <typename Id>
void add_squares(Mesh& mesh, std::uint64_t n, std::uint64_t m, const Id& id) {
    for (std::uint64_t i = 0; i < n; ++i) {
        for (std::uint64_t j = 0; j < m; ++j) {
            mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
            mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
        }
    }
}

template <typename T>
void shuffle(std::vector<T>& list, Random& random) {
    for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[random.below(i)]);
}

}  // namespace

std::uint64_t Random::next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
}

Mesh cube(std::uint64_t n) {
    Mesh mesh;
    std::map<std::array<std::uint64_t, 3>, std::uint64_t> ids;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const std::uint64_t side : {std::uint64_t{0}, n}) {
            const auto id = [&](std::uint64_t i, std::uint64_t j) {
                if (side == 0) std::swap(i, j);  // outward on both sides
                std::array<std::uint64_t, 3> at{};
                at[axis] = side;
                at[(axis + 1) % 3] = i;
                at[(axis + 2) % 3] = j;
                const auto [found, is_new] = ids.try_emplace(at, mesh.positions.size());
                if (is_new) {
                    mesh.positions.push_back({2 * ratio(at[0], n) - 1, 2 * ratio(at[1], n) - 1,
                                              2 * ratio(at[2], n) - 1});
                }
                return found->second;
            };
            add_squares(mesh, n, n, id);
        }
    }
    return mesh;
}

Mesh cube_sphere(std::uint64_t n, double noise, std::uint64_t seed) {
    Mesh mesh = cube(n);
    Random random(seed);
    for (Vec3& p : mesh.positions) {
        // Equal angles instead of equal steps, so that triangles are of like size.
        for (double& x : p) x = std::tan(x * std::numbers::pi / 4);
        p = ((1 + random.between(-noise, noise)) / std::sqrt(dot(p, p))) * p;
    }
    return mesh;
}

Mesh torus(std::uint64_t n_major, std::uint64_t n_minor, double thickness) {
    Mesh mesh;
    for (std::uint64_t i = 0; i < n_major; ++i) {
        for (std::uint64_t j = 0; j < n_minor; ++j) {
            const double u = 2 * std::numbers::pi * ratio(i, n_major);
            const double v = 2 * std::numbers::pi * ratio(j, n_minor);
            const double r = 1 + thickness * std::cos(v);
            mesh.positions.push_back({r * std::cos(u), r * std::sin(u), thickness * std::sin(v)});
        }
    }
    add_squares(mesh, n_major, n_minor, [&](std::uint64_t i, std::uint64_t j) {
        return (i % n_major) * n_minor + j % n_minor;
    });
    return mesh;
}

Mesh plane_grid(std::uint64_t n, double noise, std::uint64_t seed) {
    Mesh mesh;
    Random random(seed);
    for (std::uint64_t i = 0; i <= n; ++i) {
        for (std::uint64_t j = 0; j <= n; ++j) {
            const bool is_inner = i > 0 && j > 0 && i < n && j < n;
            const double z = random.between(-noise, noise);
            mesh.positions.push_back({ratio(i, n), ratio(j, n), is_inner ? z : 0});
        }
    }
    add_squares(mesh, n, n, [&](std::uint64_t i, std::uint64_t j) { return i * (n + 1) + j; });
    return mesh;
}

Mesh two_sheets(std::uint64_t n, double gap) {
    return joined(with_turned_triangles(plane_grid(n), 1, 1),
                  translated(plane_grid(n), {0, 0, gap}));
}

Mesh many_spheres(std::uint64_t k, std::uint64_t n) {
    Mesh mesh;
    const Mesh one = scaled(cube_sphere(n), {0.4, 0.4, 0.4});
    for (std::uint64_t i = 0; i < k * k * k; ++i) {
        const std::uint64_t row = i / k;
        const std::uint64_t layer = row / k;
        const Vec3 center{static_cast<double>(i % k), static_cast<double>(row % k),
                          static_cast<double>(layer)};
        mesh = joined(std::move(mesh), translated(one, center));
    }
    return mesh;
}

Mesh book(std::uint64_t n_pages, std::uint64_t n) {
    Mesh mesh;
    for (std::uint64_t j = 0; j <= n; ++j) mesh.positions.push_back({0, 0, ratio(j, n)});
    for (std::uint64_t page = 0; page < n_pages; ++page) {
        const double angle = 2 * std::numbers::pi * ratio(page, n_pages) + 0.1;
        const std::uint64_t first = mesh.positions.size();
        for (std::uint64_t i = 1; i <= n; ++i) {
            for (std::uint64_t j = 0; j <= n; ++j) {
                mesh.positions.push_back(
                    {ratio(i, n) * std::cos(angle), ratio(i, n) * std::sin(angle), ratio(j, n)});
            }
        }
        add_squares(mesh, n, n, [&](std::uint64_t i, std::uint64_t j) {
            return i == 0 ? j : first + (i - 1) * (n + 1) + j;
        });
    }
    return mesh;
}

Mesh moebius_strip(std::uint64_t n_around, std::uint64_t n_across) {
    Mesh mesh;
    for (std::uint64_t i = 0; i < n_around; ++i) {
        for (std::uint64_t j = 0; j <= n_across; ++j) {
            const double turn = 2 * std::numbers::pi * ratio(i, n_around);
            const double w = ratio(j, n_across) - 0.5;
            const double r = 1 + w * std::cos(turn / 2);
            mesh.positions.push_back(
                {r * std::cos(turn), r * std::sin(turn), w * std::sin(turn / 2)});
        }
    }
    add_squares(mesh, n_around, n_across, [&](std::uint64_t i, std::uint64_t j) {
        return i == n_around ? n_across - j : i * (n_across + 1) + j;
    });
    return mesh;
}

Mesh random_soup(std::uint64_t n_vertices, std::uint64_t n_triangles, std::uint64_t seed) {
    Mesh mesh;
    Random random(seed);
    for (std::uint64_t i = 0; i < n_vertices; ++i) {
        mesh.positions.push_back({random.unit(), random.unit(), random.unit()});
    }
    while (mesh.triangles.size() < n_triangles) {
        mesh.triangles.push_back(
            {random.below(n_vertices), random.below(n_vertices), random.below(n_vertices)});
    }
    return mesh;
}

Mesh shuffled(const Mesh& mesh, std::uint64_t seed) {
    Random random(seed);
    std::vector<std::uint64_t> old_of_new(mesh.positions.size());
    std::iota(old_of_new.begin(), old_of_new.end(), 0U);
    shuffle(old_of_new, random);
    Mesh result;
    std::vector<std::uint64_t> new_of_old(old_of_new.size());
    for (std::uint64_t i = 0; i < old_of_new.size(); ++i) {
        new_of_old[old_of_new[i]] = i;
        result.positions.push_back(mesh.positions[old_of_new[i]]);
        if (!mesh.normals.empty()) result.normals.push_back(mesh.normals[old_of_new[i]]);
        if (!mesh.colors.empty()) result.colors.push_back(mesh.colors[old_of_new[i]]);
    }
    for (const Triangle& t : mesh.triangles) {
        Triangle turned{new_of_old[t[0]], new_of_old[t[1]], new_of_old[t[2]]};
        std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(random.below(3)),
                    turned.end());
        result.triangles.push_back(turned);
    }
    shuffle(result.triangles, random);
    return result;
}

Mesh with_turned_triangles(Mesh mesh, double share, std::uint64_t seed) {
    Random random(seed);
    for (Triangle& t : mesh.triangles) {
        if (random.unit() < share) std::swap(t[1], t[2]);
    }
    return mesh;
}

Mesh translated(Mesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.positions) p = p + by;
    return mesh;
}

Mesh scaled(Mesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.positions) p = {p[0] * by[0], p[1] * by[1], p[2] * by[2]};
    return mesh;
}

Mesh joined(Mesh a, const Mesh& b) {
    const std::uint64_t n = a.positions.size();
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
    a.colors.insert(a.colors.end(), b.colors.begin(), b.colors.end());
    if (a.normals.size() != a.positions.size()) a.normals.clear();
    if (a.colors.size() != a.positions.size()) a.colors.clear();
    for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    return a;
}

Mesh rounded(Mesh mesh) {
    for (Vec3& p : mesh.positions) {
        for (double& x : p) x = std::round(x * 0x1p20) * 0x1p-20;
    }
    return mesh;
}

Rgba16 color_at(const Vec3& position) {
    Rgba16 color{0, 0, 0, 65535};
    for (std::size_t i = 0; i < 3; ++i) {
        color[i] =
            static_cast<std::uint16_t>(std::clamp(32768 + 20000 * position[i], 0.0, 65535.0));
    }
    return color;
}

Mesh with_colors(Mesh mesh) {
    mesh.colors.clear();
    for (const Vec3& p : mesh.positions) mesh.colors.push_back(color_at(p));
    return mesh;
}

Mesh with_radial_normals(Mesh mesh) {
    mesh.normals.clear();
    for (const Vec3& p : mesh.positions) {
        const Vec3 n = (1 / std::sqrt(dot(p, p))) * p;
        mesh.normals.push_back(
            {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    }
    return mesh;
}

}  // namespace hewer::test

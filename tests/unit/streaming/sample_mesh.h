// SPDX-License-Identifier: MIT
/// A wavy sheet with attributes, and how to pour a Mesh into a sink.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"

namespace hewer::tests {

/// n x n vertices over a square of edge `size` at `origin`; normals of the wave; colours that take
/// every 8-bit value when n is large enough; alpha as given.
inline Mesh wavy_sheet(std::uint64_t n, double size, const Vec3& origin,
                       std::uint16_t alpha = 65535) {
    Mesh mesh;
    const double step = size / static_cast<double>(n - 1);
    for (std::uint64_t j = 0; j < n; ++j) {
        for (std::uint64_t i = 0; i < n; ++i) {
            const double x = static_cast<double>(i) * step;
            const double y = static_cast<double>(j) * step;
            const double phase = 7 * x / size + 3 * y / size;
            mesh.positions.push_back(
                {origin[0] + x, origin[1] + y, origin[2] + 0.05 * size * std::sin(phase)});
            const double slope = 0.05 * std::cos(phase);
            const double length = std::hypot(7 * slope, 3 * slope, 1.0);
            mesh.normals.push_back({static_cast<float>(-7 * slope / length),
                                    static_cast<float>(-3 * slope / length),
                                    static_cast<float>(1 / length)});
            const std::uint64_t k = j * n + i;
            const auto channel = [&](std::uint64_t v) {
                return static_cast<std::uint16_t>(v % 256 * 257);
            };
            mesh.colors.push_back({channel(k), channel(3 * k + 1), channel(255 - k % 256), alpha});
        }
    }
    for (std::uint64_t j = 0; j + 1 < n; ++j) {
        for (std::uint64_t i = 0; i + 1 < n; ++i) {
            const std::uint64_t a = j * n + i;
            mesh.triangles.push_back({a, a + 1, a + n});
            mesh.triangles.push_back({a + 1, a + n + 1, a + n});
        }
    }
    return mesh;
}

inline SinkHeader header_of(const Mesh& mesh) {
    SinkHeader header;
    header.n_vertices = mesh.positions.size();
    header.n_triangles = mesh.triangles.size();
    header.has_normals = !mesh.normals.empty();
    header.has_colors = !mesh.colors.empty();
    header.has_alpha = std::any_of(mesh.colors.begin(), mesh.colors.end(),
                                   [](const Rgba16& c) { return c[3] != 65535; });
    for (const Vec3& p : mesh.positions) header.bounds.extend(p);
    header.has_double_positions = true;
    return header;
}

/// In two uneven parts each, so that batches must not matter.
inline void pour(const Mesh& mesh, MeshSink& sink) {
    sink.begin(header_of(mesh));
    const std::size_t half = mesh.positions.size() / 3;
    for (const auto& [first, count] :
         {std::pair(std::size_t{0}, half), std::pair(half, mesh.positions.size() - half)}) {
        VertexSpan span;
        span.positions = std::span(mesh.positions).subspan(first, count);
        if (!mesh.normals.empty()) span.normals = std::span(mesh.normals).subspan(first, count);
        if (!mesh.colors.empty()) span.colors = std::span(mesh.colors).subspan(first, count);
        sink.add_vertices(span);
    }
    const std::size_t third = mesh.triangles.size() / 3;
    sink.add_triangles(std::span(mesh.triangles).first(third));
    sink.add_triangles(std::span(mesh.triangles).subspan(third));
    sink.finish();
}

}  // namespace hewer::tests

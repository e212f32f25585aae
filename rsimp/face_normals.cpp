// SPDX-License-Identifier: MIT
#include "rsimp/face_normals.h"

#include "ooc/spool_cache.h"
#include "ooc/vec3.h"

namespace hewer::rsimp {

bool is_usable_normal(const std::array<float, 3>& sum) {
    constexpr float kLeastLengthSquared = 1e-6F;
    return sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2] > kLeastLengthSquared;
}

std::unordered_map<std::uint32_t, std::array<float, 3>> missing_normals(
    const MeshStore& mesh, const ooc::Spool<std::array<std::uint32_t, 3>>& faces) {
    std::unordered_map<std::uint32_t, std::array<float, 3>> normals;
    std::uint32_t index = 0;
    ooc::SpoolReader<cluster::CellAttributes> attributes(mesh.attributes);
    while (const cluster::CellAttributes* a = attributes.next()) {
        if (!is_usable_normal(a->normal)) normals[index] = {};
        ++index;
    }
    if (normals.empty()) return normals;
    ooc::SpoolCache<StoredVertex> vertices(mesh.vertices);
    ooc::SpoolReader<std::array<std::uint32_t, 3>> reader(faces);
    while (const auto* t = reader.next()) {
        for (const std::uint32_t v : *t) {
            const auto it = normals.find(v);
            if (it == normals.end()) continue;
            const Vec3 p = vertices.at((*t)[0]).vertex.position;
            const Vec3 q = vertices.at((*t)[1]).vertex.position;
            const Vec3 r = vertices.at((*t)[2]).vertex.position;
            const Vec3 normal = cross(q - p, r - p);
            for (std::size_t i = 0; i < 3; ++i) it->second[i] += static_cast<float>(normal[i]);
        }
    }
    return normals;
}

}  // namespace hewer::rsimp

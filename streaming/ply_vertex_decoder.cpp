// SPDX-License-Identifier: MIT
#include "streaming/ply_vertex_decoder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "streaming/nonfinite.h"

namespace hewer::streaming {

namespace {

/// As types.h says for 8-bit, 16-bit and floating-point colours. Signed types carry the same bytes
/// by mistake of their writer; 32-bit and 64-bit integers are taken to count 0..255 as well.
template <typename T>
std::uint16_t to_color16(T value) {
    if constexpr (std::is_floating_point_v<T>) {
        // Written so that NaN becomes 0.
        const double v = static_cast<double>(value);
        return static_cast<std::uint16_t>(std::lround((v > 0 ? std::min(v, 1.0) : 0.0) * 65535.0));
    } else if constexpr (sizeof(T) == 1) {
        return static_cast<std::uint16_t>(static_cast<std::uint8_t>(value) * 257U);
    } else if constexpr (sizeof(T) == 2) {
        return static_cast<std::uint16_t>(value);
    } else {
        return static_cast<std::uint16_t>(std::clamp<T>(value, 0, 255) * T{257});
    }
}

/// Calls row(i, value) for one column.
template <typename Row>
void for_column(const PlyField& field, const PackedRows& rows, const Row& row) {
    with_scalar_type(field.type, [&](auto tag) {
        using T = typename decltype(tag)::Type;
        const unsigned char* p = rows.data + field.offset;
        if (rows.swap) {
            for (std::size_t i = 0; i < rows.n; ++i) row(i, load<T, true>(p + i * rows.stride));
        } else {
            for (std::size_t i = 0; i < rows.n; ++i) row(i, load<T, false>(p + i * rows.stride));
        }
    });
}

template <typename T, bool Swap>
NonfiniteProbe decode_xyz(const unsigned char* p, std::size_t stride, std::size_t n, Vec3* out) {
    NonfiniteProbe probe;
    for (std::size_t i = 0; i < n; ++i, p += stride) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double value = static_cast<double>(load<T, Swap>(p + axis * sizeof(T)));
            out[i][axis] = value;
            probe.add(value);
        }
    }
    return probe;
}

template <typename T>
NonfiniteProbe decode_xyz(const PlyVertexFields& fields, const PackedRows& rows, Vec3* out) {
    const unsigned char* p = rows.data + fields.position[0].offset;
    return rows.swap ? decode_xyz<T, true>(p, rows.stride, rows.n, out)
                     : decode_xyz<T, false>(p, rows.stride, rows.n, out);
}

NonfiniteProbe decode_positions(const PlyVertexFields& fields, const PackedRows& rows, Vec3* out) {
    const auto& [x, y, z] = fields.position;
    const bool is_together = x.type == y.type && x.type == z.type &&
                             y.offset == x.offset + byte_size(x.type) &&
                             z.offset == y.offset + byte_size(y.type);
    if (is_together && x.type == ScalarType::Float32) return decode_xyz<float>(fields, rows, out);
    if (is_together && x.type == ScalarType::Float64) return decode_xyz<double>(fields, rows, out);
    NonfiniteProbe probe;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for_column(fields.position[axis], rows, [&](std::size_t i, auto value) {
            out[i][axis] = static_cast<double>(value);
            probe.add(out[i][axis]);
        });
    }
    return probe;
}

bool is_finite(const Vec3& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

}  // namespace

std::size_t decode_vertices(const PlyVertexFields& fields, const PackedRows& rows,
                            VertexBatch& batch) {
    batch.positions.resize(rows.n);
    batch.normals.resize(fields.normal ? rows.n : 0);
    batch.colors.resize(fields.color ? rows.n : 0);
    batch.weights.resize(fields.weight ? rows.n : 0);
    const NonfiniteProbe probe = decode_positions(fields, rows, batch.positions.data());
    if (fields.normal) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for_column((*fields.normal)[axis], rows, [&](std::size_t i, auto value) {
                batch.normals[i][axis] = static_cast<float>(value);
            });
        }
    }
    if (fields.color) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            for_column((*fields.color)[channel], rows, [&](std::size_t i, auto value) {
                batch.colors[i][channel] = to_color16(value);
            });
        }
        if (fields.alpha) {
            for_column(*fields.alpha, rows,
                       [&](std::size_t i, auto value) { batch.colors[i][3] = to_color16(value); });
        } else {
            for (Rgba16& color : batch.colors) color[3] = 65535;
        }
    }
    if (fields.weight) {
        for_column(*fields.weight, rows, [&](std::size_t i, auto value) {
            batch.weights[i] = static_cast<float>(value);
        });
    }
    if (!probe.any()) return rows.n;

    std::size_t first = rows.n;
    for (std::size_t i = rows.n; i-- > 0;) {
        if (is_finite(batch.positions[i])) continue;
        ++batch.defects.nonfinite_vertices;
        first = i;
    }
    return first;
}

}  // namespace hewer::streaming

// SPDX-License-Identifier: MIT
#include "streaming/draco_arrays.h"

#include <draco/compression/decode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/memory_budget.h"
#include "ooc/units.h"
#include "streaming/draco_header.h"
#include "streaming/temporary_input.h"

namespace hewer::streaming {

namespace {

// Measured on closed meshes with positions and normals, rounded up.
constexpr std::uint64_t kBytesPerFace = 200;
// Each corner a point of its own; more are believed to cost something only in damaged files.
constexpr std::uint64_t kPointsPerFace = 3;
constexpr std::uint64_t kPiece = 4096;
constexpr double kFullScale = 65535;

/// Writes records of `n` elements, made by fill(first, piece), behind what is there.
template <typename Record, typename Fill>
std::uint64_t write_array(TemporaryInput& out, std::uint64_t n, const Fill& fill) {
    const std::uint64_t offset = out.size();
    std::vector<Record> piece(std::min(n, kPiece));
    for (std::uint64_t first = 0; first < n; first += kPiece) {
        const std::uint64_t count = std::min(kPiece, n - first);
        for (std::uint64_t i = 0; i < count; ++i) piece[i] = fill(first + i);
        out.append(piece.data(), count * sizeof(Record));
    }
    return offset;
}

/// An attribute of numbers, if there is one. Truth values are none: Draco reads any byte as a bool.
const draco::PointAttribute* numbers(const draco::PointAttribute* attribute) {
    const bool is_number = attribute != nullptr && attribute->data_type() != draco::DT_BOOL;
    return is_number ? attribute : nullptr;
}

const draco::PointAttribute* find(const draco::Mesh& mesh, const std::optional<std::uint32_t>& id) {
    return id ? numbers(mesh.GetAttributeByUniqueId(*id)) : nullptr;
}

const draco::PointAttribute* find(const draco::Mesh& mesh, const std::optional<std::uint32_t>& id,
                                  draco::GeometryAttribute::Type type) {
    return id ? find(mesh, id) : numbers(mesh.GetNamedAttribute(type));
}

template <std::size_t N>
std::array<float, N> read_floats(const draco::PointAttribute& attribute, std::uint64_t point) {
    std::array<float, N> value{};
    const draco::PointIndex index(static_cast<std::uint32_t>(point));
    attribute.ConvertValue<float>(attribute.mapped_index(index), N, value.data());
    return value;
}

Rgba16 read_color(const draco::PointAttribute& attribute, std::uint64_t point) {
    std::array<float, 4> value{0, 0, 0, 1};
    const auto n = static_cast<std::int8_t>(std::min<int>(4, attribute.num_components()));
    const draco::PointIndex index(static_cast<std::uint32_t>(point));
    attribute.ConvertValue<float>(attribute.mapped_index(index), n, value.data());
    // Integers that are not marked as normalised come as they are.
    double scale = 1;
    if (!attribute.normalized()) {
        if (attribute.data_type() == draco::DT_UINT8) scale = 1.0 / 255;
        if (attribute.data_type() == draco::DT_UINT16) scale = 1.0 / kFullScale;
    }
    Rgba16 color{0, 0, 0, 65535};
    for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) {
        const double x = std::clamp(scale * static_cast<double>(value[k]), 0.0, 1.0);
        color[k] = static_cast<std::uint16_t>(std::lround(x * kFullScale));
    }
    return color;
}

std::unique_ptr<draco::Mesh> decode(std::span<const char> bytes, const std::string& place) {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
    if (type.ok() && type.value() == draco::POINT_CLOUD) {
        throw FormatError(place + "this is a point cloud, which has no triangles");
    }
    draco::Decoder decoder;
    auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    if (!mesh.ok()) {
        throw FormatError(place + "the Draco data is damaged (" + mesh.status().error_msg_string() +
                          ")");
    }
    return std::move(mesh).value();
}

void require_whole(const draco::Mesh& mesh, const draco::PointAttribute* positions,
                   const std::string& place) {
    if (positions == nullptr || positions->num_components() < 3) {
        throw FormatError(place + "the Draco data has no positions");
    }
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
        for (const draco::PointIndex& p : mesh.face(draco::FaceIndex(f))) {
            if (p.value() >= mesh.num_points()) {
                throw FormatError(place + "the Draco data is damaged (a corner of face " +
                                  std::to_string(f) + " is no point)");
            }
        }
    }
}

}  // namespace

ArrayMesh decode_draco(const ooc::InputFile& file, std::uint64_t offset, std::uint64_t n_bytes,
                       const DracoIds& ids, const OpenOptions& options) {
    const std::string place = file.path().string() + ": byte " + std::to_string(offset) + ": ";
    ooc::MemoryBudget budget(options.memory_bytes != 0 ? options.memory_bytes
                                                       : ooc::default_memory_limit());
    const auto need = [&](std::uint64_t bytes) {
        if (bytes <= budget.available()) return budget.reserve("Draco data", bytes);
        const std::string enough = std::to_string(((budget.used() + bytes) >> 20) + 1) + " MiB";
        throw OutOfMemoryBudget(place + "Draco data is decoded as a whole, which needs " + enough +
                                "; the limit is " + ooc::format_bytes(budget.limit()) +
                                "; raise --memory to " + enough +
                                " or more, or decode it to PLY first");
    };
    const ooc::Reservation encoded = need(n_bytes);
    std::vector<char> bytes(n_bytes);
    bytes.resize(file.read_at(offset, bytes.data(), n_bytes));
    // Data that ends within its header is nothing to decode.
    const DracoCounts announced = announced_counts(bytes).value_or(DracoCounts{});
    const ooc::Reservation decoded =
        need(kBytesPerFace * std::max(announced.n_faces, announced.n_points / kPointsPerFace));
    try {
        const std::unique_ptr<draco::Mesh> mesh = decode(bytes, place);
        const auto* const positions =
            find(*mesh, ids.positions, draco::GeometryAttribute::POSITION);
        require_whole(*mesh, positions, place);
        const auto* const normals = find(*mesh, ids.normals, draco::GeometryAttribute::NORMAL);
        const auto* const colors = find(*mesh, ids.colors, draco::GeometryAttribute::COLOR);
        const auto* const texcoords = find(*mesh, ids.texcoords);
        const auto* const weights = find(*mesh, ids.weights);
        TemporaryInput out(options);
        ArrayMesh arrays;
        const std::uint64_t n = mesh->num_points();
        arrays.positions.offset = write_array<std::array<float, 3>>(
            out, n, [&](std::uint64_t i) { return read_floats<3>(*positions, i); });
        arrays.positions.count = n;
        if (normals != nullptr && normals->num_components() == 3) {
            arrays.normals.offset = write_array<std::array<float, 3>>(
                out, n, [&](std::uint64_t i) { return read_floats<3>(*normals, i); });
            arrays.normals.count = n;
        }
        if (colors != nullptr && colors->num_components() >= 3) {
            arrays.colors.offset = write_array<Rgba16>(
                out, n, [&](std::uint64_t i) { return read_color(*colors, i); });
            arrays.colors.count = n;
        }
        if (texcoords != nullptr && texcoords->num_components() == 2) {
            arrays.texcoords.offset = write_array<std::array<float, 2>>(
                out, n, [&](std::uint64_t i) { return read_floats<2>(*texcoords, i); });
            arrays.texcoords.count = n;
        }
        if (weights != nullptr && weights->num_components() == 1) {
            arrays.weights.offset = write_array<std::array<float, 1>>(
                out, n, [&](std::uint64_t i) { return read_floats<1>(*weights, i); });
            arrays.weights.count = n;
        }
        arrays.indices.offset = write_array<
            std::array<std::uint32_t, 3>>(out, mesh->num_faces(), [&](std::uint64_t i) {
            const draco::Mesh::Face& face =
                mesh->face(draco::FaceIndex(static_cast<std::uint32_t>(i)));
            return std::array<std::uint32_t, 3>{face[0].value(), face[1].value(), face[2].value()};
        });
        arrays.indices.count = 3 * std::uint64_t{mesh->num_faces()};
        arrays.held_temp_bytes = out.size();
        const std::shared_ptr<const ooc::InputFile> written = out.finish(file.path());
        for (StridedArray* a : {&arrays.positions, &arrays.normals}) {
            *a = {written, a->offset, 12, a->count, 3, ScalarType::Float32, false};
        }
        arrays.colors = {written, arrays.colors.offset, 8,   arrays.colors.count,
                         4,       ScalarType::UInt16,   true};
        arrays.texcoords = {written, arrays.texcoords.offset, 8,    arrays.texcoords.count,
                            2,       ScalarType::Float32,     false};
        arrays.weights = {written, arrays.weights.offset, 4,    arrays.weights.count,
                          1,       ScalarType::Float32,   false};
        arrays.indices = {written, arrays.indices.offset, 4,    arrays.indices.count,
                          1,       ScalarType::UInt32,    false};
        return arrays;
    } catch (const std::bad_alloc&) {
        throw FormatError(place + "the Draco data asks for more memory than there is; damaged?");
    }
}

std::unique_ptr<MeshSource> open_draco(std::unique_ptr<ooc::InputFile> file,
                                       const OpenOptions& options) {
    ArrayMesh mesh = decode_draco(*file, 0, file->size(), {}, options);
    mesh.name = file->path().string();
    mesh.format = "Draco";
    mesh.n_bytes = file->size();
    if (mesh.indices.count == 0) {
        throw FormatError(mesh.name + ": the mesh has no faces");
    }
    return open_arrays(std::move(mesh), options.strict);
}

}  // namespace hewer::streaming

// SPDX-License-Identifier: MIT
#include "streaming/draco_encoder.h"

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include <array>
#include <utility>

#include "hewer/error.h"

namespace hewer::streaming {

namespace {

constexpr int kNormalBits = 10;

int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, std::uint8_t n,
                  draco::DataType data_type, bool is_normalized, std::int64_t bytes) {
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, n, data_type, is_normalized, bytes, 0);
    return mesh.AddAttribute(attribute, true, mesh.num_points());
}

}  // namespace

struct DracoEncoder::State {
    draco::Mesh mesh;
    Vec3 origin{};
    int positions = -1;
    int normals = -1;
    int colors = -1;
    std::uint32_t n_vertices = 0;
    std::uint32_t n_triangles = 0;
};

DracoEncoder::DracoEncoder(const SinkHeader& header, const Vec3& origin)
    : state_(std::make_unique<State>()) {
    draco::Mesh& mesh = state_->mesh;
    state_->origin = origin;
    mesh.set_num_points(static_cast<std::uint32_t>(header.n_vertices));
    mesh.SetNumFaces(header.n_triangles);
    state_->positions =
        add_attribute(mesh, draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, false, 12);
    if (header.has_normals) {
        state_->normals =
            add_attribute(mesh, draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32, false, 12);
    }
    if (header.has_colors) {
        state_->colors =
            add_attribute(mesh, draco::GeometryAttribute::COLOR, 4, draco::DT_UINT16, true, 8);
    }
}

DracoEncoder::~DracoEncoder() = default;
DracoEncoder::DracoEncoder(DracoEncoder&&) noexcept = default;

void DracoEncoder::add_vertices(const VertexSpan& v) {
    State& s = *state_;
    for (std::size_t i = 0; i < v.positions.size(); ++i) {
        const draco::AttributeValueIndex at(s.n_vertices++);
        std::array<float, 3> p{};
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = static_cast<float>(v.positions[i][k] - s.origin[k]);
        }
        s.mesh.attribute(s.positions)->SetAttributeValue(at, p.data());
        if (s.normals >= 0) {
            s.mesh.attribute(s.normals)->SetAttributeValue(at, v.normals[i].data());
        }
        if (s.colors >= 0) s.mesh.attribute(s.colors)->SetAttributeValue(at, v.colors[i].data());
    }
}

void DracoEncoder::add_triangles(std::span<const Triangle> triangles) {
    State& s = *state_;
    for (const Triangle& t : triangles) {
        s.mesh.SetFace(draco::FaceIndex(s.n_triangles++),
                       {draco::PointIndex(static_cast<std::uint32_t>(t[0])),
                        draco::PointIndex(static_cast<std::uint32_t>(t[1])),
                        draco::PointIndex(static_cast<std::uint32_t>(t[2]))});
    }
}

DracoEncoder::Encoded DracoEncoder::encode(unsigned position_bits) {
    State& s = *state_;
    draco::Encoder encoder;
    encoder.SetTrackEncodedProperties(true);
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    if (position_bits > 0) {
        encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION,
                                         static_cast<int>(position_bits));
    }
    encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, kNormalBits);
    draco::EncoderBuffer buffer;
    const draco::Status status = encoder.EncodeMeshToBuffer(s.mesh, &buffer);
    if (!status.ok()) throw InternalError("Draco: " + status.error_msg_string());
    Encoded encoded;
    encoded.bytes.assign(buffer.data(), buffer.data() + buffer.size());
    encoded.n_points = encoder.num_encoded_points();
    encoded.n_faces = encoder.num_encoded_faces();
    const auto id_of = [&](int attribute) {
        return attribute >= 0 ? s.mesh.attribute(attribute)->unique_id() : 0;
    };
    encoded.position_id = id_of(s.positions);
    encoded.normal_id = id_of(s.normals);
    encoded.color_id = id_of(s.colors);
    return encoded;
}

}  // namespace hewer::streaming

// SPDX-License-Identifier: MIT
#include "streaming/findings.h"

#include "hewer/error.h"

namespace hewer::streaming {

namespace {
std::string name_element(const char* kind, std::uint64_t number, const std::string& place) {
    return std::string(kind) + " " + std::to_string(number) + " (" + place + ")";
}
}  // namespace

void FindingsReporter::report_nonfinite(VertexBatch& batch, std::uint64_t vertex,
                                        const Place& place) const {
    batch.defects.first_nonfinite = name_element("vertex", vertex, place());
    if (is_strict_) refuse(batch.defects.first_nonfinite, "a coordinate is not finite");
}

void FindingsReporter::report_faces(const FaceFindings& findings, TriangleBatch& batch,
                                    std::uint64_t n_vertices,
                                    const std::function<std::string(std::uint64_t)>& place) const {
    batch.defects.polygons = findings.n_polygons;
    batch.defects.short_faces = findings.n_short;
    batch.defects.out_of_range_triangles = findings.n_out_of_range;
    const auto name = [&](std::uint64_t row) {
        return name_element("face", batch.first_face + row, place(row));
    };
    if (findings.n_out_of_range > 0) {
        batch.defects.first_out_of_range = name(findings.first_out_of_range_row);
        if (is_strict_) {
            refuse(batch.defects.first_out_of_range,
                   "a vertex id outside the " + std::to_string(n_vertices) + " vertices");
        }
    }
    if (is_strict_ && findings.n_short > 0) {
        refuse(name(findings.first_short_row), "fewer than three corners");
    }
}

void FindingsReporter::report_nonfinite(TriangleBatch& batch, std::uint64_t triangle,
                                        const Place& place) const {
    if (batch.defects.nonfinite_triangles++ > 0) return;
    batch.defects.first_nonfinite = name_element("triangle", triangle, place());
    if (is_strict_) refuse(batch.defects.first_nonfinite, "a coordinate is not finite");
}

void FindingsReporter::refuse(const std::string& element, const std::string& what) const {
    throw FormatError(path_ + ": " + element + ": " + what + "; strict mode refuses it");
}

}  // namespace hewer::streaming

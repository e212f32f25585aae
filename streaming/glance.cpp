// SPDX-License-Identifier: MIT
#include "streaming/glance.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <utility>

#include "hewer/error.h"
#include "ooc/file.h"
#include "streaming/draco_header.h"
#include "streaming/file_format.h"
#include "streaming/gltf_reader.h"
#include "streaming/off_header.h"
#include "streaming/ply_header.h"
#include "streaming/ply_layout.h"
#include "streaming/ply_reader.h"
#include "streaming/stl_reader.h"
#include "streaming/text_sample.h"
#include "streaming/unpack.h"

namespace hewer::streaming {

namespace {

// Compressed data against what it unpacks to, about.
constexpr std::uint64_t kUnpacked = 4;
constexpr std::uint64_t kUnpackedBytes = 1 << 20;
// Of a sample of vertices, for their box.
constexpr std::uint64_t kPieces = 64;
constexpr std::uint64_t kPieceVertices = 1 << 12;

void take(const SourceInfo& info, InputReport& report) {
    report.format = info.format;
    report.vertices = info.n_vertices;
    report.faces = info.n_faces;
    report.triangles = info.n_faces;
    report.has_normals = info.has_normals;
    report.has_colors = info.has_colors;
    report.ignored = info.ignored;
}

/// Pieces at equal distances, where vertices can be reached without reading those in front.
Bounds sample_box(MeshSource& source) {
    Bounds bounds;
    if (!source.can_seek_vertices()) return bounds;
    const std::uint64_t n = source.info().n_vertices;
    const std::uint64_t distance = std::max(n / kPieces, kPieceVertices);
    VertexBatch batch;
    source.begin_vertices();
    for (std::uint64_t first = 0; first < n; first += distance) {
        source.read_vertices(first, std::min(kPieceVertices, n - first), batch);
        for (const Vec3& p : batch.positions) {
            if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) bounds.extend(p);
        }
    }
    return bounds;
}

class Glance {
  public:
    Glance(const std::filesystem::path& path, const OpenOptions& options, const Hooks& hooks)
        : options_(options), hooks_(hooks), file_(std::make_unique<ooc::InputFile>(path)) {
        report_.path = path.string();
        report_.bytes = file_->size();
        report_.basis = InputReport::Basis::Header;
        packing_ = detect_packing(*file_);
        if (packing_ != Packing::None) {
            weight_ = kUnpacked * file_->size();
            return;
        }
        format_ =
            options.format.empty() ? detect_format(*file_) : format_named(options.format, *file_);
        weight_ = file_->size();
        if (format_ == FileFormat::Draco) weight_ *= kUnpacked;
        if (format_ == FileFormat::Gltf || format_ == FileFormat::Glb) {
            const bool is_compressed =
                glance_gltf(std::move(file_), format_ == FileFormat::Glb, options, report_);
            weight_ = (is_compressed ? kUnpacked : 1) * report_.bytes;
        }
    }

    /// Bytes that are to be read, about.
    [[nodiscard]] std::uint64_t weight() const { return weight_; }

    InputReport finish() {
        if (packing_ != Packing::None) {
            look_inside();
        } else {
            look();
        }
        return std::move(report_);
    }

  private:
    void look() {
        switch (format_) {
            case FileFormat::Gltf:
            case FileFormat::Glb:
                break;
            case FileFormat::Ply: {
                PlyHeader header = read_ply_header(*file_);
                const bool is_text = header.encoding == PlyEncoding::Ascii;
                const auto source = open_ply(std::move(file_), std::move(header), options_);
                take(source->info(), report_);
                if (!is_text) report_.bounds = sample_box(*source);
                break;
            }
            case FileFormat::BinaryStl:
                report_.bounds = sample_stl_box(*file_);
                take(open_binary_stl(std::move(file_), options_.strict)->info(), report_);
                break;
            case FileFormat::Off:
                take_off(*file_);
                break;
            case FileFormat::Draco:
                report_.format = "Draco";
                if (const auto counts = announced_counts(*file_)) {
                    report_.vertices = counts->n_points;
                    report_.faces = counts->n_faces;
                    report_.triangles = counts->n_faces;
                } else {
                    report_.basis = InputReport::Basis::Name;
                }
                break;
            case FileFormat::Obj:
                report_.format = "OBJ";
                report_.basis = InputReport::Basis::Sample;
                sample_obj(*file_, report_);
                break;
            case FileFormat::AsciiStl:
                report_.format = "STL, ASCII";
                report_.basis = InputReport::Basis::Sample;
                sample_ascii_stl(*file_, report_);
                break;
            case FileFormat::OpenMesh:
                report_.format = "OpenMesh";
                report_.basis = InputReport::Basis::Name;
                break;
        }
    }

    void take_off(const ooc::InputFile& file) {
        const OffHeader header = read_off_header(file);
        report_.format = header.name;
        report_.vertices = header.n_vertices;
        report_.faces = header.n_faces;
        report_.triangles = header.n_faces;
        report_.has_normals = header.has_normals;
        report_.has_colors = header.has_colors;
    }

    /// The beginning of compressed data.
    void look_inside() {
        const bool is_gzip = packing_ == Packing::Gzip;
        const auto inside = is_gzip ? unpack_gzip(*file_, options_, hooks_, kUnpackedBytes)
                                    : unpack_zstd(*file_, options_, hooks_, kUnpackedBytes);
        const FileFormat format = options_.format.empty() ? detect_format(*inside)
                                                          : format_named(options_.format, *inside);
        if (format == FileFormat::Ply) {
            SourceInfo info;
            plan_ply(read_ply_header(*inside), inside->path(), info);
            take(info, report_);
        } else if (format == FileFormat::Off) {
            take_off(*inside);
        } else {
            report_.basis = InputReport::Basis::Name;
            report_.format = name_of(format);
            for (char& c : report_.format) c = static_cast<char>(std::toupper(c));
        }
        report_.format += is_gzip ? ", gzip" : ", Zstandard";
    }

    const OpenOptions& options_;
    const Hooks& hooks_;
    std::unique_ptr<ooc::InputFile> file_;  // gone where a reader has it
    Packing packing_ = Packing::None;
    FileFormat format_ = FileFormat::Ply;
    std::uint64_t weight_ = 0;
    InputReport report_;
};

void add(const InputReport& part, InputReport& sum) {
    sum.bytes += part.bytes;
    sum.vertices += part.vertices;
    sum.faces += part.faces;
    sum.triangles += part.triangles;
    sum.has_normals = sum.has_normals || part.has_normals;
    sum.has_colors = sum.has_colors || part.has_colors;
    sum.basis = std::max(sum.basis, part.basis);
    sum.bounds.extend(part.bounds);
    if (sum.format != part.format) sum.format = "several formats";
    for (const std::string& what : part.ignored) {
        if (std::find(sum.ignored.begin(), sum.ignored.end(), what) == sum.ignored.end()) {
            sum.ignored.push_back(what);
        }
    }
}

}  // namespace

std::optional<InputReport> glance(const std::vector<std::filesystem::path>& files,
                                  std::uint64_t whole_below, const OpenOptions& options,
                                  const Hooks& hooks) {
    if (files.empty() || std::any_of(files.begin(), files.end(), is_pipe)) return {};
    std::vector<Glance> glances;
    std::uint64_t weight = 0;
    for (const std::filesystem::path& path : files) {
        glances.emplace_back(path == "-" ? "/dev/stdin" : path, options, hooks);
        weight += glances.back().weight();
    }
    if (weight <= whole_below) return {};
    InputReport report = glances.front().finish();
    bool has_all_boxes = !report.bounds.is_empty();
    for (std::size_t i = 1; i < glances.size(); ++i) {
        const InputReport part = glances[i].finish();
        has_all_boxes = has_all_boxes && !part.bounds.is_empty();
        add(part, report);
    }
    if (!has_all_boxes) report.bounds = {};
    if (files.size() > 1) {
        report.path += " and " + std::to_string(files.size() - 1) + " more";
        report.format += ", " + std::to_string(files.size()) + " files";
    }
    return report;
}

}  // namespace hewer::streaming

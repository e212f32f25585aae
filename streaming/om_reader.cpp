// SPDX-License-Identifier: MIT
#include "streaming/om_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/array.h"
#include "ooc/units.h"
#include "streaming/array_source.h"
#include "streaming/face_import.h"
#include "streaming/mesh_import.h"
#include "streaming/scalar_type.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kHeaderBytes = 16;
constexpr bool kSwap = std::endian::native == std::endian::big;
// 2.2: from there on the type of a named property stands behind its name.
constexpr std::uint8_t kWithTypeNames = 2U << 5 | 2U;

enum class Entity : std::uint8_t {
    Vertex = 0,
    Mesh = 1,
    Face = 2,
    Edge = 4,
    Halfedge = 6,
    End = 7
};
enum class Content : std::uint8_t {
    Position = 0,
    Normal = 1,
    Texture = 2,
    Status = 3,
    Color = 4,
    Custom = 6,
    Topology = 7
};

/// Sixteen bits in front of each block of data.
struct ChunkHeader {
    explicit ChunkHeader(std::uint16_t bits)
        : is_named((bits >> 1 & 1) != 0),
          entity(static_cast<Entity>(bits >> 2 & 7)),
          content(static_cast<Content>(bits >> 5 & 15)),
          is_signed((bits >> 9 & 1) != 0),
          is_float((bits >> 10 & 1) != 0),
          n_components(1U + (bits >> 11 & 7U)),
          size(bits >> 14 & 3U) {}

    bool is_named;
    Entity entity;
    Content content;
    bool is_signed;
    bool is_float;
    unsigned n_components;
    unsigned size;  // integers of 2^size bytes; floats of 4 * 2^size
};

std::string at_byte(std::uint64_t offset) {
    return "byte " + std::to_string(offset);
}

class OmImport {
  public:
    OmImport(std::shared_ptr<const ooc::InputFile> file, const OpenOptions& options,
             const Hooks& hooks)
        : file_(std::move(file)),
          name_(file_->path().string()),
          header_(*find_om_header(*file_)),
          import_(name_, "OpenMesh", file_->size(), options, hooks),
          face_import_(import_, header_.n_vertices) {}

    std::unique_ptr<MeshSource> run() {
        find_chunks();
        read_vertices();
        if (halfedges_.count > 0) {
            read_halfedge_faces();
        } else {
            read_listed_faces();
        }
        flush(0);
        face_import_.finish();
        return import_.finish();
    }

  private:
    [[noreturn]] void fail(std::uint64_t offset, const std::string& what) const {
        throw FormatError(name_ + ": " + at_byte(offset) + ": " + what);
    }

    template <typename T>
    [[nodiscard]] T load_at(std::uint64_t offset) const {
        std::array<unsigned char, sizeof(T)> bytes{};
        if (file_->read_at(offset, bytes.data(), bytes.size()) < bytes.size()) {
            fail(offset, "truncated: the file ends within a chunk");
        }
        return load<T, kSwap>(bytes.data());
    }

    /// Notes where everything lies, front to back.
    void find_chunks() {
        at_ = kHeaderBytes;
        for (;;) {
            if (at_ == file_->size()) return;  // older files have no mark at the end
            const std::uint64_t begin = at_;
            const ChunkHeader chunk(load_at<std::uint16_t>(at_));
            at_ += sizeof(std::uint16_t);
            if (chunk.entity == Entity::End) return;
            if (chunk.is_named) skip_text();
            if (chunk.content == Content::Custom) {
                if (header_.version >= kWithTypeNames) skip_text();
                const std::uint64_t n_bytes = load_at<std::uint32_t>(at_);
                at_ += sizeof(std::uint32_t) + n_bytes;
                if (at_ > file_->size()) fail(begin, "truncated: the file ends within a property");
                import_.ignore("named properties");
                continue;
            }
            // How long other lists of faces are is only known after they are read.
            if (chunk.entity == Entity::Face && chunk.content == Content::Topology &&
                halfedges_.count == 0) {
                listed_faces_ = at_;
                listed_ids_ = integer_type(chunk, begin);
                skip_listed_faces();
                continue;
            }
            keep(chunk, begin, data_of(chunk, begin));
        }
    }

    void skip_text() { at_ += 1 + std::uint64_t{load_at<std::uint8_t>(at_)}; }

    [[nodiscard]] ScalarType integer_type(const ChunkHeader& chunk, std::uint64_t begin) const {
        constexpr std::array<ScalarType, 4> kSigned{ScalarType::Int8, ScalarType::Int16,
                                                    ScalarType::Int32, ScalarType::Int64};
        constexpr std::array<ScalarType, 4> kUnsigned{ScalarType::UInt8, ScalarType::UInt16,
                                                      ScalarType::UInt32, ScalarType::UInt64};
        if (chunk.size > 2 && chunk.content == Content::Topology) {
            fail(begin, "handles of 64 bits, which hewer does not read");
        }
        return chunk.is_signed ? kSigned.at(chunk.size) : kUnsigned.at(chunk.size);
    }

    /// The data of a chunk as an array; at_ goes behind it.
    StridedArray data_of(const ChunkHeader& chunk, std::uint64_t begin) {
        StridedArray data;
        data.file = file_;
        data.offset = at_;
        data.n_components = chunk.n_components;
        if (chunk.content == Content::Status) {
            data.type = ScalarType::UInt32;  // whatever the header says
        } else if (chunk.content == Content::Topology || !chunk.is_float) {
            data.type = integer_type(chunk, begin);
            data.is_normalized = chunk.content == Content::Color;
        } else if (chunk.size <= 1) {
            data.type = chunk.size == 0 ? ScalarType::Float32 : ScalarType::Float64;
        } else {
            fail(begin, "numbers of 128 bits, which hewer does not read");
        }
        data.stride = data.element_bytes();
        switch (chunk.entity) {
            case Entity::Vertex:
                data.count = header_.n_vertices;
                break;
            case Entity::Face:
                data.count = header_.n_faces;
                break;
            case Entity::Edge:
                data.count = header_.n_edges;
                break;
            case Entity::Halfedge:
                data.count = 2 * header_.n_edges;
                break;
            case Entity::Mesh:
                data.count = 1;
                break;
            default:
                fail(begin, "a chunk of an unknown kind");
        }
        const std::uint64_t rest = file_->size() - at_;
        if (data.count > rest / data.stride) {
            fail(begin, "truncated: a chunk of " + ooc::format_count(data.count) + " elements of " +
                            std::to_string(data.stride) + " bytes goes beyond the end");
        }
        at_ += data.count * data.stride;
        return data;
    }

    void keep(const ChunkHeader& chunk, std::uint64_t begin, const StridedArray& data) {
        if (chunk.content == Content::Topology) {
            if (chunk.entity == Entity::Halfedge) {
                if (data.n_components != 3) fail(begin, "halfedges of an unknown kind");
                halfedges_ = data;
            } else if (chunk.entity == Entity::Face) {
                first_halfedges_ = data;
                first_halfedges_.n_components = 1;
            }
            return;
        }
        if (chunk.entity != Entity::Vertex || chunk.content == Content::Status ||
            chunk.content == Content::Texture) {
            import_.ignore(chunk.content == Content::Texture  ? "texture coordinates"
                           : chunk.content == Content::Status ? "status flags"
                                                              : "attributes of faces");
            return;
        }
        const bool is_wide = data.n_components >= 3;
        if (chunk.content == Content::Position) {
            if (!is_wide) fail(begin, "positions of fewer than three coordinates");
            vertices_.positions = data;
            vertices_.positions.n_components = 3;
            vertices_.has_double_positions = data.type == ScalarType::Float64;
        } else if (chunk.content == Content::Normal && data.n_components == 3) {
            vertices_.normals = data;
        } else if (chunk.content == Content::Color && is_wide && data.n_components <= 4) {
            vertices_.colors = data;
            if (data.n_components == 4) import_.set_has_alpha();
        }
    }

    void read_vertices() {
        if (vertices_.positions.count == 0) {
            throw FormatError(name_ + ": the mesh has no vertices");
        }
        vertices_.name = name_;
        const auto source = open_arrays(vertices_, import_.is_strict());
        VertexBatch batch;
        source->begin_vertices();
        while (source->next_vertices(batch)) {
            import_.add_vertices({batch.positions, batch.normals, batch.colors});
            import_.context().check_stop();
        }
    }

    /// Calls take(first, ids) for pieces of an array of integers.
    template <typename Take>
    void for_ids(const StridedArray& array, const Take& take) {
        constexpr std::uint64_t kPiece = 1 << 14;
        std::vector<unsigned char> bytes;
        std::vector<std::int64_t> ids;
        for (std::uint64_t first = 0; first < array.count; first += kPiece) {
            const std::uint64_t n = std::min(kPiece, array.count - first);
            bytes.resize(n * array.stride);
            if (file_->read_at(array.offset + first * array.stride, bytes.data(), bytes.size()) <
                bytes.size()) {
                fail(array.offset, "truncated");
            }
            ids.clear();
            for (std::uint64_t i = 0; i < n; ++i) {
                for (unsigned k = 0; k < array.n_components; ++k) {
                    ids.push_back(load_integer(array.type, kSwap,
                                               bytes.data() + i * array.stride +
                                                   k * std::uint64_t{byte_size(array.type)}));
                }
            }
            take(first, std::as_const(ids));
            import_.context().check_stop();
        }
    }

    /// The next halfedge, the vertex it leads to, its face. -1: none.
    struct Halfedge {
        std::int32_t next;
        std::int32_t vertex;
        std::int32_t face;
    };

    ooc::Array<Halfedge> load_halfedges() {
        ooc::MemoryBudget& budget = import_.context().budget();
        const std::uint64_t n = halfedges_.count;
        const std::uint64_t n_bytes = n * sizeof(Halfedge);
        constexpr std::uint64_t kBeside = 8 << 20;
        if (n_bytes + kBeside > budget.available()) {
            const std::string enough =
                std::to_string(((budget.used() + n_bytes + kBeside) >> 20) + 1) + " MiB";
            throw OutOfMemoryBudget(
                name_ +
                ": the faces of an .om file are chains of halfedges, which are held while " +
                "it is read; that needs " + enough + ", the limit is " +
                ooc::format_bytes(budget.limit()) + "; raise --memory to " + enough +
                " or more, or convert it to PLY first");
        }
        ooc::Array<Halfedge> all(budget, "halfedges", n);
        for_ids(halfedges_, [&](std::uint64_t first, const std::vector<std::int64_t>& ids) {
            for (std::size_t i = 0; i < ids.size() / 3; ++i) {
                // Each fits: they were at most 32 bits, and what is no handle is checked later.
                all[first + i] = {static_cast<std::int32_t>(ids[3 * i]),
                                  static_cast<std::int32_t>(ids[3 * i + 1]),
                                  static_cast<std::int32_t>(ids[3 * i + 2])};
            }
        });
        return all;
    }

    /// Walks around each face.
    void read_halfedge_faces() {
        if (first_halfedges_.count == 0) return;  // the import says that there are no faces
        const ooc::Array<Halfedge> all = load_halfedges();
        // No halfedge has two faces, so the walks cannot be longer than this together.
        std::uint64_t n_left = all.size();
        for_ids(
            first_halfedges_, [&](std::uint64_t first, const std::vector<std::int64_t>& starts) {
                for (std::size_t i = 0; i < starts.size(); ++i) {
                    TextFace face(faces_);
                    std::int64_t at = starts[i];
                    do {
                        if (at < 0 || static_cast<std::uint64_t>(at) >= all.size() || n_left == 0) {
                            fail(first_halfedges_.offset, "damaged: the halfedges of face " +
                                                              std::to_string(first + i) +
                                                              " do not lead around it");
                        }
                        --n_left;
                        const Halfedge& h = all[static_cast<std::uint64_t>(at)];
                        // What is no vertex is counted as out of range later.
                        face.add(static_cast<std::uint64_t>(std::int64_t{h.vertex}));
                        at = h.next;
                    } while (at != starts[i]);
                    face.finish(0);
                }
                flush(kMostWaiting);
            });
    }

    [[nodiscard]] std::uint64_t listed_corners() const {
        return header_.kind == 'T' ? 3 : header_.kind == 'Q' ? 4 : 0;
    }

    void skip_listed_faces() {
        const std::uint64_t id_bytes = byte_size(listed_ids_);
        if (const std::uint64_t n = listed_corners(); n > 0) {
            if (header_.n_faces > (file_->size() - at_) / (n * id_bytes)) {
                fail(at_, "truncated: the faces go beyond the end of the file");
            }
            at_ += header_.n_faces * n * id_bytes;
            return;
        }
        for (std::uint64_t f = 0; f < header_.n_faces; ++f) {
            at_ += 2 + load_at<std::uint16_t>(at_) * id_bytes;
            if (at_ > file_->size())
                fail(at_, "truncated: the faces go beyond the end of the file");
        }
    }

    void read_listed_faces() {
        if (listed_faces_ == 0) return;
        const std::uint64_t id_bytes = byte_size(listed_ids_);
        std::uint64_t at = listed_faces_;
        std::vector<unsigned char> bytes;
        for (std::uint64_t f = 0; f < header_.n_faces; ++f) {
            std::uint64_t n = listed_corners();
            if (n == 0) {
                n = load_at<std::uint16_t>(at);
                at += 2;
            }
            bytes.resize(n * id_bytes);
            if (file_->read_at(at, bytes.data(), bytes.size()) < bytes.size()) {
                fail(at, "truncated: the faces go beyond the end of the file");
            }
            at += bytes.size();
            TextFace face(faces_);
            for (std::uint64_t k = 0; k < n; ++k) {
                face.add(static_cast<std::uint64_t>(
                    load_integer(listed_ids_, kSwap, bytes.data() + k * id_bytes)));
            }
            face.finish(0);
            flush(kMostWaiting);
        }
    }

    /// Hands the faces over if more than `n_most` triangles wait.
    void flush(std::size_t n_most) {
        if (faces_.triangles.size() <= n_most && n_most > 0) return;
        face_import_.add(faces_, header_.n_vertices);
        faces_.clear();
        import_.context().check_stop();
    }

    static constexpr std::size_t kMostWaiting = 1 << 13;

    std::shared_ptr<const ooc::InputFile> file_;
    std::string name_;
    OmHeader header_;
    MeshImport import_;
    FaceImport face_import_;
    std::uint64_t at_ = 0;
    ArrayMesh vertices_;
    StridedArray halfedges_;
    StridedArray first_halfedges_;
    std::uint64_t listed_faces_ = 0;  // where they begin
    ScalarType listed_ids_ = ScalarType::UInt32;
    TextFaces faces_;
};

}  // namespace

std::optional<OmHeader> find_om_header(const ooc::InputFile& file) {
    std::array<unsigned char, kHeaderBytes> bytes{};
    if (file.read_at(0, bytes.data(), bytes.size()) < bytes.size()) return {};
    if (bytes[0] != 'O' || bytes[1] != 'M') return {};
    OmHeader header;
    header.kind = static_cast<char>(bytes[2]);
    header.version = bytes[3];
    constexpr unsigned kMajorAt = 5;
    const unsigned major = header.version >> kMajorAt;
    if ((header.kind != 'T' && header.kind != 'Q' && header.kind != 'P') || major > 2) return {};
    header.n_vertices = load<std::uint32_t, kSwap>(bytes.data() + 4);
    header.n_faces = load<std::uint32_t, kSwap>(bytes.data() + 8);
    header.n_edges = load<std::uint32_t, kSwap>(bytes.data() + 12);
    return header;
}

std::unique_ptr<MeshSource> open_om(std::shared_ptr<const ooc::InputFile> file,
                                    const OpenOptions& options, const Hooks& hooks) {
    if (!find_om_header(*file)) {
        throw FormatError(file->path().string() + ": does not begin like a file of OpenMesh");
    }
    return OmImport(std::move(file), options, hooks).run();
}

}  // namespace hewer::streaming

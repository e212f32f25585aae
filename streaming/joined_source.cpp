// SPDX-License-Identifier: MIT
#include "streaming/joined_source.h"

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <string>
#include <utility>

#include "hewer/error.h"

namespace hewer::streaming {

namespace {

constexpr Rgba16 kWhite{65535, 65535, 65535, 65535};

class JoinedSource final : public MeshSource {
  public:
    JoinedSource(std::vector<std::unique_ptr<MeshSource>> parts, std::string name,
                 std::string format)
        : parts_(std::move(parts)) {
        info_.name = std::move(name);
        info_.format = std::move(format);
        info_.is_indexed = parts_.front()->info().is_indexed;
        for (const auto& part : parts_) {
            const SourceInfo& p = part->info();
            first_vertex_.push_back(info_.n_vertices);
            first_face_.push_back(info_.n_faces);
            info_.n_vertices += p.n_vertices;
            info_.n_faces += p.n_faces;
            info_.n_bytes += p.n_bytes;
            info_.has_double_positions |= p.has_double_positions;
            info_.has_normals |= p.has_normals;
            info_.has_colors |= p.has_colors;
            info_.has_alpha |= p.has_alpha;
            info_.textures.insert(info_.textures.end(), p.textures.begin(), p.textures.end());
            info_.has_weights |= p.has_weights;
            for (const std::string& what : p.ignored) {
                if (std::find(info_.ignored.begin(), info_.ignored.end(), what) ==
                    info_.ignored.end()) {
                    info_.ignored.push_back(what);
                }
            }
        }
    }

    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    [[nodiscard]] std::uint64_t bytes_read() const override {
        return total([](const MeshSource& part) { return part.bytes_read(); });
    }
    [[nodiscard]] std::uint64_t held_memory_bytes() const override {
        return total([](const MeshSource& part) { return part.held_memory_bytes(); });
    }
    [[nodiscard]] std::uint64_t held_temp_bytes() const override {
        return total([](const MeshSource& part) { return part.held_temp_bytes(); });
    }

    void begin_vertices() override {
        for (const auto& part : parts_) part->begin_vertices();
        current_ = 0;
    }
    bool next_vertices(VertexBatch& batch) override {
        return next([&](std::size_t i) {
            if (!parts_[i]->next_vertices(batch)) return false;
            fill_attributes(batch);
            batch.first += first_vertex_[i];
            name_part(i, batch.defects);
            return true;
        });
    }

    [[nodiscard]] bool can_seek_vertices() const override {
        return std::all_of(parts_.begin(), parts_.end(),
                           [](const auto& part) { return part->can_seek_vertices(); });
    }
    void read_vertices(std::uint64_t first, std::uint64_t n, VertexBatch& batch) override {
        std::size_t i = part_of(first_vertex_, first);
        const std::uint64_t last = first + n;
        if (last <= end_of(i)) {
            parts_[i]->read_vertices(first - first_vertex_[i], n, batch);
            fill_attributes(batch);
        } else {
            batch.positions.clear();
            batch.normals.clear();
            batch.colors.clear();
            batch.weights.clear();
            VertexBatch piece;
            for (std::uint64_t at = first; at < last; ++i) {
                const std::uint64_t end = std::min(last, end_of(i));
                if (end == at) continue;
                parts_[i]->read_vertices(at - first_vertex_[i], end - at, piece);
                fill_attributes(piece);
                append(batch.positions, piece.positions);
                append(batch.normals, piece.normals);
                append(batch.colors, piece.colors);
                append(batch.weights, piece.weights);
                at = end;
            }
        }
        batch.first = first;
        batch.defects = {};  // met in the pass before
    }

    void begin_triangles() override {
        for (const auto& part : parts_) part->begin_triangles();
        current_ = 0;
    }
    bool next_triangles(TriangleBatch& batch) override {
        return next([&](std::size_t i) {
            if (!parts_[i]->next_triangles(batch)) return false;
            for (Triangle& corners : batch.corners) {
                for (std::uint64_t& v : corners) v += first_vertex_[i];
            }
            batch.first_face += first_face_[i];
            name_part(i, batch.defects);
            return true;
        });
    }

  private:
    template <typename Count>
    [[nodiscard]] std::uint64_t total(const Count& count) const {
        std::uint64_t sum = 0;
        for (const auto& part : parts_) sum += count(*part);
        return sum;
    }

    /// read(i) of the current part, or of the next one where that is at its end.
    template <typename Read>
    bool next(const Read& read) {
        for (;;) {
            std::size_t i = 0;
            {
                const std::lock_guard lock(mutex_);
                i = current_;
            }
            if (i == parts_.size()) return false;
            if (read(i)) return true;
            const std::lock_guard lock(mutex_);
            if (current_ == i) ++current_;
        }
    }

    [[nodiscard]] std::uint64_t end_of(std::size_t part) const {
        return first_vertex_[part] + parts_[part]->info().n_vertices;
    }
    static std::size_t part_of(const std::vector<std::uint64_t>& firsts, std::uint64_t i) {
        return static_cast<std::size_t>(std::upper_bound(firsts.begin(), firsts.end(), i) -
                                        firsts.begin()) -
               1;
    }
    template <typename T>
    static void append(std::vector<T>& to, const std::vector<T>& from) {
        to.insert(to.end(), from.begin(), from.end());
    }

    void fill_attributes(VertexBatch& batch) const {
        const std::size_t n = batch.positions.size();
        if (info_.has_normals && batch.normals.empty()) batch.normals.assign(n, {});
        if (info_.has_colors && batch.colors.empty()) batch.colors.assign(n, kWhite);
        if (info_.has_weights && batch.weights.empty()) batch.weights.assign(n, 1.0F);
    }

    /// Element numbers in messages are those of the file.
    void name_part(std::size_t part, InputDefects& defects) const {
        for (std::string* first : {&defects.first_nonfinite, &defects.first_out_of_range}) {
            if (!first->empty()) *first += " of " + parts_[part]->info().name;
        }
    }

    std::vector<std::unique_ptr<MeshSource>> parts_;
    std::vector<std::uint64_t> first_vertex_;  // by part
    std::vector<std::uint64_t> first_face_;
    SourceInfo info_;
    std::mutex mutex_;
    std::size_t current_ = 0;
};

}  // namespace

std::unique_ptr<MeshSource> join_sources(std::vector<std::unique_ptr<MeshSource>> parts,
                                         std::string name, std::string format) {
    return std::make_unique<JoinedSource>(std::move(parts), std::move(name), std::move(format));
}

}  // namespace hewer::streaming

// SPDX-License-Identifier: MIT
#include "streaming/gltf_arrays.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/memory_budget.h"
#include "ooc/units.h"
#include "streaming/temporary_input.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kPieceBytes = 1 << 20;
// The first byte of attributes in version 1.
constexpr unsigned char kNewAttributes = 0xa1;
// The format's largest stride, and what keeps products of counts and strides below 2^64.
constexpr std::uint64_t kMostStride = 256;
constexpr std::uint64_t kMostCount = std::uint64_t{1} << 48;

ScalarType type_of(std::int64_t component, const std::string& what) {
    switch (component) {
        case 5120:
            return ScalarType::Int8;
        case 5121:
            return ScalarType::UInt8;
        case 5122:
            return ScalarType::Int16;
        case 5123:
            return ScalarType::UInt16;
        case 5125:
            return ScalarType::UInt32;
        case 5126:
            return ScalarType::Float32;
        default:
            throw FormatError(what + ": unknown component type " + std::to_string(component));
    }
}

unsigned components_of(const std::string& type) {
    if (type == "SCALAR") return 1;
    if (type.size() == 4 && type.starts_with("VEC") && type[3] >= '2' && type[3] <= '4') {
        return static_cast<unsigned>(type[3] - '0');
    }
    return 0;
}

std::vector<unsigned char> read_range(const FileRange& range, const std::string& what) {
    std::vector<unsigned char> bytes(range.n_bytes);
    if (!range.file ||
        range.file->read_at(range.offset, bytes.data(), bytes.size()) < bytes.size()) {
        throw FormatError(what + ": its bytes are missing");
    }
    return bytes;
}

}  // namespace

OpenOptions GltfArrays::rest() const {
    return beside(options_, held_temp_bytes_);
}

/// The bytes of a view, decoded if it is compressed.
FileRange GltfArrays::view(std::int64_t index) {
    if (const auto it = decoded_.find(index); it != decoded_.end()) return it->second;
    const auto& views = document_.model.views;
    if (index >= 0 && static_cast<std::size_t>(index) < views.size()) {
        const auto& packed = views[static_cast<std::size_t>(index)].meshopt;
        if (packed) return decoded_[index] = decode(index, *packed);
    }
    return buffer_view(document_, index);
}

FileRange GltfArrays::decode(std::int64_t index, const gltf::MeshoptView& view) {
    const std::string what = document_.name + ": compressed buffer view " + std::to_string(index);
    const std::uint64_t stride = view.byte_stride;
    const std::uint64_t count = view.count;
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= document_.buffers.size()) {
        throw FormatError(what + ": there is no such buffer");
    }
    const FileRange& whole = document_.buffers[static_cast<std::size_t>(view.buffer)];
    const std::uint64_t length = view.byte_length;
    if (view.byte_offset > whole.n_bytes || length > whole.n_bytes - view.byte_offset) {
        throw FormatError(what + " reaches beyond its buffer");
    }
    const std::string& mode = view.mode;
    const bool is_stride_good = mode == "ATTRIBUTES"
                                    ? stride > 0 && stride <= kMostStride && stride % 4 == 0
                                    : stride == 2 || stride == 4;
    if (!is_stride_good || count > kMostCount) {
        throw FormatError(what + ": a stride of " + std::to_string(stride) + " for " +
                          std::to_string(count) + " elements cannot be");
    }
    ooc::MemoryBudget budget(options_.memory_bytes != 0 ? options_.memory_bytes
                                                        : ooc::default_memory_limit());
    const auto memory = budget.reserve("compressed glTF buffer view", length + count * stride);
    const std::vector<unsigned char> packed =
        read_range({whole.file, whole.offset + view.byte_offset, length}, what);
    std::vector<unsigned char> bytes(count * stride);
    int result = -1;
    if (mode == "ATTRIBUTES") {
        result = meshopt_decodeVertexBuffer(bytes.data(), count, stride, packed.data(), length);
    } else if (mode == "TRIANGLES" && count % 3 == 0) {
        result = meshopt_decodeIndexBuffer(bytes.data(), count, stride, packed.data(), length);
    } else if (mode == "INDICES") {
        result = meshopt_decodeIndexSequence(bytes.data(), count, stride, packed.data(), length);
    }
    if (result != 0 && mode == "ATTRIBUTES" && !packed.empty() && packed[0] == kNewAttributes) {
        throw FormatError(what + " is damaged, or in version 1 of the attribute format of " +
                          "KHR_meshopt_compression, which needs meshoptimizer 0.23 (this is " +
                          std::to_string(MESHOPTIMIZER_VERSION / 1000) + "." +
                          std::to_string(MESHOPTIMIZER_VERSION / 10 % 100) +
                          "); write the file with EXT_meshopt_compression instead");
    }
    if (result != 0) throw FormatError(what + " is damaged (mode " + mode + ")");
    const std::string& filter = view.filter;
    if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
        meshopt_decodeFilterOct(bytes.data(), count, stride);
    } else if (filter == "QUATERNION" && stride == 8) {
        meshopt_decodeFilterQuat(bytes.data(), count, stride);
    } else if (filter == "EXPONENTIAL") {
        meshopt_decodeFilterExp(bytes.data(), count, stride);
    } else if (!filter.empty() && filter != "NONE") {
        throw FormatError(
            what + ": the filter " + filter + " is not known to hewer" +
            (filter == "COLOR"
                 ? "; write the file with EXT_meshopt_compression, which has no such filter"
                 : ""));
    }
    TemporaryInput out(rest());
    out.append(bytes.data(), bytes.size());
    held_temp_bytes_ += bytes.size();
    return {out.finish(document_.name), 0, bytes.size()};
}

StridedArray GltfArrays::place_in(const gltf::Accessor& accessor, const FileRange& range,
                                  std::uint64_t stride, const std::string& what) const {
    StridedArray array;
    array.type = type_of(accessor.component_type, what);
    array.n_components = components_of(accessor.type);
    array.count = accessor.count;
    array.is_normalized = accessor.is_normalized;
    const std::uint64_t element = array.element_bytes();
    if (element == 0) throw FormatError(what + ": matrices are no vertices");
    array.stride = stride != 0 ? stride : element;
    if (array.count == 0 || array.count > kMostCount || array.stride < element ||
        array.stride > kMostStride) {
        throw FormatError(what + ": " + std::to_string(array.count) +
                          " elements at a distance of " + std::to_string(array.stride) +
                          " bytes cannot be");
    }
    const std::uint64_t bytes = (array.count - 1) * array.stride + element;
    if (accessor.byte_offset > range.n_bytes || bytes > range.n_bytes - accessor.byte_offset) {
        throw FormatError(what + " needs " + std::to_string(bytes) + " bytes from byte " +
                          std::to_string(accessor.byte_offset) + " on; its buffer view has " +
                          std::to_string(range.n_bytes));
    }
    if (!range.file) throw FormatError(what + ": the buffer behind it is not there");
    array.file = range.file;
    array.offset = range.offset + accessor.byte_offset;
    return array;
}

StridedArray GltfArrays::array(std::int64_t index) {
    const std::string what = document_.name + ": accessor " + std::to_string(index);
    const auto& accessors = document_.model.accessors;
    if (index < 0 || static_cast<std::size_t>(index) >= accessors.size()) {
        throw FormatError(what + " is asked for, but there is none");
    }
    const gltf::Accessor& accessor = accessors[static_cast<std::size_t>(index)];
    StridedArray array;
    if (accessor.view >= 0) {
        const FileRange range = view(accessor.view);
        const auto& about = document_.model.views[static_cast<std::size_t>(accessor.view)];
        array = place_in(accessor, range, about.byte_stride, what);
    } else {
        // Zeros, to be replaced by sparse values.
        array.type = type_of(accessor.component_type, what);
        array.n_components = components_of(accessor.type);
        array.count = accessor.count;
        array.is_normalized = accessor.is_normalized;
        array.stride = array.element_bytes();
        if (array.stride == 0 || array.count == 0 || array.count > kMostCount) {
            throw FormatError(what + " has no elements");
        }
    }
    return accessor.sparse ? put_together(accessor, array, what) : array;
}

/// A copy of `base` with the sparse values in their places.
StridedArray GltfArrays::put_together(const gltf::Accessor& accessor, const StridedArray& base,
                                      const std::string& what) {
    const gltf::SparsePart& sparse = *accessor.sparse;
    if (sparse.count > base.count) {
        throw FormatError(what + ": it has more sparse elements than elements");
    }
    const std::uint64_t element = base.element_bytes();
    TemporaryInput out(rest());
    std::vector<unsigned char> piece(kPieceBytes / element * element);
    std::vector<unsigned char> strided;
    const std::uint64_t per_piece = piece.size() / element;
    for (std::uint64_t first = 0; first < base.count; first += per_piece) {
        const std::uint64_t n = std::min(per_piece, base.count - first);
        std::fill(piece.begin(), piece.end(), 0);
        if (base.file) {
            strided.resize((n - 1) * base.stride + element);
            base.file->read_at(base.offset + first * base.stride, strided.data(), strided.size());
            for (std::uint64_t i = 0; i < n; ++i) {
                std::copy_n(strided.data() + i * base.stride, element, piece.data() + i * element);
            }
        }
        out.append(piece.data(), n * element);
    }
    if (sparse.count > 0) {
        gltf::Accessor places;
        places.component_type = sparse.index_type;
        places.type = "SCALAR";
        places.count = sparse.count;
        places.byte_offset = sparse.index_offset;
        gltf::Accessor values = accessor;
        values.count = sparse.count;
        values.byte_offset = sparse.value_offset;
        const StridedArray ids =
            place_in(places, view(sparse.index_view), 0, what + ", sparse indices");
        const StridedArray news =
            place_in(values, view(sparse.value_view), 0, what + ", sparse values");
        if (!is_integer(ids.type)) throw FormatError(what + ": its sparse indices are no integers");
        std::array<unsigned char, 4> id_bytes{};
        std::vector<unsigned char> value(element);
        for (std::uint64_t i = 0; i < ids.count; ++i) {
            ids.file->read_at(ids.offset + i * ids.stride, id_bytes.data(), ids.stride);
            const auto id =
                static_cast<std::uint64_t>(load_integer(ids.type, false, id_bytes.data()));
            if (id >= base.count) {
                throw FormatError(what + ": sparse index " + std::to_string(id) +
                                  " is beyond its " + std::to_string(base.count) + " elements");
            }
            news.file->read_at(news.offset + i * element, value.data(), element);
            out.write_at(id * element, value.data(), element);
        }
    }
    held_temp_bytes_ += out.size();
    StridedArray whole = base;
    whole.stride = element;
    whole.offset = 0;
    whole.file = out.finish(document_.name);
    return whole;
}

}  // namespace hewer::streaming

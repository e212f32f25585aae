// SPDX-License-Identifier: MIT
/// The accessors of a glTF document as arrays that can be read at any place.
#pragma once

#include <cstdint>
#include <map>

#include "hewer/mesh_source.h"
#include "streaming/array_source.h"
#include "streaming/gltf_document.h"

namespace hewer::streaming {

/// Plain accessors are told where they lie. Compressed views (EXT_meshopt_compression, and
/// KHR_meshopt_compression as far as meshoptimizer has it) are decoded once each, and sparse
/// accessors are put together, in temporary files. Memory: of one compressed view, packed and
/// unpacked, while it is decoded; else small. Throws: FormatError (what reaches out of its place;
/// damaged data), OutOfMemoryBudget, OutOfDiskBudget, IoError.
class GltfArrays {
  public:
    /// Both must outlive it.
    GltfArrays(const GltfDocument& document, const OpenOptions& options)
        : document_(document), options_(options), held_temp_bytes_(document.held_temp_bytes) {}

    StridedArray array(std::int64_t accessor);

    /// Of all temporary files so far, the document's included.
    [[nodiscard]] std::uint64_t held_temp_bytes() const { return held_temp_bytes_; }
    void add_held_temp_bytes(std::uint64_t bytes) { held_temp_bytes_ += bytes; }
    /// What is left of the limits.
    [[nodiscard]] OpenOptions rest() const;

  private:
    FileRange view(std::int64_t index);
    FileRange decode(std::int64_t index, const gltf::MeshoptView& view);
    StridedArray place_in(const gltf::Accessor& accessor, const FileRange& range,
                          std::uint64_t stride, const std::string& what) const;
    StridedArray put_together(const gltf::Accessor& accessor, const StridedArray& base,
                              const std::string& what);

    const GltfDocument& document_;
    const OpenOptions& options_;
    std::map<std::int64_t, FileRange> decoded_;
    std::uint64_t held_temp_bytes_;
};

}  // namespace hewer::streaming

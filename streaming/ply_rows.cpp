// SPDX-License-Identifier: MIT
#include "streaming/ply_rows.h"

#include "hewer/error.h"
#include "ooc/units.h"

namespace hewer::streaming {

namespace {

template <typename Units>
RowShape make_shape(const PlyElement& element, const Units& units) {
    RowShape shape;
    shape.element = element.name;
    shape.n_rows = element.count;
    for (const PlyProperty& p : element.properties) {
        if (p.is_list) {
            shape.lists.push_back({shape.tail, p.count_type, units(p.count_type), units(p.type)});
            shape.min_units += units(p.count_type);
            shape.tail = 0;
        } else {
            shape.tail += units(p.type);
            shape.fixed_units += units(p.type);
        }
    }
    shape.min_units += shape.fixed_units;
    return shape;
}

}  // namespace

RowShape RowShape::in_bytes(const PlyElement& element) {
    return make_shape(element, [](ScalarType type) -> std::size_t { return byte_size(type); });
}

RowShape RowShape::in_tokens(const PlyElement& element) {
    return make_shape(element, [](ScalarType) -> std::size_t { return 1; });
}

std::size_t list_index(const PlyElement& element, std::size_t property_index) {
    std::size_t n_lists = 0;
    for (std::size_t i = 0; i < property_index; ++i) n_lists += element.properties[i].is_list;
    return n_lists;
}

void check_row_count(const ooc::InputFile& file, const RowShape& shape, std::uint64_t offset,
                     std::uint64_t min_row_bytes) {
    if (min_row_bytes == 0) return;
    const std::uint64_t available = file.size() > offset ? file.size() - offset : 0;
    const std::uint64_t n_fitting = available / min_row_bytes;
    if (shape.n_rows <= n_fitting) return;
    throw FormatError(file.path().string() + ": truncated: the header announces " +
                      ooc::format_count(shape.n_rows) + " rows of element " + shape.element +
                      ", of at least " + std::to_string(min_row_bytes) + " bytes each, from byte " +
                      std::to_string(offset) + " on; the file ends at byte " +
                      std::to_string(file.size()) + ", in row " + std::to_string(n_fitting) +
                      " at the latest");
}

}  // namespace hewer::streaming

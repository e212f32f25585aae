// SPDX-License-Identifier: MIT
/// How the rows of a PLY element are built, and walks over them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "streaming/ply_header.h"
#include "streaming/ply_stream.h"

namespace hewer::streaming {

/// A list in a row. Lengths are in units: bytes in binary files, tokens in ASCII ones.
struct RowList {
    std::size_t gap = 0;  ///< scalars since the list before, or since the start of the row
    ScalarType count_type = ScalarType::UInt8;
    std::size_t count_units = 0;
    std::size_t item_units = 0;
};

/// A row as an alternation of scalars, of which only the length counts, and lists.
struct RowShape {
    std::string element;
    std::uint64_t n_rows = 0;
    std::vector<RowList> lists;
    std::size_t tail = 0;         ///< scalars after the last list
    std::size_t fixed_units = 0;  ///< all scalars: the row's length if it has no lists
    std::size_t min_units = 0;    ///< with all lists empty

    static RowShape in_bytes(const PlyElement& element);
    static RowShape in_tokens(const PlyElement& element);
    /// In the units of the walk.
    template <typename Stream>
    static RowShape of(const PlyElement& element);
};

template <>
inline RowShape RowShape::of<BinaryStream>(const PlyElement& element) {
    return in_bytes(element);
}
template <>
inline RowShape RowShape::of<TextStream>(const PlyElement& element) {
    return in_tokens(element);
}

/// Which of the row's lists the property `property_index` is.
std::size_t list_index(const PlyElement& element, std::size_t property_index);

/// Throws FormatError if the file is too short for the announced rows even with all lists empty:
/// so that no count is believed that the file cannot hold. `min_row_bytes` as RowShape::min_units
/// in binary files.
void check_row_count(const ooc::InputFile& file, const RowShape& shape, std::uint64_t offset,
                     std::uint64_t min_row_bytes);

/// Reads a list's count and checks it: not negative, not more than the file still has.
template <typename Stream>
std::uint64_t read_list_count(Stream& stream, const RowList& list) {
    const std::int64_t count = stream.read_integer(list.count_type);
    if (count < 0) stream.fail("a list has the negative count " + std::to_string(count));
    const std::uint64_t n = static_cast<std::uint64_t>(count);
    if (n > stream.remaining_bytes() / list.item_units) {
        stream.fail("a list announces " + std::to_string(n) + " values, but only " +
                    std::to_string(stream.remaining_bytes()) + " bytes are left in the file");
    }
    return n;
}

/// Moves `stream` from the first row of an element past its last one. check_row_count() has passed.
template <typename Stream>
void skip_rows(Stream& stream, const RowShape& shape) {
    stream.enter(shape.element);
    if (shape.lists.empty()) {
        stream.skip(shape.n_rows * shape.fixed_units);
        return;
    }
    for (std::uint64_t row = 0; row < shape.n_rows; ++row) {
        stream.set_row(row);
        for (const RowList& list : shape.lists) {
            stream.skip(list.gap);
            stream.skip(read_list_count(stream, list) * list.item_units);
        }
        stream.skip(shape.tail);
    }
}

/// The values of one list property of all rows, one by one, however long the lists are.
template <typename Stream>
class ListItems {
  public:
    ListItems(Stream stream, const RowShape& shape, std::size_t list, ScalarType type)
        : stream_(std::move(stream)), shape_(shape), list_(list), type_(type) {
        stream_.enter(shape.element);
    }

    /// False at the end of the element. -1 stands between two rows.
    bool next(std::int64_t& item) {
        if (n_left_ > 0) {
            --n_left_;
            item = stream_.read_integer(type_);
            return true;
        }
        if (is_in_row_) {
            for (std::size_t i = list_ + 1; i < shape_.lists.size(); ++i) skip_list(i);
            stream_.skip(shape_.tail);
            is_in_row_ = false;
            ++row_;
        }
        if (row_ == shape_.n_rows) return false;
        stream_.set_row(row_);
        for (std::size_t i = 0; i < list_; ++i) skip_list(i);
        stream_.skip(shape_.lists[list_].gap);
        n_left_ = read_list_count(stream_, shape_.lists[list_]);
        is_in_row_ = true;
        item = -1;
        return true;
    }
    [[nodiscard]] const Stream& stream() const { return stream_; }

  private:
    void skip_list(std::size_t i) {
        stream_.skip(shape_.lists[i].gap);
        stream_.skip(read_list_count(stream_, shape_.lists[i]) * shape_.lists[i].item_units);
    }

    Stream stream_;
    const RowShape& shape_;
    std::size_t list_;
    ScalarType type_;
    std::uint64_t row_ = 0;
    std::uint64_t n_left_ = 0;
    bool is_in_row_ = false;
};

/// Some properties of all rows of an element, one row after the other.
template <typename Stream>
class RowValues {
  public:
    /// `wanted`: numbers of properties; values are asked for by their places in it.
    RowValues(Stream& stream, const PlyElement& element, const std::vector<std::size_t>& wanted)
        : stream_(stream),
          element_(element),
          shape_(RowShape::of<Stream>(element)),
          slots_(element.properties.size(), kUnwanted),
          values_(wanted.size()) {
        for (std::size_t i = 0; i < wanted.size(); ++i) slots_[wanted[i]] = i;
        stream_.enter(element.name);
    }

    /// Longer lists come out empty: so that no count asks for memory.
    static constexpr std::uint64_t kMostValues = 1 << 16;

    bool next() {
        if (row_ == element_.count) return false;
        stream_.set_row(row_++);
        std::size_t i_list = 0;
        for (std::size_t i = 0; i < element_.properties.size(); ++i) {
            const PlyProperty& p = element_.properties[i];
            const std::uint64_t n =
                p.is_list ? read_list_count(stream_, shape_.lists[i_list++]) : 1;
            const bool is_wanted = slots_[i] != kUnwanted && n <= kMostValues;
            if (slots_[i] != kUnwanted) values_[slots_[i]].clear();
            if (!is_wanted) stream_.skip(n * Stream::units(p.type));
            for (std::uint64_t k = 0; is_wanted && k < n; ++k) {
                values_[slots_[i]].push_back(stream_.read_number(p.type));
            }
        }
        return true;
    }
    [[nodiscard]] const std::vector<double>& list(std::size_t i) const { return values_[i]; }
    [[nodiscard]] double number(std::size_t i) const { return values_[i].front(); }

  private:
    static constexpr std::size_t kUnwanted = static_cast<std::size_t>(-1);

    Stream& stream_;
    const PlyElement& element_;
    RowShape shape_;
    std::vector<std::size_t> slots_;  // by property
    std::vector<std::vector<double>> values_;
    std::uint64_t row_ = 0;
};

}  // namespace hewer::streaming

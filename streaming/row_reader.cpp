// SPDX-License-Identifier: MIT
#include "streaming/row_reader.h"

#include <algorithm>
#include <string>

#include "hewer/error.h"
#include "ooc/units.h"

namespace hewer::streaming {

namespace {

/// A block is not read larger than this, unless a single row is.
constexpr std::size_t kBlockBytes = 1 << 20;
/// Bounds the fan of one polygon, too: a million 32-bit ids, 24 MiB of triangles.
constexpr std::size_t kMaxRowBytes = 4 << 20;

/// Whether n integers, `stride` bytes apart, have the bits of the first.
template <typename T>
bool are_equal(const unsigned char* p, std::size_t stride, std::uint64_t n) {
    const T first = load<T, false>(p);
    T difference = 0;
    for (std::uint64_t i = 0; i < n; ++i) {
        difference = static_cast<T>(difference | (load<T, false>(p + i * stride) ^ first));
    }
    return difference == 0;
}

bool are_equal(std::size_t size, const unsigned char* p, std::size_t stride, std::uint64_t n) {
    switch (size) {
        case 1:
            return are_equal<std::uint8_t>(p, stride, n);
        case 2:
            return are_equal<std::uint16_t>(p, stride, n);
        case 4:
            return are_equal<std::uint32_t>(p, stride, n);
        default:
            return are_equal<std::uint64_t>(p, stride, n);
    }
}

constexpr std::uint64_t fan_size(std::uint64_t n_corners) {
    return n_corners > 2 ? n_corners - 2 : 0;
}

}  // namespace

RowReader::RowReader(const ooc::InputFile& file, std::atomic<std::uint64_t>& n_bytes_read,
                     const RowShape& shape, bool swap, std::uint64_t offset, std::size_t fan_list)
    : file_(file),
      n_bytes_read_(n_bytes_read),
      shape_(shape),
      swap_(swap),
      fan_list_(fan_list),
      next_offset_(offset) {}

bool RowReader::next(RowBlock& block) {
    std::unique_lock lock(mutex_);
    if (next_row_ == shape_.n_rows) return false;
    block.first_row = next_row_;
    block.offset = next_offset_;
    block.n_triangles = 0;
    if (!shape_.lists.empty()) {
        read_and_cut(block);
        next_row_ += block.n_rows;
        next_offset_ += block.n_bytes;
        return true;
    }
    block.stride = shape_.fixed_units;
    block.n_rows = std::min({shape_.n_rows - next_row_, kBlockRows,
                             std::max<std::uint64_t>(1, kBlockBytes / shape_.fixed_units)});
    const std::size_t bytes = static_cast<std::size_t>(block.n_rows) * block.stride;
    next_row_ += block.n_rows;
    next_offset_ += bytes;
    lock.unlock();
    read(block, bytes);
    if (block.n_bytes < bytes) {
        throw FormatError(
            place(block.first_row + block.n_bytes / block.stride, block.offset + block.n_bytes) +
            ": truncated: the file ends here");
    }
    return true;
}

void RowReader::read(RowBlock& block, std::size_t bytes) {
    block.n_bytes = file_.read_at(block.offset, block.bytes.room_for(bytes), bytes);
    n_bytes_read_.fetch_add(block.n_bytes, std::memory_order_relaxed);
}

void RowReader::read_and_cut(RowBlock& block) {
    // Room for triangles; larger faces make smaller blocks.
    std::size_t row_guess = shape_.min_units;
    for (const RowList& list : shape_.lists) row_guess += 3 * list.item_units;
    std::size_t bytes = std::min<std::size_t>(kBlockBytes, row_guess * kBlockRows);
    const std::uint64_t n_left = shape_.n_rows - next_row_;
    if (n_left < kBlockRows) bytes = std::min(bytes, row_guess * static_cast<std::size_t>(n_left));
    while (true) {
        read(block, bytes);
        if (cut_alike(block)) return;
        const std::size_t n_read = block.n_bytes;
        cut_by_walking(block);
        if (block.n_rows > 0) return;
        if (n_read < bytes) {
            throw FormatError(place(block.first_row, block.offset) +
                              ": truncated: the file ends at byte " +
                              std::to_string(block.offset + n_read) + ", within this row");
        }
        if (bytes == kMaxRowBytes) {
            throw FormatError(place(block.first_row, block.offset) + ": a row of more than " +
                              ooc::format_bytes(kMaxRowBytes) + " is beyond what hewer reads");
        }
        bytes = std::min(4 * bytes, kMaxRowBytes);
    }
}

/// Cuts the block to as many rows as it holds if they are all like the first; else leaves it.
bool RowReader::cut_alike(RowBlock& block) {
    const unsigned char* data = block.bytes.data();
    count_fields_.clear();
    std::uint64_t n_triangles = 0;
    const std::size_t stride =
        walk_row(shape_, swap_, data, block.n_bytes,
                 [&](std::size_t i, const unsigned char* items, std::uint64_t count) {
                     check_count(block, block.first_row, items, i, count);
                     const std::size_t size = shape_.lists[i].count_units;
                     count_fields_.push_back({static_cast<std::size_t>(items - data) - size, size});
                     if (i == fan_list_) n_triangles = fan_size(count);
                 });
    if (stride == 0) return false;
    const std::uint64_t n_rows =
        std::min({shape_.n_rows - next_row_, kBlockRows, std::uint64_t{block.n_bytes / stride}});
    for (const CountField& field : count_fields_) {
        if (!are_equal(field.size, data + field.offset, stride, n_rows)) return false;
    }
    block.stride = stride;
    block.n_rows = n_rows;
    block.n_bytes = static_cast<std::size_t>(n_rows) * stride;
    block.n_triangles = n_triangles * n_rows;
    return true;
}

/// Cuts the block to its whole rows; none if even the first is not whole.
void RowReader::cut_by_walking(RowBlock& block) {
    const std::uint64_t n_wanted = std::min(shape_.n_rows - next_row_, kBlockRows);
    std::size_t position = 0;
    block.stride = 0;
    block.n_rows = 0;
    block.n_triangles = 0;
    while (block.n_rows < n_wanted) {
        std::uint64_t n_triangles = 0;
        const std::size_t row_bytes =
            walk_row(shape_, swap_, block.bytes.data() + position, block.n_bytes - position,
                     [&](std::size_t i, const unsigned char* items, std::uint64_t count) {
                         check_count(block, block.first_row + block.n_rows, items, i, count);
                         if (i == fan_list_) n_triangles = fan_size(count);
                     });
        if (row_bytes == 0) break;
        position += row_bytes;
        block.n_triangles += n_triangles;
        ++block.n_rows;
    }
    block.n_bytes = position;
}

void RowReader::check_count(const RowBlock& block, std::uint64_t row, const unsigned char* items,
                            std::size_t list, std::uint64_t count) const {
    const std::uint64_t items_offset =
        block.offset + static_cast<std::uint64_t>(items - block.bytes.data());
    const std::uint64_t n_left = file_.size() > items_offset ? file_.size() - items_offset : 0;
    if (count <= n_left / shape_.lists[list].item_units) return;
    const std::string where = place(row, items_offset - shape_.lists[list].count_units);
    if (static_cast<std::int64_t>(count) < 0) {
        throw FormatError(where + ": a list has the negative count " +
                          std::to_string(static_cast<std::int64_t>(count)));
    }
    throw FormatError(where + ": truncated, or no list count: " + std::to_string(count) +
                      " values of " + std::to_string(shape_.lists[list].item_units) +
                      " bytes are announced, " + std::to_string(n_left) +
                      " bytes are left in the file");
}

std::string RowReader::place(std::uint64_t row, std::uint64_t offset) const {
    return file_.path().string() + ": byte " + std::to_string(offset) + ", " + shape_.element +
           " " + std::to_string(row);
}

}  // namespace hewer::streaming

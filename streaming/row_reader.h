// SPDX-License-Identifier: MIT
/// The rows of one element of a binary PLY file as raw blocks, for many threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "ooc/file.h"
#include "streaming/byte_buffer.h"
#include "streaming/ply_rows.h"

namespace hewer::streaming {

/// Most rows of a block: small enough that raw and decoded rows stay in a core's cache.
constexpr std::uint64_t kBlockRows = 16384;

/// Whole, consecutive rows. If `stride` is not 0, all of them have that length and equal list
/// counts, so that a list is at the same place in each.
struct RowBlock {
    ByteBuffer bytes;
    std::size_t n_bytes = 0;
    std::uint64_t offset = 0;  ///< in the file
    std::uint64_t first_row = 0;
    std::uint64_t n_rows = 0;
    std::size_t stride = 0;
    std::uint64_t n_triangles = 0;  ///< in the fans of list `fan_list` of the reader
};

/// Visits the lists of the row at `p`: visit(index, items, count). Returns the length of the row, 0
/// if it needs more than `available` bytes; visit() may throw on counts that it does not believe.
template <typename Visit>
std::size_t walk_row(const RowShape& shape, bool swap, const unsigned char* p,
                     std::size_t available, const Visit& visit) {
    std::size_t position = 0;
    for (std::size_t i = 0; i < shape.lists.size(); ++i) {
        const RowList& list = shape.lists[i];
        position += list.gap;
        if (position + list.count_units > available) return 0;
        const std::uint64_t count =
            static_cast<std::uint64_t>(load_integer(list.count_type, swap, p + position));
        position += list.count_units;
        visit(i, p + position, count);
        if (count > (available - position) / list.item_units) return 0;
        position += static_cast<std::size_t>(count) * list.item_units;
    }
    position += shape.tail;
    return position <= available ? position : 0;
}

/// Hands out the rows in file order. Rows without lists are claimed under the lock and read outside
/// it. Rows with lists are read and cut under it, since only then is it known where the next block
/// begins. The common case, all rows of a block alike (triangles only), is cut by comparing the
/// counts at equal distances; the others are walked.
/// Memory: a block of at most kBlockRows rows for each thread, or one row if that is larger, up to
/// 4 MiB. Throws FormatError: the file ends in a row, a count is negative or beyond the file.
class RowReader {
  public:
    /// @param offset    of the first row.
    /// @param fan_list  the list that RowBlock::n_triangles is about.
    RowReader(const ooc::InputFile& file, std::atomic<std::uint64_t>& n_bytes_read,
              const RowShape& shape, bool swap, std::uint64_t offset, std::size_t fan_list = 0);

    /// Thread-safe. False at the end.
    bool next(RowBlock& block);

    [[nodiscard]] bool is_at_end() const { return next_row_ == shape_.n_rows; }
    /// Where the next row begins, in the file.
    [[nodiscard]] std::uint64_t offset() const { return next_offset_; }

  private:
    void read(RowBlock& block, std::size_t bytes);
    void read_and_cut(RowBlock& block);
    bool cut_alike(RowBlock& block);
    void cut_by_walking(RowBlock& block);
    void check_count(const RowBlock& block, std::uint64_t row, const unsigned char* items,
                     std::size_t list, std::uint64_t count) const;
    [[nodiscard]] std::string place(std::uint64_t row, std::uint64_t offset) const;

    const ooc::InputFile& file_;
    std::atomic<std::uint64_t>& n_bytes_read_;
    const RowShape& shape_;
    bool swap_;
    std::size_t fan_list_;

    std::mutex mutex_;
    std::uint64_t next_row_ = 0;
    std::uint64_t next_offset_;
    struct CountField {
        std::size_t offset;
        std::size_t size;
    };
    std::vector<CountField> count_fields_;  // of the first row of the block that is being cut
};

}  // namespace hewer::streaming

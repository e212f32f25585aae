// SPDX-License-Identifier: MIT
/// The rows of one element of an ASCII PLY file as raw blocks, for many threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>

#include "ooc/file.h"
#include "streaming/byte_buffer.h"
#include "streaming/ply_rows.h"

namespace hewer::streaming {

/// Whole, consecutive rows, each token followed by a blank.
struct TextBlock {
    ByteBuffer bytes;
    std::size_t n_bytes = 0;
    std::uint64_t first_line = 0;  ///< number of the line that the block begins in
    std::uint64_t first_row = 0;
    std::uint64_t n_rows = 0;
    std::uint64_t n_triangles = 0;  ///< in the fans of list `fan_list` of the reader
    ByteBuffer packed;              ///< for the decoder
};

/// Hands out the rows in file order. A row is a number of tokens, as in all readers of the format:
/// that it is also a line is a habit, not a rule. So blocks are cut by counting tokens, under the
/// lock, eight bytes at a time, which costs less than a tenth of decoding them, outside of it.
/// Memory: a block for each thread: about 512 KiB, or one row if that is longer, up to 4 MiB.
/// Throws FormatError: the file ends in a row, a count is no number, negative or beyond the file.
class TextReader {
  public:
    /// @param offset, line  where the first row begins.
    TextReader(const ooc::InputFile& file, std::atomic<std::uint64_t>& n_bytes_read,
               const RowShape& shape, std::uint64_t offset, std::uint64_t line,
               std::size_t fan_list = 0);

    /// Thread-safe. False at the end.
    bool next(TextBlock& block);

    [[nodiscard]] bool is_at_end() const { return next_row_ == shape_.n_rows; }
    [[nodiscard]] std::uint64_t offset() const { return next_offset_; }
    [[nodiscard]] std::uint64_t line() const { return next_line_; }

  private:
    void cut(TextBlock& block);
    const unsigned char* skip_row(const TextBlock& block, const unsigned char* p,
                                  const unsigned char* end, std::uint64_t& n_triangles) const;
    [[noreturn]] void fail(const TextBlock& block, const unsigned char* p,
                           const std::string& what) const;

    const ooc::InputFile& file_;
    std::atomic<std::uint64_t>& n_bytes_read_;
    const RowShape& shape_;
    std::size_t fan_list_;

    std::mutex mutex_;
    std::uint64_t next_row_ = 0;
    std::uint64_t next_offset_;
    std::uint64_t next_line_;
};

/// The number of the line that the byte at `p` is in.
std::uint64_t line_of(const TextBlock& block, const unsigned char* p);

/// The token at `p`, cut to a length that fits a message.
std::string token_text(const TextBlock& block, const unsigned char* p);

}  // namespace hewer::streaming

// SPDX-License-Identifier: MIT
#include "streaming/text_reader.h"

#include <algorithm>

#include "hewer/error.h"
#include "ooc/units.h"
#include "streaming/number_parser.h"

namespace hewer::streaming {

namespace {
constexpr std::size_t kBlockBytes = 512 << 10;
constexpr std::size_t kMaxRowBytes = 4 << 20;
}  // namespace

std::uint64_t line_of(const TextBlock& block, const unsigned char* p) {
    return block.first_line + count_byte(block.bytes.data(), p, '\n');
}

std::string token_text(const TextBlock& block, const unsigned char* p) {
    constexpr std::ptrdiff_t kMaxLength = 40;
    const unsigned char* const end = std::min(p + kMaxLength, block.bytes.data() + block.n_bytes);
    return {p, std::find_if(p, end, is_blank)};
}

TextReader::TextReader(const ooc::InputFile& file, std::atomic<std::uint64_t>& n_bytes_read,
                       const RowShape& shape, std::uint64_t offset, std::uint64_t line,
                       std::size_t fan_list)
    : file_(file),
      n_bytes_read_(n_bytes_read),
      shape_(shape),
      fan_list_(fan_list),
      next_offset_(offset),
      next_line_(line) {}

bool TextReader::next(TextBlock& block) {
    const std::lock_guard lock(mutex_);
    if (is_at_end()) return false;
    block.first_row = next_row_;
    block.first_line = next_line_;
    for (std::size_t bytes = kBlockBytes;; bytes = std::min(4 * bytes, kMaxRowBytes)) {
        unsigned char* data = block.bytes.room_for(bytes + 1);
        block.n_bytes = file_.read_at(next_offset_, data, bytes);
        n_bytes_read_.fetch_add(block.n_bytes, std::memory_order_relaxed);
        const bool is_end_of_file = block.n_bytes < bytes;
        if (is_end_of_file) data[block.n_bytes++] = '\n';  // the last token needs its blank too
        cut(block);
        if (block.n_rows > 0) break;
        if (is_end_of_file) {
            fail(block, data + block.n_bytes - 1,
                 "truncated: the file ends at byte " + std::to_string(file_.size()) +
                     ", within this row; the header announces " + ooc::format_count(shape_.n_rows) +
                     " of them");
        }
        if (bytes == kMaxRowBytes) {
            fail(block, skip_blanks(data, data + block.n_bytes),
                 "a row of more than " + ooc::format_bytes(kMaxRowBytes) +
                     " is beyond what hewer reads");
        }
    }
    next_row_ += block.n_rows;
    next_offset_ += block.n_bytes;
    next_line_ = line_of(block, block.bytes.data() + block.n_bytes);
    return true;
}

/// Cuts the block to its whole rows. If there are none, it stays as long as it was.
void TextReader::cut(TextBlock& block) {
    const unsigned char* p = block.bytes.data();
    const unsigned char* const end = p + block.n_bytes;
    block.n_rows = 0;
    block.n_triangles = 0;
    if (shape_.lists.empty() && shape_.tail > 0) {
        block.n_rows = std::min(shape_.n_rows - next_row_, count_tokens(p, end) / shape_.tail);
        p = skip_tokens(p, end, block.n_rows * shape_.tail);
    } else {
        while (next_row_ + block.n_rows < shape_.n_rows) {
            std::uint64_t n_triangles = 0;
            const unsigned char* row_end = skip_row(block, p, end, n_triangles);
            if (row_end == nullptr) break;
            p = row_end;
            block.n_triangles += n_triangles;
            ++block.n_rows;
        }
    }
    if (block.n_rows > 0) block.n_bytes = static_cast<std::size_t>(p - block.bytes.data());
}

/// The end of the row at `p`, null if it is not before `end`.
const unsigned char* TextReader::skip_row(const TextBlock& block, const unsigned char* p,
                                          const unsigned char* end,
                                          std::uint64_t& n_triangles) const {
    for (std::size_t i = 0; i < shape_.lists.size(); ++i) {
        p = skip_tokens(p, end, shape_.lists[i].gap);
        if (p == nullptr) return nullptr;
        const unsigned char* const token = skip_blanks(p, end);
        std::int64_t count = 0;
        if (end - token > 1 && is_digit(token[0]) && is_blank(token[1])) {  // nearly always
            count = token[0] - '0';
            p = token + 1;
        } else {
            p = skip_tokens(token, end, 1);
            if (p == nullptr) return nullptr;
            if (parse_integer(token, count) == nullptr) {
                fail(block, token,
                     "the list count '" + token_text(block, token) + "' is not a whole number");
            }
        }
        if (count < 0) {
            fail(block, token, "a list has the negative count " + std::to_string(count));
        }
        const std::uint64_t n = static_cast<std::uint64_t>(count);
        const std::uint64_t n_left = file_.size() - next_offset_;
        if (n > n_left / 2) {  // a digit and a blank each
            fail(block, token,
                 "truncated, or no list count: " + std::to_string(n) +
                     " values are announced, at most " + std::to_string(n_left) +
                     " bytes are left in the file");
        }
        p = skip_tokens(p, end, n);
        if (p == nullptr) return nullptr;
        if (i == fan_list_ && n > 2) n_triangles = n - 2;
    }
    return skip_tokens(p, end, shape_.tail);
}

void TextReader::fail(const TextBlock& block, const unsigned char* p,
                      const std::string& what) const {
    throw FormatError(file_.path().string() + ": line " + std::to_string(line_of(block, p)) + ", " +
                      shape_.element + " " + std::to_string(block.first_row + block.n_rows) + ": " +
                      what);
}

}  // namespace hewer::streaming

// SPDX-License-Identifier: MIT
/// A text file in pieces that can be parsed apart from each other, on all threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "ooc/file.h"
#include "ooc/memory_budget.h"
#include "streaming/byte_buffer.h"

namespace hewer::streaming {

/// A piece of a text file, between two of its cuts. A line end follows the last byte, so that every
/// token has a blank behind it and no loop over a line needs a second end condition.
struct TextChunk {
    /// Stands for a line end that has been joined over: a blank that still counts as a line.
    static constexpr unsigned char kJoint = '\v';

    ByteBuffer bytes;
    std::size_t skip = 0;  ///< bytes in front of the chunk
    std::size_t n_bytes = 0;
    std::uint64_t offset = 0;   ///< in the file
    std::uint64_t n_lines = 0;  ///< line ends in it
    unsigned char line_end = '\n';
    bool is_last = false;      ///< the file ends with it
    bool is_too_long = false;  ///< its last line goes on beyond what hewer reads
    bool has_joined_lines = false;
    ooc::Reservation memory;  ///< of what it needs beyond the usual size

    [[nodiscard]] const unsigned char* begin() const { return bytes.data() + skip; }
    [[nodiscard]] const unsigned char* end() const { return begin() + n_bytes; }
    [[nodiscard]] std::uint64_t lines_before(const unsigned char* p) const;
};

/// What the first 64 KiB of a text file tell. Lines end with LF or CR LF; with CR where there is no
/// LF.
struct TextHead {
    explicit TextHead(const ooc::InputFile& file);
    std::uint64_t n_skipped = 0;  ///< of a byte order mark
    unsigned char line_end = '\n';
};

/// What makes a chunk unreadable, and where. Thrown by parsers, which do not know the number of
/// their first line; becomes a FormatError where that is known.
struct TextProblem {
    const unsigned char* at;
    std::string what;
};

/// The token at `p`, in quotes and cut to a length that fits a message.
std::string quote_token(const unsigned char* p, const unsigned char* end);

/// Finds the first place in [from, last] where a file may be cut, null if there is none. Looks at
/// what is in front of `from`, down to `first`, but not beyond `last`.
using FindCut = const unsigned char* (*)(const unsigned char* first, const unsigned char* from,
                                         const unsigned char* last, unsigned char line_end);

/// After a line end, unless a backslash before it continues the line.
const unsigned char* find_line_cut(const unsigned char* first, const unsigned char* from,
                                   const unsigned char* last, unsigned char line_end);

/// The chunks of a file, or of a part of it, without its byte order mark. Chunk i holds what begins
/// in the i-th `chunk_bytes` bytes and ends with the first cut after them. So any thread can read
/// any chunk by itself, and nothing but a few bytes around the cuts is read twice. Chunks may be
/// empty: what is longer than a chunk belongs to the one that it begins in.
///
/// Memory: a chunk, and what parse_bytes() says of it, is reserved by the caller for each one in
/// flight; what a longer line needs beyond that, by read().
/// Throws: IoError; FormatError: the file has become shorter; OutOfMemoryBudget.
class TextChunks {
  public:
    static constexpr std::uint64_t kMaxLineBytes = 64 << 20;
    /// How far a FindCut looks back.
    static constexpr std::uint64_t kLookBack = 256;
    /// What a chunk and all that is parsed from it take, for each byte of text. The most has a
    /// polygon of many one-digit ids: a triangle of 24 bytes for two bytes of text.
    static constexpr std::uint64_t kHeldPerByte = 16;

    TextChunks(const ooc::InputFile& file, ooc::MemoryBudget& budget, std::uint64_t chunk_bytes,
               FindCut find_cut);

    /// The same, for the bytes `first` .. `last` - 1, both of them cuts.
    [[nodiscard]] TextChunks part(std::uint64_t first, std::uint64_t last) const;

    [[nodiscard]] std::uint64_t size() const {
        return (end_ - begin_ + chunk_bytes_ - 1) / chunk_bytes_;
    }
    [[nodiscard]] const ooc::InputFile& file() const { return *file_; }
    /// Bytes to reserve for each chunk in flight.
    [[nodiscard]] std::uint64_t held_bytes() const {
        return (std::min(chunk_bytes_, end_ - begin_) + kSlackBytes) * kHeldPerByte;
    }

    /// Thread-safe.
    void read(std::uint64_t i, TextChunk& chunk) const;

    /// A size of chunks that leaves `n_in_flight` of them within half of what is available; `asked`
    /// if that is not 0.
    static std::uint64_t choose_chunk_bytes(std::uint64_t asked, const ooc::MemoryBudget& budget,
                                            std::uint64_t n_in_flight);

  private:
    // Read together with a chunk, since its last line ends there as a rule.
    static constexpr std::uint64_t kSlackBytes = 4 << 10;

    const ooc::InputFile* file_;
    ooc::MemoryBudget* budget_;
    std::uint64_t chunk_bytes_;
    FindCut find_cut_;
    std::uint64_t begin_ = 0;
    std::uint64_t end_;
    unsigned char line_end_ = '\n';
};

}  // namespace hewer::streaming

// SPDX-License-Identifier: MIT
#include "streaming/text_chunks.h"

#include <cstring>
#include <string_view>
#include <vector>

#include "hewer/error.h"
#include "streaming/number_parser.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kMostChunkBytes = 1 << 20;
constexpr std::uint64_t kLeastChunkBytes = 64 << 10;

}  // namespace

std::uint64_t TextChunk::lines_before(const unsigned char* p) const {
    return count_byte(begin(), p, line_end) +
           (has_joined_lines ? count_byte(begin(), p, kJoint) : 0);
}

std::string quote_token(const unsigned char* p, const unsigned char* end) {
    constexpr std::ptrdiff_t kMaxLength = 40;
    const unsigned char* const last = end - p > kMaxLength ? p + kMaxLength : end;
    return "'" + std::string(p, std::find_if(p, last, is_blank)) + "'";
}

const unsigned char* find_line_cut(const unsigned char* first, const unsigned char* from,
                                   const unsigned char* last, unsigned char line_end) {
    const auto is_cut = [&](const unsigned char* p) {
        if (p == first || p[-1] != line_end) return false;
        const unsigned char* before = p - 1;
        if (before != first && before[-1] == '\r') --before;
        return before == first || before[-1] != '\\';
    };
    for (const unsigned char* p = from;; ++p) {
        if (is_cut(p)) return p;
        p = static_cast<const unsigned char*>(
            std::memchr(p, line_end, static_cast<std::size_t>(last - p)));
        if (p == nullptr) return nullptr;
    }
}

TextHead::TextHead(const ooc::InputFile& file) {
    std::vector<char> bytes(64 << 10);
    const std::string_view head(bytes.data(), file.read_at(0, bytes.data(), bytes.size()));
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (head.substr(0, kByteOrderMark.size()) == kByteOrderMark) n_skipped = kByteOrderMark.size();
    if (head.find('\n') == head.npos && head.find('\r') != head.npos) line_end = '\r';
}

TextChunks::TextChunks(const ooc::InputFile& file, ooc::MemoryBudget& budget,
                       std::uint64_t chunk_bytes, FindCut find_cut)
    : file_(&file),
      budget_(&budget),
      chunk_bytes_(chunk_bytes),
      find_cut_(find_cut),
      end_(file.size()) {
    const TextHead head(file);
    begin_ = head.n_skipped;
    line_end_ = head.line_end;
}

TextChunks TextChunks::part(std::uint64_t first, std::uint64_t last) const {
    TextChunks part = *this;
    part.begin_ = first;
    part.end_ = last;
    return part;
}

std::uint64_t TextChunks::choose_chunk_bytes(std::uint64_t asked, const ooc::MemoryBudget& budget,
                                             std::uint64_t n_in_flight) {
    if (asked != 0) return asked;
    const std::uint64_t share = budget.available() / 2 / n_in_flight / kHeldPerByte;
    return std::clamp(share, kLeastChunkBytes + kSlackBytes, kMostChunkBytes + kSlackBytes) -
           kSlackBytes;
}

void TextChunks::read(std::uint64_t i, TextChunk& chunk) const {
    const std::uint64_t from = begin_ + i * chunk_bytes_;
    const std::uint64_t to = end_ - from > chunk_bytes_ ? from + chunk_bytes_ : end_;
    const auto look_back = [&](std::uint64_t offset) {
        return offset - std::min(kLookBack, offset - begin_);
    };
    const std::uint64_t base = look_back(from);
    chunk.line_end = line_end_;
    chunk.is_too_long = false;
    chunk.has_joined_lines = false;
    chunk.memory.release();
    unsigned char* data = nullptr;
    const auto at = [&](std::uint64_t offset) { return data + (offset - base); };
    // Reads up to `last` and finds where the chunk begins and ends; null: needs more.
    const unsigned char* start = nullptr;
    const unsigned char* stop = nullptr;
    for (std::uint64_t slack = kSlackBytes;; slack = std::min(4 * slack, kMaxLineBytes)) {
        const std::uint64_t last = end_ - to > slack ? to + slack : end_;
        const std::size_t wanted = static_cast<std::size_t>(last - base);
        if (slack > kSlackBytes) {
            chunk.memory.release();
            chunk.memory = budget_->reserve("a long line of text", slack * kHeldPerByte);
        }
        data = chunk.bytes.room_for(wanted + 1);
        if (file_->read_at(base, data, wanted) < wanted) {
            throw FormatError(file_->path().string() +
                              ": the file has become shorter while it was read");
        }
        start = i == 0 ? data : find_cut_(data, at(from), at(to), line_end_);
        if (start == nullptr || start >= at(to)) {  // within what an earlier chunk holds
            start = stop = data;
            break;
        }
        stop = to == end_ ? at(to) : find_cut_(at(look_back(to)), at(to), at(last), line_end_);
        if (stop == nullptr && last == end_) stop = at(end_);
        if (stop != nullptr) break;
        if (slack == kMaxLineBytes) {
            chunk.is_too_long = true;
            stop = at(to);
            break;
        }
    }
    chunk.skip = static_cast<std::size_t>(start - data);
    chunk.n_bytes = static_cast<std::size_t>(stop - start);
    chunk.offset = base + chunk.skip;
    chunk.is_last = chunk.offset + chunk.n_bytes == end_;
    data[stop - data] = line_end_;
    chunk.n_lines = count_byte(chunk.begin(), chunk.end(), line_end_);
}

}  // namespace hewer::streaming

// SPDX-License-Identifier: MIT
#include "streaming/ply_stream.h"

#include "hewer/error.h"
#include "streaming/number_parser.h"

namespace hewer::streaming {

namespace {
constexpr std::size_t kWindowBytes = 1 << 18;
constexpr std::size_t kMaxIntegerToken = 64;
}  // namespace

void PlyStream::fail_at(const std::string& place, const std::string& what) const {
    throw FormatError(file_->path().string() + ": " + place + ", " + element_ + " " +
                      std::to_string(row_) + ": " + what);
}

std::size_t PlyStream::read(std::uint64_t offset, unsigned char* out, std::size_t bytes) {
    const std::size_t got = file_->read_at(offset, out, bytes);
    n_bytes_read_->fetch_add(got, std::memory_order_relaxed);
    return got;
}

void BinaryStream::skip(std::uint64_t bytes) {
    if (bytes > remaining_bytes()) {
        fail("truncated: " + std::to_string(bytes) + " bytes are needed, " +
             std::to_string(remaining_bytes()) + " are left");
    }
    offset_ += bytes;
}

std::int64_t BinaryStream::read_integer(ScalarType type) {
    const std::size_t size = byte_size(type);
    if (offset_ < window_begin_ || offset_ + size > window_begin_ + window_size_) {
        window_begin_ = offset_;
        window_size_ = read(offset_, window_.room_for(kWindowBytes), kWindowBytes);
        if (window_size_ < size) fail("truncated: the file ends here");
    }
    const unsigned char* p = window_.data() + (offset_ - window_begin_);
    offset_ += size;
    return load_integer(type, swap_, p);
}

bool TextStream::refill() {
    window_begin_ += window_size_;
    position_ = 0;
    window_size_ = read(window_begin_, window_.room_for(kWindowBytes), kWindowBytes);
    return window_size_ > 0;
}

void TextStream::skip_blanks() {
    for (int c = peek(); c >= 0 && is_blank(static_cast<unsigned char>(c)); c = peek()) {
        line_ += c == '\n' ? 1 : 0;
        ++position_;
    }
}

void TextStream::skip(std::uint64_t tokens) {
    for (; tokens > 0; --tokens) {
        skip_blanks();
        if (peek() < 0) fail("truncated: the file ends here");
        for (int c = peek(); c >= 0 && !is_blank(static_cast<unsigned char>(c)); c = peek()) {
            ++position_;
        }
    }
}

std::int64_t TextStream::read_integer(ScalarType /*type*/) {
    skip_blanks();
    std::string token;
    for (int c = peek(); c >= 0 && !is_blank(static_cast<unsigned char>(c)); c = peek()) {
        if (token.size() < kMaxIntegerToken) token.push_back(static_cast<char>(c));
        ++position_;
    }
    if (token.empty()) fail("truncated: the file ends here");
    token.push_back('\n');
    std::int64_t value = 0;
    if (parse_integer(reinterpret_cast<const unsigned char*>(token.data()), value) == nullptr) {
        token.pop_back();
        fail("'" + token + "' is not a whole number");
    }
    return value;
}

}  // namespace hewer::streaming

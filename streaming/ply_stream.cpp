// SPDX-License-Identifier: MIT
#include "streaming/ply_stream.h"

#include "hewer/error.h"
#include "streaming/number_parser.h"

namespace hewer::streaming {

namespace {
constexpr std::size_t kWindowBytes = 1 << 18;
constexpr std::size_t kMaxToken = 64;
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

/// The next `size` bytes, until the next call.
const unsigned char* BinaryStream::take(std::size_t size) {
    if (offset_ < window_begin_ || offset_ + size > window_begin_ + window_size_) {
        window_begin_ = offset_;
        window_size_ = read(offset_, window_.room_for(kWindowBytes), kWindowBytes);
        if (window_size_ < size) fail("truncated: the file ends here");
    }
    const unsigned char* p = window_.data() + (offset_ - window_begin_);
    offset_ += size;
    return p;
}

std::int64_t BinaryStream::read_integer(ScalarType type) {
    return load_integer(type, swap_, take(byte_size(type)));
}

double BinaryStream::read_number(ScalarType type) {
    const unsigned char* const p = take(byte_size(type));
    return with_scalar_type(type, [&](auto tag) {
        using T = typename decltype(tag)::Type;
        return static_cast<double>(swap_ ? load<T, true>(p) : load<T, false>(p));
    });
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

/// The next token, with a blank behind it, until the next call.
const unsigned char* TextStream::read_token() {
    skip_blanks();
    token_.clear();
    for (int c = peek(); c >= 0 && !is_blank(static_cast<unsigned char>(c)); c = peek()) {
        if (token_.size() < kMaxToken) token_.push_back(static_cast<char>(c));
        ++position_;
    }
    if (token_.empty()) fail("truncated: the file ends here");
    token_.push_back('\n');
    return reinterpret_cast<const unsigned char*>(token_.data());
}

void TextStream::fail_token(const char* wanted) {
    token_.pop_back();
    fail("'" + token_ + "' is not " + wanted);
}

std::int64_t TextStream::read_integer(ScalarType /*type*/) {
    std::int64_t value = 0;
    if (parse_integer(read_token(), value) == nullptr) fail_token("a whole number");
    return value;
}

double TextStream::read_number(ScalarType /*type*/) {
    double value = 0;
    if (parse_double(read_token(), value) == nullptr) fail_token("a number");
    return value;
}

}  // namespace hewer::streaming

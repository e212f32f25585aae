// SPDX-License-Identifier: MIT
/// PLY data value by value, in binary and in ASCII, through a small window: for the rare parts that
/// are skipped or walked in sequence. Blocks (row_reader.h, text_reader.h) are for the rest.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "ooc/file.h"
#include "streaming/byte_buffer.h"
#include "streaming/scalar_type.h"

namespace hewer::streaming {

/// What both kinds share: the file, the counter of bytes read, and where the walk is.
class PlyStream {
  public:
    PlyStream(const ooc::InputFile& file, std::atomic<std::uint64_t>& n_bytes_read)
        : file_(&file), n_bytes_read_(&n_bytes_read) {}

    /// For messages: the element and row that the next values belong to.
    void enter(const std::string& element) {
        element_ = element;
        row_ = 0;
    }
    void set_row(std::uint64_t row) { row_ = row; }

  protected:
    /// Throws FormatError: path, `place`, element and row, `what`.
    [[noreturn]] void fail_at(const std::string& place, const std::string& what) const;
    std::size_t read(std::uint64_t offset, unsigned char* out, std::size_t bytes);

    const ooc::InputFile* file_;

  private:
    std::atomic<std::uint64_t>* n_bytes_read_;
    std::string element_;
    std::uint64_t row_ = 0;
};

/// Units are bytes.
class BinaryStream : public PlyStream {
  public:
    BinaryStream(const ooc::InputFile& file, std::atomic<std::uint64_t>& n_bytes_read,
                 std::uint64_t offset, bool swap)
        : PlyStream(file, n_bytes_read), offset_(offset), swap_(swap) {}

    static std::size_t units(ScalarType type) { return byte_size(type); }
    /// Throws FormatError if the file ends before that.
    void skip(std::uint64_t bytes);
    std::int64_t read_integer(ScalarType type);
    /// Of any type.
    double read_number(ScalarType type);

    [[nodiscard]] std::uint64_t offset() const { return offset_; }
    [[nodiscard]] std::uint64_t remaining_bytes() const { return file_->size() - offset_; }
    [[nodiscard]] std::string place() const { return "byte " + std::to_string(offset_); }
    [[noreturn]] void fail(const std::string& what) const { fail_at(place(), what); }

  private:
    const unsigned char* take(std::size_t size);

    std::uint64_t offset_;
    bool swap_;
    ByteBuffer window_;
    std::uint64_t window_begin_ = 0;
    std::size_t window_size_ = 0;
};

/// Units are tokens between blanks and line ends.
class TextStream : public PlyStream {
  public:
    /// `line` is the number of the line, from 1, that `offset` is in.
    TextStream(const ooc::InputFile& file, std::atomic<std::uint64_t>& n_bytes_read,
               std::uint64_t offset, std::uint64_t line)
        : PlyStream(file, n_bytes_read), window_begin_(offset), line_(line) {}

    static std::size_t units(ScalarType /*type*/) { return 1; }
    void skip(std::uint64_t tokens);
    std::int64_t read_integer(ScalarType type);
    double read_number(ScalarType type);

    [[nodiscard]] std::uint64_t offset() const { return window_begin_ + position_; }
    [[nodiscard]] std::uint64_t line() const { return line_; }
    [[nodiscard]] std::uint64_t remaining_bytes() const { return file_->size() - offset(); }
    [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }
    [[noreturn]] void fail(const std::string& what) const { fail_at(place(), what); }

  private:
    /// The next byte, or -1 at the end of the file.
    int peek() { return position_ < window_size_ || refill() ? window_.data()[position_] : -1; }
    bool refill();
    void skip_blanks();
    const unsigned char* read_token();
    [[noreturn]] void fail_token(const char* wanted);

    std::uint64_t window_begin_;
    std::uint64_t line_;
    std::string token_;
    ByteBuffer window_;
    std::size_t window_size_ = 0;
    std::size_t position_ = 0;
};

}  // namespace hewer::streaming

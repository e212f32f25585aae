// SPDX-License-Identifier: MIT
/// Files with 64-bit offsets, whole reads and writes, and errors that name path, operation and
/// reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hewer::ooc {

/// A file open for reading at any offset. read_at() may be called by many threads at once.
class InputFile {
  public:
    /// Throws IoError: not there, not readable, a directory.
    explicit InputFile(const std::filesystem::path& path);
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    ~InputFile();

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::uint64_t size() const { return size_; }
    /// Reads up to `bytes` at `offset`, fewer only at the end of the file; returns how many.
    std::size_t read_at(std::uint64_t offset, void* out, std::size_t bytes) const;
    /// Tells the system that the file will be read from front to back.
    void advise_sequential() const;

  private:
    std::filesystem::path path_;
    int fd_ = -1;
    std::uint64_t size_ = 0;
};

/// A file that appears under its name only when it is whole: written beside it under a temporary
/// name
/// ("name.hewer-PID-N.tmp"), then renamed. Destroyed before commit(): the temporary file is
/// removed. Buffered; one thread.
class OutputFile {
  public:
    /// Throws IoError: the folder is missing or not writable, or `path` exists and `overwrite` is
    /// false.
    OutputFile(const std::filesystem::path& path, bool overwrite);
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    ~OutputFile();

    void write(const void* data, std::size_t bytes);
    void write(const std::string& text) { write(text.data(), text.size()); }
    /// Overwrites earlier bytes, for counts that become known at the end. Flushes the buffer.
    void write_at(std::uint64_t offset, const void* data, std::size_t bytes);
    /// Flushes, checks and renames. Throws IoError; the old file, if any, is then untouched.
    void commit();

    [[nodiscard]] std::uint64_t bytes_written() const { return written_ + buffer_.size(); }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    void flush();
    std::filesystem::path path_;
    std::filesystem::path temporary_;
    bool overwrite_ = false;
    int fd_ = -1;
    std::uint64_t written_ = 0;
    std::vector<char> buffer_;
};

/// Removes the temporary files of all OutputFiles that are open. Safe to call in a signal handler.
void remove_temporary_outputs() noexcept;

}  // namespace hewer::ooc

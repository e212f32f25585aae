// SPDX-License-Identifier: MIT
/// Files with 64-bit offsets, whole reads and writes, and errors that name path, operation and
/// reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ooc/pending_file.h"
#include "ooc/spill.h"

namespace hewer::ooc {

/// A file open for reading at any offset. read_at() may be called by many threads at once.
class InputFile {
  public:
    /// Throws IoError: not there, not readable, a directory.
    explicit InputFile(const std::filesystem::path& path);
    /// Reads what `spilled` holds, `size` bytes of it; `name` stands for it in messages.
    InputFile(std::shared_ptr<SpillFile> spilled, std::uint64_t size, std::filesystem::path name);
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    ~InputFile();

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::uint64_t size() const { return size_; }
    /// Of the temporary file behind it; 0 if there is none.
    [[nodiscard]] std::uint64_t held_temp_bytes() const { return spilled_ ? size_ : 0; }
    /// Reads up to `bytes` at `offset`, fewer only at the end of the file; returns how many.
    std::size_t read_at(std::uint64_t offset, void* out, std::size_t bytes) const;
    /// Tells the system to read what is asked for and no more.
    void disable_readahead() const;

  private:
    std::filesystem::path path_;
    std::shared_ptr<SpillFile> spilled_;  // null: a file of its own
    int fd_ = -1;
    std::uint64_t size_ = 0;
};

/// Files that get their names together: all are whole before the first is to be seen. A run that is
/// killed has left all of them or, but for the microseconds between two names, none. One thread.
class OutputGroup {
  public:
    /// Names what was committed into the group, in that order. Throws IoError; what has its name by
    /// then keeps it.
    void publish();

  private:
    friend class OutputFile;
    struct Member {
        std::unique_ptr<PendingFile> file;
        bool overwrite;
    };
    std::vector<Member> members_;
};

/// A file that appears under its name only when it is whole (see PendingFile). Destroyed before
/// commit(), it leaves nothing. Buffered; one thread.
class OutputFile {
  public:
    /// Throws IoError: the folder is missing or not writable; `path` exists and `overwrite` is
    /// false; `path` is a folder, a device or a pipe, which cannot be replaced.
    OutputFile(const std::filesystem::path& path, bool overwrite);
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    ~OutputFile();

    /// commit() then leaves the name to group.publish(). `group` outlives the call.
    void publish_with(OutputGroup& group) { group_ = &group; }

    void write(const void* data, std::size_t bytes);
    void write(const std::string& text) { write(text.data(), text.size()); }
    /// Overwrites earlier bytes, for counts that become known at the end. Flushes the buffer.
    void write_at(std::uint64_t offset, const void* data, std::size_t bytes);
    /// Flushes, checks and gives the file its name. Throws IoError; the old file, if any, is then
    /// untouched.
    void commit();

    [[nodiscard]] std::uint64_t bytes_written() const { return written_ + buffer_.size(); }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    void flush();
    std::filesystem::path path_;
    bool overwrite_ = false;
    OutputGroup* group_ = nullptr;
    std::unique_ptr<PendingFile> file_;  // null after commit()
    std::uint64_t written_ = 0;
    std::vector<char> buffer_;
};

}  // namespace hewer::ooc

// SPDX-License-Identifier: MIT
#include "ooc/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "hewer/error.h"
#include "ooc/io_error.h"

namespace hewer::ooc {

namespace {

constexpr std::size_t kBufferBytes = 1 << 20;

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
    fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd_ < 0) throw_io_error(path, "open", errno);
    struct stat st {};
    if (::fstat(fd_, &st) != 0) {
        const int error = errno;
        ::close(fd_);
        throw_io_error(path, "read the size", error);
    }
    if (S_ISDIR(st.st_mode)) {
        ::close(fd_);
        throw IoError(path.string() + ": is a directory, not a mesh file");
    }
    size_ = static_cast<std::uint64_t>(st.st_size);
}

InputFile::InputFile(std::shared_ptr<SpillFile> spilled, std::uint64_t size,
                     std::filesystem::path name)
    : path_(std::move(name)),
      spilled_(std::move(spilled)),
      fd_(spilled_->descriptor()),
      size_(size) {}

InputFile::~InputFile() {
    if (!spilled_ && fd_ >= 0) ::close(fd_);
}

std::size_t InputFile::read_at(std::uint64_t offset, void* out, std::size_t bytes) const {
    std::size_t done = 0;
    while (done < bytes) {
        const ssize_t n = ::pread(fd_, static_cast<char*>(out) + done, bytes - done,
                                  static_cast<off_t>(offset + done));
        if (n < 0) {
            if (errno == EINTR) continue;
            throw_io_error(path_, "read", errno);
        }
        if (n == 0) break;
        done += static_cast<std::size_t>(n);
    }
    return done;
}

void InputFile::disable_readahead() const {
    (void)::posix_fadvise(fd_, 0, 0, POSIX_FADV_RANDOM);
}

OutputFile::OutputFile(const std::filesystem::path& path, bool overwrite)
    : path_(path), overwrite_(overwrite) {
    struct stat st {};
    if (::stat(path.c_str(), &st) == 0) {
        if (S_ISDIR(st.st_mode)) throw IoError(path.string() + ": is a directory");
        if (!S_ISREG(st.st_mode)) {
            throw IoError(path.string() + ": is a device or a pipe; outputs are ordinary files");
        }
        if (!overwrite)
            throw IoError(path.string() + ": exists already; use --force to replace it");
    }
    file_ = std::make_unique<PendingFile>(path);
    buffer_.reserve(kBufferBytes);
}

OutputFile::~OutputFile() = default;

void OutputFile::write(const void* data, std::size_t bytes) {
    const char* p = static_cast<const char*>(data);
    while (bytes > 0) {
        const std::size_t part = std::min(bytes, kBufferBytes - buffer_.size());
        buffer_.insert(buffer_.end(), p, p + part);
        p += part;
        bytes -= part;
        if (buffer_.size() == kBufferBytes) flush();
    }
}

void OutputFile::flush() {
    std::size_t done = 0;
    while (done < buffer_.size()) {
        const ssize_t n =
            ::write(file_->descriptor(), buffer_.data() + done, buffer_.size() - done);
        if (n < 0) {
            if (errno == EINTR) continue;
            throw_io_error(path_, "write", errno);
        }
        done += static_cast<std::size_t>(n);
    }
    written_ += buffer_.size();
    buffer_.clear();
}

void OutputFile::write_at(std::uint64_t offset, const void* data, std::size_t bytes) {
    flush();
    std::size_t done = 0;
    while (done < bytes) {
        const ssize_t n = ::pwrite(file_->descriptor(), static_cast<const char*>(data) + done,
                                   bytes - done, static_cast<off_t>(offset + done));
        if (n < 0) {
            if (errno == EINTR) continue;
            throw_io_error(path_, "write", errno);
        }
        done += static_cast<std::size_t>(n);
    }
}

void OutputFile::commit() {
    flush();
    buffer_ = std::vector<char>();
    if (group_ != nullptr) {
        file_->check_written();
        group_->members_.push_back({std::move(file_), overwrite_});
    } else {
        file_->publish(overwrite_);
        file_.reset();
    }
}

void OutputGroup::publish() {
    for (const Member& member : members_) member.file->publish(member.overwrite);
    members_.clear();
}

}  // namespace hewer::ooc

// SPDX-License-Identifier: MIT
#include "ooc/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "hewer/error.h"

namespace hewer::ooc {

namespace {

constexpr std::size_t kBufferBytes = 1 << 20;

[[noreturn]] void fail(const std::filesystem::path& path, const char* operation, int error) {
    std::string text = path.string() + ": cannot " + operation + ": " + std::strerror(error);
    if (error == ENOSPC || error == EDQUOT) {
        text += "; free some space there or choose another place for the output";
    }
    throw IoError(text);
}

// Paths of temporary files, for a signal handler: fixed storage, no locks. A slot is owned by the
// OutputFile that took it; text is written before the slot is published.
constexpr std::size_t kSlots = 64;
constexpr std::size_t kPathBytes = 4096;
struct Slot {
    std::atomic<int> state{0};  // 0 free, 1 being filled, 2 published
    std::array<char, kPathBytes> path{};
};
std::array<Slot, kSlots> g_slots;

void publish(const std::filesystem::path& path) {
    const std::string text = std::filesystem::absolute(path).string();
    if (text.size() >= kPathBytes) return;
    for (Slot& slot : g_slots) {
        int expected = 0;
        if (slot.state.compare_exchange_strong(expected, 1)) {
            std::memcpy(slot.path.data(), text.c_str(), text.size() + 1);
            slot.state.store(2);
            return;
        }
    }
}

void withdraw(const std::filesystem::path& path) {
    const std::string text = std::filesystem::absolute(path).string();
    for (Slot& slot : g_slots) {
        if (slot.state.load() == 2 && text == slot.path.data()) {
            slot.state.store(0);
            return;
        }
    }
}

}  // namespace

void remove_temporary_outputs() noexcept {
    for (Slot& slot : g_slots) {
        if (slot.state.load() == 2) ::unlink(slot.path.data());
    }
}

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
    fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd_ < 0) fail(path, "open", errno);
    struct stat st {};
    if (::fstat(fd_, &st) != 0) {
        const int error = errno;
        ::close(fd_);
        fail(path, "read the size", error);
    }
    if (S_ISDIR(st.st_mode)) {
        ::close(fd_);
        throw IoError(path.string() + ": is a directory, not a mesh file");
    }
    size_ = static_cast<std::uint64_t>(st.st_size);
}

InputFile::~InputFile() {
    if (fd_ >= 0) ::close(fd_);
}

std::size_t InputFile::read_at(std::uint64_t offset, void* out, std::size_t bytes) const {
    std::size_t done = 0;
    while (done < bytes) {
        const ssize_t n = ::pread(fd_, static_cast<char*>(out) + done, bytes - done,
                                  static_cast<off_t>(offset + done));
        if (n < 0) {
            if (errno == EINTR) continue;
            fail(path_, "read", errno);
        }
        if (n == 0) break;
        done += static_cast<std::size_t>(n);
    }
    return done;
}

void InputFile::advise_sequential() const {
    (void)::posix_fadvise(fd_, 0, 0, POSIX_FADV_SEQUENTIAL);
}

OutputFile::OutputFile(const std::filesystem::path& path, bool overwrite)
    : path_(path), overwrite_(overwrite) {
    struct stat st {};
    if (::stat(path.c_str(), &st) == 0) {
        if (S_ISDIR(st.st_mode)) throw IoError(path.string() + ": is a directory");
        if (!overwrite)
            throw IoError(path.string() + ": exists already; use --force to replace it");
    }
    static std::atomic<unsigned> counter{0};
    temporary_ = path;
    temporary_ += ".hewer-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp";
    fd_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd_ < 0) {
        const int error = errno;
        if (error == ENOENT) {
            throw IoError(path.string() + ": cannot create: the folder " +
                          (path.has_parent_path() ? path.parent_path() : ".").string() +
                          " does not exist");
        }
        fail(path, "create", error);
    }
    publish(temporary_);
    buffer_.reserve(kBufferBytes);
}

OutputFile::~OutputFile() {
    if (fd_ >= 0) {
        ::close(fd_);
        ::unlink(temporary_.c_str());
        withdraw(temporary_);
    }
}

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
        const ssize_t n = ::write(fd_, buffer_.data() + done, buffer_.size() - done);
        if (n < 0) {
            if (errno == EINTR) continue;
            fail(path_, "write", errno);
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
        const ssize_t n = ::pwrite(fd_, static_cast<const char*>(data) + done, bytes - done,
                                   static_cast<off_t>(offset + done));
        if (n < 0) {
            if (errno == EINTR) continue;
            fail(path_, "write", errno);
        }
        done += static_cast<std::size_t>(n);
    }
}

void OutputFile::commit() {
    flush();
    const int fd = std::exchange(fd_, -1);
    if (::close(fd) != 0) {
        const int error = errno;
        ::unlink(temporary_.c_str());
        withdraw(temporary_);
        fail(path_, "write", error);
    }
    // RENAME_NOREPLACE: the promise not to overwrite holds even if somebody made the file while we
    // worked. File systems that do not know the flag get a plain rename.
    int result = 0;
    if (overwrite_) {
        result = ::rename(temporary_.c_str(), path_.c_str());
    } else {
        result =
            ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE);
        if (result != 0 && (errno == EINVAL || errno == ENOSYS)) {
            result = ::rename(temporary_.c_str(), path_.c_str());
        }
    }
    if (result != 0) {
        const int error = errno;
        ::unlink(temporary_.c_str());
        withdraw(temporary_);
        fail(path_, "give the finished file its name", error);
    }
    withdraw(temporary_);
}

}  // namespace hewer::ooc

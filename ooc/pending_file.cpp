// SPDX-License-Identifier: MIT
#include "ooc/pending_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "hewer/error.h"
#include "ooc/io_error.h"

namespace hewer::ooc {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = ".hewer-";
constexpr std::string_view kEnding = ".tmp";

// Temporary names, for a signal handler: fixed storage, no locks. A slot is owned by the file that
// took it; text is written before the slot is announced.
constexpr std::size_t kSlots = 64;
constexpr std::size_t kPathBytes = 4096;
struct Slot {
    std::atomic<int> state{0};  // 0 free, 1 being filled, 2 announced
    std::array<char, kPathBytes> path{};
};
std::array<Slot, kSlots> g_slots;

void announce(const fs::path& path) {
    const std::string text = fs::absolute(path).string();
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

void withdraw(const fs::path& path) {
    std::error_code ignored;
    const std::string text = fs::absolute(path, ignored).string();
    for (Slot& slot : g_slots) {
        if (slot.state.load() == 2 && text == slot.path.data()) {
            slot.state.store(0);
            return;
        }
    }
}

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Through /proc, since linkat() of a bare descriptor asks for a capability.
std::string proc_name(int fd) {
    return "/proc/self/fd/" + std::to_string(fd);
}

int open_without_name(const fs::path& folder) {
    return ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
}

/// Whether a file without a name can get `name` later: tried with an empty one, so that hours of
/// work do not end in a refusal (no /proc, a file system without links).
bool can_link_later(const fs::path& folder, const fs::path& name) {
    const int fd = open_without_name(folder);
    if (fd < 0) return false;
    const bool can =
        ::linkat(AT_FDCWD, proc_name(fd).c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
    if (can) ::unlink(name.c_str());
    ::close(fd);
    return can;
}

/// Nobody holds the lock: its owner is dead. A file system without locks keeps its left-overs.
void remove_if_abandoned(const fs::path& name) {
    const int fd = ::open(name.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) return;
    struct stat st {};
    if (::fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && ::flock(fd, LOCK_EX | LOCK_NB) == 0) {
        ::unlink(name.c_str());
    }
    ::close(fd);
}

/// "OUTPUT.hewer-PID-N.tmp", and nothing that somebody else may have called so.
bool is_temporary_name_of(const std::string& name, const std::string& output) {
    const std::string start = output + std::string(kMark);
    if (!name.starts_with(start) || !name.ends_with(kEnding)) return false;
    const std::size_t length = name.size() - start.size();
    if (length <= kEnding.size()) return false;
    const std::string numbers = name.substr(start.size(), length - kEnding.size());
    return numbers.find_first_not_of("0123456789-") == std::string::npos;
}

void remove_abandoned(const fs::path& path) {
    const std::string output = path.filename().string();
    std::error_code ignored;  // a folder that cannot be listed may still be written
    fs::directory_iterator entry(folder_of(path), ignored);
    for (const fs::directory_iterator end; !ignored && entry != end; entry.increment(ignored)) {
        if (is_temporary_name_of(entry->path().filename().string(), output)) {
            remove_if_abandoned(entry->path());
        }
    }
}

}  // namespace

void remove_temporary_outputs() noexcept {
    for (Slot& slot : g_slots) {
        if (slot.state.load() == 2) ::unlink(slot.path.data());
    }
}

PendingFile::PendingFile(const fs::path& path, Naming naming) : path_(path) {
    remove_abandoned(path_);
    if (naming == Naming::FromTheStart || !open_unnamed()) open_named();
}

PendingFile::~PendingFile() {
    remove_temporary();
    if (fd_ >= 0) ::close(fd_);
}

fs::path PendingFile::next_temporary_name() const {
    static std::atomic<unsigned> counter{0};
    fs::path name = path_;
    name += kMark;
    name += std::to_string(::getpid()) + '-' + std::to_string(counter++);
    name += kEnding;
    return name;
}

bool PendingFile::open_unnamed() {
    const fs::path folder = folder_of(path_);
    if (!can_link_later(folder, next_temporary_name())) return false;
    fd_ = open_without_name(folder);
    // Locked before it has a name: whoever finds it then finds it locked.
    if (fd_ >= 0) (void)::flock(fd_, LOCK_EX | LOCK_NB);
    return fd_ >= 0;
}

void PendingFile::open_named() {
    for (;;) {
        temporary_ = next_temporary_name();
        fd_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd_ < 0) {
            const int error = errno;
            if (error == EEXIST) continue;  // of a process with the same number elsewhere
            temporary_.clear();
            if (error == ENOENT) {
                throw IoError(path_.string() + ": cannot create: the folder " +
                              folder_of(path_).string() + " does not exist");
            }
            throw_io_error(path_, "create", error);
        }
        (void)::flock(fd_, LOCK_EX | LOCK_NB);
        struct stat st {};
        // Another process may have taken it for a left-over before the lock was there.
        if (::fstat(fd_, &st) == 0 && st.st_nlink > 0) break;
        ::close(fd_);
    }
    announce(temporary_);
}

void PendingFile::check_written() const {
    // NFS reports what failed on the way to the server when a descriptor is closed, any of them.
    const int copy = ::dup(fd_);
    if (copy >= 0 && ::close(copy) != 0) throw_io_error(path_, "write", errno);
}

bool PendingFile::link_to(const fs::path& name) const {
    if (::linkat(AT_FDCWD, proc_name(fd_).c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) ==
        0) {
        return true;
    }
    if (errno != EEXIST) throw_io_error(path_, "give the finished file its name", errno);
    return false;
}

void PendingFile::link_temporary() {
    for (fs::path name = next_temporary_name();; name = next_temporary_name()) {
        announce(name);
        temporary_ = name;
        try {
            if (link_to(name)) return;
        } catch (...) {
            withdraw(std::exchange(temporary_, {}));
            throw;
        }
        withdraw(std::exchange(temporary_, {}));
    }
}

void PendingFile::publish(bool overwrite) {
    check_written();
    if (temporary_.empty()) {
        // The promise not to overwrite holds even if somebody made the file while we worked.
        if (link_to(path_)) return;
        if (!overwrite) throw_io_error(path_, "give the finished file its name", EEXIST);
        link_temporary();
    }
    rename_temporary(overwrite);
}

void PendingFile::rename_temporary(bool overwrite) {
    int result = 0;
    if (overwrite) {
        result = ::rename(temporary_.c_str(), path_.c_str());
    } else {
        // File systems that do not know the flag get a plain rename.
        result =
            ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE);
        if (result != 0 && (errno == EINVAL || errno == ENOSYS)) {
            result = ::rename(temporary_.c_str(), path_.c_str());
        }
    }
    if (result != 0) throw_io_error(path_, "give the finished file its name", errno);
    withdraw(std::exchange(temporary_, {}));
}

void PendingFile::remove_temporary() noexcept {
    if (temporary_.empty()) return;
    ::unlink(temporary_.c_str());
    withdraw(temporary_);
}

}  // namespace hewer::ooc

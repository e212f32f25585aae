// SPDX-License-Identifier: MIT
#include "ooc/spill.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "hewer/error.h"
#include "ooc/units.h"

namespace hewer::ooc {

namespace {

std::string reason(int error) {
    return std::generic_category().message(error);
}

int open_unnamed(const std::filesystem::path& folder) {
    int fd = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC | O_EXCL, 0600);
    if (fd < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
        std::string name = (folder / "hewer-spill-XXXXXX").string();
        fd = ::mkostemp(name.data(), O_CLOEXEC);
        if (fd >= 0) ::unlink(name.c_str());
    }
    if (fd < 0) {
        throw IoError(folder.string() + ": cannot create a temporary file: " + reason(errno) +
                      "; name another folder with --temp-dir");
    }
    return fd;
}

}  // namespace

SpillSpace::SpillSpace(std::filesystem::path folder, std::uint64_t limit)
    : folder_(std::move(folder)), limit_(limit) {
    if (folder_.empty()) {
        const char* const tmpdir = std::getenv("TMPDIR");
        folder_ = tmpdir != nullptr && *tmpdir != '\0' ? tmpdir : "/tmp";
        return;  // whether it is any good matters only if something is spilled
    }
    if (!std::filesystem::is_directory(folder_)) {
        throw IoError(folder_.string() + ": the folder for temporary files does not exist");
    }
    if (::access(folder_.c_str(), W_OK | X_OK) != 0) {
        throw IoError(folder_.string() +
                      ": cannot write to the folder for temporary files: " + reason(errno));
    }
}

void SpillSpace::throw_limit_reached(std::uint64_t bytes) const {
    throw OutOfDiskBudget(folder_.string() + ": no room for " + format_bytes(bytes) +
                          " more of temporary files: " + format_bytes(used()) +
                          " are in use, the limit is " + format_bytes(limit_) +
                          "; raise --max-temp, or raise --memory so that less goes to disk");
}

void SpillSpace::throw_disk_full(std::uint64_t bytes) const {
    struct statvfs disk {};
    std::string size;
    if (::statvfs(folder_.c_str(), &disk) == 0) {
        size = " of " + format_bytes(std::uint64_t{disk.f_blocks} * disk.f_frsize) + " in all";
    }
    // What could not be written counts as used already.
    const std::uint64_t ours = used() - std::min(used(), bytes);
    throw OutOfDiskBudget(folder_.string() + ": the disk" + size + " is full: no room for " +
                          format_bytes(bytes) + " more of temporary files, " + format_bytes(ours) +
                          " are in use" +
                          (limit_ != 0 ? ", the limit is " + format_bytes(limit_) : std::string()) +
                          "; free some space there, name another disk with --temp-dir, or raise "
                          "--memory so that less goes to disk");
}

void SpillSpace::take(std::uint64_t bytes) {
    std::uint64_t used = used_.load(std::memory_order_relaxed);
    do {
        if (limit_ != 0 && used + bytes > limit_) throw_limit_reached(bytes);
    } while (!used_.compare_exchange_weak(used, used + bytes, std::memory_order_relaxed));
    std::uint64_t peak = peak_.load(std::memory_order_relaxed);
    while (peak < used + bytes &&
           !peak_.compare_exchange_weak(peak, used + bytes, std::memory_order_relaxed)) {
    }
}

SpillFile::SpillFile(SpillSpace& space) : space_(space), fd_(open_unnamed(space.folder())) {
    // Merges read many files in turn: where memory is short, what the system reads ahead of a
    // sector is gone before its turn comes.
    (void)::posix_fadvise(fd_, 0, 0, POSIX_FADV_RANDOM);
}

SpillFile::~SpillFile() {
    ::close(fd_);
    space_.give_back(bytes_);
}

void SpillFile::write_at(std::uint64_t offset, const void* data, std::uint64_t bytes) {
    space_.take(bytes);
    bytes_ += bytes;
    std::uint64_t done = 0;
    while (done < bytes) {
        const ssize_t n = ::pwrite(fd_, static_cast<const char*>(data) + done, bytes - done,
                                   static_cast<off_t>(offset + done));
        if (n < 0) {
            if (errno == EINTR) continue;
            if (errno == ENOSPC || errno == EDQUOT) space_.throw_disk_full(bytes - done);
            throw IoError(space_.folder().string() +
                          ": cannot write a temporary file: " + reason(errno));
        }
        done += static_cast<std::uint64_t>(n);
    }
    // Written out at once: a control group that is full of dirty pages has to wait for the disk.
    (void)::sync_file_range(fd_, static_cast<off_t>(offset), static_cast<off_t>(bytes),
                            SYNC_FILE_RANGE_WRITE);
    space_.written_.fetch_add(bytes, std::memory_order_relaxed);
}

void SpillFile::read_at(std::uint64_t offset, void* out, std::uint64_t bytes) const {
    std::uint64_t done = 0;
    while (done < bytes) {
        const ssize_t n = ::pread(fd_, static_cast<char*>(out) + done, bytes - done,
                                  static_cast<off_t>(offset + done));
        if (n < 0) {
            if (errno == EINTR) continue;
            throw IoError(space_.folder().string() +
                          ": cannot read a temporary file: " + reason(errno));
        }
        if (n == 0) {
            throw IoError(space_.folder().string() + ": a temporary file is shorter than it was");
        }
        done += static_cast<std::uint64_t>(n);
    }
    space_.read_.fetch_add(bytes, std::memory_order_relaxed);
}

void SpillFile::discard(std::uint64_t offset, std::uint64_t bytes) {
    if (::fallocate(fd_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset),
                    static_cast<off_t>(bytes)) != 0) {
        return;  // not every file system can; the space comes back with the file
    }
    bytes_ -= bytes;
    space_.give_back(bytes);
}

std::uint64_t checksum(const void* data, std::uint64_t bytes) {
    constexpr std::uint64_t kPrime = 0x9e3779b97f4a7c15ULL;
    std::array<std::uint64_t, 4> lanes{1, 2, 3, 4};
    const auto* p = static_cast<const unsigned char*>(data);
    const auto mix = [&](std::uint64_t& lane, std::uint64_t word) {
        lane = std::rotl((lane ^ word) * kPrime, 29);
    };
    std::uint64_t left = bytes;
    for (; left >= 32; left -= 32, p += 32) {
        std::array<std::uint64_t, 4> words;
        std::memcpy(words.data(), p, 32);
        for (std::size_t i = 0; i < 4; ++i) mix(lanes[i], words[i]);
    }
    std::array<std::uint64_t, 4> rest{};
    std::memcpy(rest.data(), p, left);
    for (std::size_t i = 0; i < 4; ++i) mix(lanes[i], rest[i]);
    std::uint64_t sum = bytes;
    for (const std::uint64_t lane : lanes) mix(sum, lane);
    return sum;
}

}  // namespace hewer::ooc

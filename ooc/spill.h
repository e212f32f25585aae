// SPDX-License-Identifier: MIT
/// Temporary disk space of a run: files without a name, their bytes counted against a limit.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <utility>

namespace hewer::ooc {

/// Where spilled pages go. Files have no name (O_TMPFILE, or unlinked as soon as they are open), so
/// nothing is left behind however the run ends, kill -9 and power cuts included, and no other run
/// can meet them. Thread-safe.
class SpillSpace {
  public:
    /// `folder` empty: TMPDIR, else /tmp. `limit` 0: none. A folder that was named must be there
    /// and writable: IoError. Touches the disk only when the first file is made.
    SpillSpace(std::filesystem::path folder, std::uint64_t limit);

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    [[nodiscard]] std::uint64_t used() const { return used_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t peak() const { return peak_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t bytes_written() const { return written_.load(); }
    [[nodiscard]] std::uint64_t bytes_read() const { return read_.load(); }

    /// Bytes of files that are not this object's, but count against its limit.
    class Share {
      public:
        /// Throws OutOfDiskBudget beyond the limit.
        Share(SpillSpace& space, std::uint64_t bytes) : space_(&space), bytes_(bytes) {
            if (bytes > 0) space.take(bytes);
        }
        Share(Share&& other) noexcept
            : space_(other.space_), bytes_(std::exchange(other.bytes_, 0)) {}
        Share& operator=(Share&&) = delete;
        ~Share() { space_->give_back(bytes_); }

      private:
        SpillSpace* space_;
        std::uint64_t bytes_;
    };

  private:
    friend class SpillFile;
    /// Throws OutOfDiskBudget beyond the limit.
    void take(std::uint64_t bytes);
    void give_back(std::uint64_t bytes) { used_.fetch_sub(bytes, std::memory_order_relaxed); }
    [[noreturn]] void throw_limit_reached(std::uint64_t bytes) const;
    [[noreturn]] void throw_disk_full(std::uint64_t bytes) const;

    std::filesystem::path folder_;
    std::uint64_t limit_;
    std::atomic<std::uint64_t> used_{0};
    std::atomic<std::uint64_t> peak_{0};
    std::atomic<std::uint64_t> written_{0};
    std::atomic<std::uint64_t> read_{0};
};

/// One such file. Writing by one thread at a time, reading by any.
class SpillFile {
  public:
    explicit SpillFile(SpillSpace& space);
    SpillFile(const SpillFile&) = delete;
    SpillFile& operator=(const SpillFile&) = delete;
    ~SpillFile();

    /// Throws OutOfDiskBudget when the limit or the disk is used up, else IoError.
    void write_at(std::uint64_t offset, const void* data, std::uint64_t bytes);
    /// Exactly so many bytes, or IoError.
    void read_at(std::uint64_t offset, void* out, std::uint64_t bytes) const;
    /// Gives the space of a range back.
    void discard(std::uint64_t offset, std::uint64_t bytes);
    /// For tests that damage it.
    [[nodiscard]] int descriptor() const { return fd_; }

  private:
    SpillSpace& space_;
    int fd_ = -1;
    std::uint64_t bytes_ = 0;
};

/// Four lanes of multiply and rotate; some 10 GB/s. Finds damage, not malice.
std::uint64_t checksum(const void* data, std::uint64_t bytes);

}  // namespace hewer::ooc

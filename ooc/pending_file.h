// SPDX-License-Identifier: MIT
/// The file behind an output, from its first byte until it is whole.
#pragma once

#include <filesystem>
#include <string>

namespace hewer::ooc {

/// A new file that gets its name in publish(), and only there; destroyed before, it is gone.
///
/// Where the file system can do it (ext4, XFS, Btrfs, tmpfs, overlays of them: O_TMPFILE and
/// linkat()), the file has no name until then. However the process ends, kill -9 and power cuts
/// included, its space comes back at once and nobody finds half a file. Two cases need a name
/// beside the output, "name.hewer-PID-N.tmp":
/// - linkat() does not replace a file. To replace one, the whole file is linked under that name and
///   renamed over the old one in the next system call.
/// - Elsewhere (NFS, FAT) the file bears that name from its first byte.
/// A process that is killed in between leaves it, so the next PendingFile for the same path removes
/// those that nobody works on. That is told by a lock (flock) that each owner holds as long as the
/// file is open, not by the process ID: folders are shared by containers, in which every process
/// may be number 1.
///
/// Rejected: left-overs and locks alone, without O_TMPFILE. It is one mechanism fewer, but the disk
/// stays full of a dead run's gigabytes until somebody runs the same command again.
class PendingFile {
  public:
    enum class Naming {
        WhenWhole,     ///< where the file system can, else FromTheStart
        FromTheStart,  ///< for tests
    };

    /// Throws IoError: the folder is missing or not writable.
    explicit PendingFile(const std::filesystem::path& path, Naming naming = Naming::WhenWhole);
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;
    ~PendingFile();

    /// Open for writing.
    [[nodiscard]] int descriptor() const { return fd_; }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    /// Waits for errors that a network file system tells late. Throws IoError.
    void check_written() const;
    /// Gives the file its name, replacing what is there only if `overwrite`. Once. Throws IoError;
    /// the old file, if any, is then untouched.
    void publish(bool overwrite);

  private:
    [[nodiscard]] std::filesystem::path next_temporary_name() const;
    bool open_unnamed();
    void open_named();
    /// Gives an unnamed file its temporary name.
    void link_temporary();
    /// Links the unnamed file to `name`; false if that exists.
    bool link_to(const std::filesystem::path& name) const;
    void rename_temporary(bool overwrite);
    void remove_temporary() noexcept;

    std::filesystem::path path_;
    std::filesystem::path temporary_;  // empty: no name yet
    int fd_ = -1;
};

/// Removes the temporary names of all PendingFiles. Safe to call in a signal handler.
void remove_temporary_outputs() noexcept;

}  // namespace hewer::ooc

// SPDX-License-Identifier: MIT
/// A file that is made while an input is opened, and read like an input from there.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "ooc/spill.h"

namespace hewer::streaming {

/// Written by one thread, then finish()ed. It has no name on the disk and is gone with the last
/// InputFile that reads it. Throws: OutOfDiskBudget, IoError.
class TemporaryInput {
  public:
    /// In the folder of the options, against their limit.
    explicit TemporaryInput(const OpenOptions& options)
        : holder_(std::make_shared<Holder>(options)) {}

    void append(const void* data, std::uint64_t n_bytes) {
        holder_->file.write_at(n_bytes_, data, n_bytes);
        n_bytes_ += n_bytes;
    }
    /// Replaces bytes that were appended before.
    void write_at(std::uint64_t offset, const void* data, std::uint64_t n_bytes) {
        holder_->file.write_at(offset, data, n_bytes);
    }
    [[nodiscard]] std::uint64_t size() const { return n_bytes_; }

    /// @param name  stands for it in messages.
    std::unique_ptr<ooc::InputFile> finish(const std::filesystem::path& name) {
        return std::make_unique<ooc::InputFile>(
            std::shared_ptr<ooc::SpillFile>(holder_, &holder_->file), n_bytes_, name);
    }

  private:
    struct Holder {
        explicit Holder(const OpenOptions& options)
            : space(options.temp_dir, options.max_temp_bytes), file(space) {}
        ooc::SpillSpace space;
        ooc::SpillFile file;
    };
    std::shared_ptr<Holder> holder_;
    std::uint64_t n_bytes_ = 0;
};

/// The limits that are left beside `held_temp_bytes` of temporary files that are there already.
inline OpenOptions beside(OpenOptions options, std::uint64_t held_temp_bytes) {
    if (options.max_temp_bytes != 0) {
        options.max_temp_bytes -= std::min(options.max_temp_bytes - 1, held_temp_bytes);
    }
    return options;
}

}  // namespace hewer::streaming

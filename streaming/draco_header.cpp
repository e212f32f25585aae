// SPDX-License-Identifier: MIT
#include "streaming/draco_header.h"

#include <draco/compression/config/compression_shared.h>

#include <cstddef>
#include <vector>

namespace hewer::streaming {

namespace {

// "DRACO", version, kind of geometry, method, flags.
constexpr std::size_t kHeaderBytes = 11;
constexpr std::size_t kMajorAt = 5;
constexpr std::size_t kMinorAt = 6;
constexpr std::size_t kKindAt = 7;
constexpr std::size_t kMethodAt = 8;
constexpr std::size_t kFlagsAt = 10;  // the high byte, which has the flag of metadata
constexpr unsigned char kHasMetadata = METADATA_FLAG_MASK >> 8;
constexpr std::size_t kBeginning = 64 << 10;

/// Numbers of the header, one after the other; once the data has ended, zeros.
class HeaderReader {
  public:
    explicit HeaderReader(std::span<const char> bytes) : bytes_(bytes) {}

    [[nodiscard]] bool has_ended() const { return has_ended_; }
    std::uint64_t byte() {
        if (at_ >= bytes_.size()) {
            has_ended_ = true;
            return 0;
        }
        return static_cast<unsigned char>(bytes_[at_++]);
    }
    void skip(std::uint64_t n) {
        has_ended_ = has_ended_ || n > bytes_.size() - at_;
        at_ += has_ended_ ? 0 : static_cast<std::size_t>(n);
    }
    std::uint64_t word() {
        std::uint64_t value = 0;
        for (unsigned shift = 0; shift < 32; shift += 8) value |= byte() << shift;
        return value;
    }
    std::uint64_t varint() {
        std::uint64_t value = 0;
        for (unsigned shift = 0; shift < 35; shift += 7) {
            const std::uint64_t b = byte();
            value |= (b & 0x7fU) << shift;
            if ((b & 0x80U) == 0) break;
        }
        return value & 0xffffffffU;
    }

    /// Of the whole geometry, after that of attributes: entries with a name and a value, and more
    /// of the same, with a name, inside. Every step of a loop takes a byte at least.
    void skip_metadata() {
        for (std::uint64_t n = varint(); n > 0 && !has_ended_; --n) {
            (void)varint();  // of which attribute
            skip_nested();
        }
        skip_nested();
    }

  private:
    void skip_nested() {
        std::vector<std::uint64_t> left{1};  // by depth
        while (!left.empty() && !has_ended_) {
            if (left.back() == 0) {
                left.pop_back();
                continue;
            }
            --left.back();
            if (left.size() > 1) skip(byte());
            for (std::uint64_t n = varint(); n > 0 && !has_ended_; --n) {
                skip(byte());
                skip(varint());
            }
            left.push_back(varint());
        }
    }

    std::span<const char> bytes_;
    std::size_t at_ = kHeaderBytes;
    bool has_ended_ = false;
};

}  // namespace

std::optional<DracoCounts> announced_counts(std::span<const char> bytes) {
    if (bytes.size() < kHeaderBytes) return {};
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
    const unsigned version = 256U * at(kMajorAt) + at(kMinorAt);
    constexpr unsigned kMetadata = 0x103;
    constexpr unsigned kVarints = 0x200;
    constexpr unsigned kSequentialVarints = 0x202;
    constexpr unsigned kNoNewVertices = 0x202;
    HeaderReader reader(bytes);
    if (version >= kMetadata && (at(kFlagsAt) & kHasMetadata) != 0) reader.skip_metadata();
    const bool is_edgebreaker = at(kMethodAt) == draco::MESH_EDGEBREAKER_ENCODING;
    const auto number = [&] {
        return version >= (is_edgebreaker ? kVarints : kSequentialVarints) ? reader.varint()
                                                                           : reader.word();
    };
    DracoCounts counts;
    if (is_edgebreaker) {
        (void)reader.byte();  // kind of traversal
        if (version < kNoNewVertices) (void)number();
        counts.n_points = number();
        counts.n_faces = number();
    } else {
        counts.n_faces = number();
        counts.n_points = number();
    }
    if (reader.has_ended()) return {};
    return counts;
}

std::optional<DracoCounts> announced_counts(const ooc::InputFile& file) {
    std::vector<char> bytes(kBeginning);
    bytes.resize(file.read_at(0, bytes.data(), bytes.size()));
    if (bytes.size() <= kKindAt || bytes[kKindAt] != draco::TRIANGULAR_MESH) return {};
    return announced_counts(std::span<const char>(bytes));
}

}  // namespace hewer::streaming

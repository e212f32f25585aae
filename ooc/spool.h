// SPDX-License-Identifier: MIT
/// Records written front to back and read anywhere: in memory as long as the budget lasts, in
/// temporary files beyond that.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "ooc/context.h"

namespace hewer::ooc {

/// A sequence of records of one size, in pages of Context::page_bytes(). Where the pages are, in
/// memory or on disk, is nobody's business but the budget's: a reservation that does not fit makes
/// spools move pages to disk (the last pages of the largest spool first, since everything here is
/// read front to back). Pages on disk carry checksums.
///
/// Thread-safety: append() by one thread at a time, read() by any number, also during append() (of
/// records that are there already). Throws: OutOfDiskBudget if temporary space is used up, IoError
/// if a page does not come back as it was written, OutOfMemoryBudget if not even one page fits.
class RawSpool {
  public:
    RawSpool(Context& context, std::string what, std::size_t record_bytes);
    ~RawSpool();
    RawSpool(const RawSpool&) = delete;
    RawSpool& operator=(const RawSpool&) = delete;

    void append(const void* records, std::uint64_t n);
    /// After the last append(): what is in memory for the next one is given back. For those who
    /// hold many spools at once.
    void seal();
    void read(std::uint64_t first, std::uint64_t n, void* out) const;
    /// Gives back the pages that hold only records before `record`: they will not be read again.
    void discard_before(std::uint64_t record);
    [[nodiscard]] std::uint64_t size() const;
    /// Of the temporary file; -1 while there is none. For tests that damage it.
    [[nodiscard]] int spill_descriptor() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

template <typename T>
class Spool {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    using Record = T;

    Spool() = default;
    /// `what` names the records in messages.
    Spool(Context& context, std::string what)
        : raw_(std::make_unique<RawSpool>(context, std::move(what), sizeof(T))) {}

    void append(std::span<const T> records) { raw_->append(records.data(), records.size()); }
    void push(const T& record) { raw_->append(&record, 1); }
    void seal() { raw_->seal(); }
    /// Precondition: the range lies within size().
    void read(std::uint64_t first, std::span<T> out) const {
        if (!out.empty()) raw_->read(first, out.size(), out.data());
    }
    [[nodiscard]] T at(std::uint64_t i) const {
        T record;
        raw_->read(i, 1, &record);
        return record;
    }
    void discard_before(std::uint64_t record) { raw_->discard_before(record); }
    [[nodiscard]] std::uint64_t size() const { return raw_ ? raw_->size() : 0; }
    [[nodiscard]] bool empty() const { return size() == 0; }
    void release() { raw_.reset(); }
    [[nodiscard]] int spill_descriptor() const { return raw_->spill_descriptor(); }

  private:
    std::unique_ptr<RawSpool> raw_;
};

/// Reads a spool, or a part of it, front to back through a buffer of its own. One thread.
template <typename T>
class SpoolReader {
  public:
    static constexpr std::uint64_t kBufferBytes = 64 << 10;

    explicit SpoolReader(const Spool<T>& spool) : SpoolReader(spool, 0, spool.size()) {}
    SpoolReader(const Spool<T>& spool, std::uint64_t first, std::uint64_t last,
                std::uint64_t buffer_bytes = kBufferBytes)
        : spool_(&spool),
          at_(first),
          last_(last),
          own_(std::min(last - first, std::max<std::uint64_t>(1, buffer_bytes / sizeof(T)))),
          buffer_(own_) {}
    /// Through a buffer of the caller's.
    SpoolReader(const Spool<T>& spool, std::span<T> buffer)
        : spool_(&spool), at_(0), last_(spool.size()), buffer_(buffer) {}
    SpoolReader(const SpoolReader&) = delete;
    SpoolReader& operator=(const SpoolReader&) = delete;
    SpoolReader(SpoolReader&&) noexcept = default;
    SpoolReader& operator=(SpoolReader&&) noexcept = default;
    ~SpoolReader() = default;

    /// The next record, or null at the end. Valid until the next call.
    const T* next() {
        if (used_ == filled_ && !fill()) return nullptr;
        return &buffer_[used_++];
    }
    /// What the next call of next() would return, without taking it.
    const T* peek() {
        if (used_ == filled_ && !fill()) return nullptr;
        return &buffer_[used_];
    }
    /// As many of the next records as are at hand, at least one; empty at the end.
    std::span<const T> next_piece() {
        const std::span<const T> piece = peek_piece();
        skip(piece.size());
        return piece;
    }
    /// The same, without taking them.
    std::span<const T> peek_piece() {
        if (used_ == filled_ && !fill()) return {};
        return {buffer_.data() + used_, filled_ - used_};
    }
    /// Takes the first `n` of peek_piece().
    void skip(std::uint64_t n) { used_ += n; }

    /// Place of the record that next() will return.
    [[nodiscard]] std::uint64_t position() const { return at_ - (filled_ - used_); }

  private:
    bool fill() {
        if (at_ == last_) return false;
        // From a multiple of the buffer to the next: those are what is read from disk at once.
        const std::uint64_t n =
            std::min<std::uint64_t>(buffer_.size() - at_ % buffer_.size(), last_ - at_);
        spool_->read(at_, std::span<T>(buffer_.data(), n));
        at_ += n;
        filled_ = n;
        used_ = 0;
        return true;
    }

    const Spool<T>* spool_;
    std::uint64_t at_;
    std::uint64_t last_;
    std::vector<T> own_;
    std::span<T> buffer_;
    std::uint64_t filled_ = 0;
    std::uint64_t used_ = 0;
};

}  // namespace hewer::ooc

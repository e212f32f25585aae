// SPDX-License-Identifier: MIT
/// Sorting more records than memory holds: sorted runs on spools, then merges.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ooc/array.h"
#include "ooc/spool.h"

namespace hewer::ooc {

/// Sorted runs, read once as one sequence in order. What has been read gives its disk and memory
/// back. Memory: a read buffer for each run, reserved. One thread. Throws: as Spool does.
template <typename T, typename Less>
class RunMerge {
  public:
    RunMerge(Context& context, const std::string& what, std::vector<Spool<T>> runs, Less less)
        : less_(std::move(less)),
          buffers_(context.budget(), what, runs.size() * kBufferRecords),
          runs_(std::move(runs)) {
        readers_.reserve(runs_.size());
        for (const Spool<T>& run : runs_) {
            n_left_ += run.size();
            readers_.emplace_back(
                run,
                std::span<T>(buffers_.data() + readers_.size() * kBufferRecords, kBufferRecords));
        }
        for (std::size_t i = 0; i < readers_.size(); ++i) {
            if (readers_[i].peek() != nullptr) heap_.push_back(i);
        }
        for (std::size_t i = heap_.size() / 2; i-- > 0;) sift_down(i);
    }
    RunMerge(const RunMerge&) = delete;
    RunMerge& operator=(const RunMerge&) = delete;
    RunMerge(RunMerge&&) noexcept = default;
    RunMerge& operator=(RunMerge&&) noexcept = default;
    ~RunMerge() = default;

    /// The next record, or null at the end. Valid until the next call.
    const T* next() {
        settle();
        if (heap_.empty()) return nullptr;
        is_taken_ = true;
        --n_left_;
        return readers_[heap_.front()].next();
    }
    /// What the next call of next() would return, without taking it.
    const T* peek() {
        settle();
        return heap_.empty() ? nullptr : readers_[heap_.front()].peek();
    }
    /// Records that next() has still to return.
    [[nodiscard]] std::uint64_t n_left() const { return n_left_; }

  private:
    static constexpr std::uint64_t kBufferRecords =
        std::max<std::uint64_t>(1, SpoolReader<T>::kBufferBytes / sizeof(T));
    static constexpr std::uint64_t kRecordsBetween = 1 << 16;

    /// The run of the record that was taken finds its new place: not before the record has been
    /// looked at, which a refill of the reader would overwrite.
    void settle() {
        if (!is_taken_) return;
        is_taken_ = false;
        const std::size_t run = heap_.front();
        if (readers_[run].peek() == nullptr) {
            runs_[run].release();
            heap_.front() = heap_.back();
            heap_.pop_back();
        } else if (readers_[run].position() % kRecordsBetween == 0) {
            runs_[run].discard_before(readers_[run].position());
        }
        sift_down(0);
    }

    void sift_down(std::size_t at) {
        for (;;) {
            std::size_t first = 2 * at + 1;
            if (first >= heap_.size()) return;
            if (first + 1 < heap_.size() && is_before(first + 1, first)) ++first;
            if (!is_before(first, at)) return;
            std::swap(heap_[at], heap_[first]);
            at = first;
        }
    }
    bool is_before(std::size_t a, std::size_t b) {
        return less_(*readers_[heap_[a]].peek(), *readers_[heap_[b]].peek());
    }

    Less less_;
    Array<T> buffers_;  // not on the heap, which would keep them for the thread that has merged
    std::vector<Spool<T>> runs_;
    std::vector<SpoolReader<T>> readers_;
    std::vector<std::size_t> heap_;  // runs with records left, the lowest record first
    std::uint64_t n_left_ = 0;
    bool is_taken_ = false;
};

/// Collects records, then yields them in the order of `Less`, which must be a strict weak order
/// under which equivalent records are interchangeable (compare all that matters): then neither runs
/// nor threads show in the result. Memory: `buffer_bytes` while adding; while merging as much, but
/// kLeastFanIn read buffers at the least. Disk: every record once for each level of merging: two
/// levels reach from buffer_bytes² / 64 KiB on (4 GiB for 16 MiB). One thread.
template <typename T, typename Less>
class ExternalSorter {
  public:
    using Sorted = RunMerge<T, Less>;
    static constexpr std::size_t kLeastFanIn = 32;

    ExternalSorter(Context& context, std::string what, Less less, std::uint64_t buffer_bytes)
        : context_(&context),
          what_(std::move(what)),
          less_(std::move(less)),
          buffer_bytes_(buffer_bytes),
          bytes_(context.budget().reserve(what_, buffer_bytes)),
          capacity_(std::max<std::uint64_t>(1, buffer_bytes / sizeof(T))),
          fan_in_(std::max<std::size_t>(kLeastFanIn, buffer_bytes / SpoolReader<T>::kBufferBytes)) {
    }

    void add(std::span<const T> records) {
        for (const T& r : records) add(r);
    }
    void add(const T& record) {
        if (buffer_.size() == capacity_) flush();
        // Growing by doubling would have twice as much for a moment.
        if (buffer_.empty()) buffer_.reserve(capacity_);
        buffer_.push_back(record);
    }

    /// All records in order, to be read once: the last merge happens on the way. Ends the sorter's
    /// life.
    Sorted stream() { return {*context_, what_, last_runs(), less_}; }

    /// All records in order, to be read anywhere and often. Ends the sorter's life.
    Spool<T> finish() {
        std::vector<Spool<T>> runs = last_runs();
        return runs.size() == 1 ? std::move(runs.front()) : merged(std::move(runs));
    }

  private:
    /// No more than can be merged at once, and one at the least.
    std::vector<Spool<T>> last_runs() {
        std::vector<Spool<T>> runs;
        runs.push_back(take_run());
        release_buffer();
        for (auto& level : levels_) {
            for (Spool<T>& run : level) {
                if (runs.size() == fan_in_) runs = only(merged(std::move(runs)));
                runs.push_back(std::move(run));
            }
        }
        return runs;
    }
    void flush() {
        Spool<T> run = take_run();
        for (std::size_t level = 0;; ++level) {
            if (level == levels_.size()) levels_.emplace_back();
            levels_[level].push_back(std::move(run));
            if (levels_[level].size() < fan_in_) return;
            release_buffer();
            run = merged(std::exchange(levels_[level], {}));
            bytes_ = context_->budget().reserve(what_, buffer_bytes_);
        }
    }
    Spool<T> take_run() {
        std::sort(buffer_.begin(), buffer_.end(), less_);
        Spool<T> run(*context_, what_);
        run.append(buffer_);
        run.seal();
        buffer_.clear();
        return run;
    }
    void release_buffer() {
        buffer_ = std::vector<T>();  // of an empty list it would keep the memory
        bytes_.release();
    }
    Spool<T> merged(std::vector<Spool<T>> runs) {
        Spool<T> result(*context_, what_);
        Sorted merge(*context_, what_, std::move(runs), less_);
        while (const T* record = merge.next()) result.push(*record);
        result.seal();
        return result;
    }
    static std::vector<Spool<T>> only(Spool<T> run) {
        std::vector<Spool<T>> one;
        one.push_back(std::move(run));
        return one;
    }

    Context* context_;
    std::string what_;
    Less less_;
    std::uint64_t buffer_bytes_;
    Reservation bytes_;
    std::uint64_t capacity_;
    std::size_t fan_in_;
    std::vector<T> buffer_;
    std::vector<std::vector<Spool<T>>> levels_;
};

}  // namespace hewer::ooc

// SPDX-License-Identifier: MIT
/// Sorting more records than memory holds: sorted runs on spools, then merges.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ooc/spool.h"

namespace hewer::ooc {

/// Merges sorted runs into one, which it returns. Memory: a read buffer for each run, reserved.
template <typename T, typename Less>
Spool<T> merge_runs(Context& context, const std::string& what, std::vector<Spool<T>> runs,
                    const Less& less) {
    Spool<T> result(context, what);
    const Reservation bytes =
        context.budget().reserve(what, runs.size() * SpoolReader<T>::kBufferBytes);
    std::vector<SpoolReader<T>> readers;
    readers.reserve(runs.size());
    for (const Spool<T>& run : runs) readers.emplace_back(run);
    std::vector<std::size_t> heap;
    const auto later = [&](std::size_t a, std::size_t b) {
        return less(*readers[b].peek(), *readers[a].peek());
    };
    for (std::size_t i = 0; i < readers.size(); ++i) {
        if (readers[i].peek() != nullptr) heap.push_back(i);
    }
    std::make_heap(heap.begin(), heap.end(), later);
    while (!heap.empty()) {
        std::pop_heap(heap.begin(), heap.end(), later);
        SpoolReader<T>& reader = readers[heap.back()];
        result.push(*reader.next());
        if (reader.peek() == nullptr) {
            heap.pop_back();
        } else {
            std::push_heap(heap.begin(), heap.end(), later);
        }
    }
    return result;
}

/// Collects records, then yields them in the order of `Less`, which must be a strict weak order
/// under which equivalent records are interchangeable (compare all that matters): then neither runs
/// nor threads show in the result. Memory: `buffer_bytes` while adding, kFanIn read buffers while
/// merging. One thread.
template <typename T, typename Less>
class ExternalSorter {
  public:
    /// Most runs that are merged at once: then they count as one of the next higher level.
    static constexpr std::size_t kFanIn = 32;

    ExternalSorter(Context& context, std::string what, Less less, std::uint64_t buffer_bytes)
        : context_(&context),
          what_(std::move(what)),
          less_(std::move(less)),
          bytes_(context.budget().reserve(what_, buffer_bytes)),
          capacity_(std::max<std::uint64_t>(1, buffer_bytes / sizeof(T))) {}

    void add(std::span<const T> records) {
        for (const T& r : records) add(r);
    }
    void add(const T& record) {
        if (buffer_.size() == capacity_) flush();
        buffer_.push_back(record);
    }

    /// All records in order. Ends the sorter's life.
    Spool<T> finish() {
        std::sort(buffer_.begin(), buffer_.end(), less_);
        if (levels_.empty()) {
            Spool<T> result(*context_, what_);
            result.append(buffer_);
            release_buffer();
            return result;
        }
        if (!buffer_.empty()) flush();
        release_buffer();
        std::vector<Spool<T>> runs;
        for (auto& level : levels_) {
            for (Spool<T>& run : level) runs.push_back(std::move(run));
            if (runs.size() > kFanIn) runs = merged(std::move(runs));
        }
        if (runs.size() == 1) return std::move(runs.front());
        return merge_runs(*context_, what_, std::move(runs), less_);
    }

  private:
    void release_buffer() {
        buffer_ = {};
        bytes_.release();
    }
    std::vector<Spool<T>> merged(std::vector<Spool<T>> runs) {
        std::vector<Spool<T>> one;
        one.push_back(merge_runs(*context_, what_, std::move(runs), less_));
        return one;
    }
    void flush() {
        std::sort(buffer_.begin(), buffer_.end(), less_);
        Spool<T> run(*context_, what_);
        run.append(buffer_);
        buffer_.clear();
        for (std::size_t level = 0;; ++level) {
            if (level == levels_.size()) levels_.emplace_back();
            levels_[level].push_back(std::move(run));
            if (levels_[level].size() < kFanIn) return;
            run = merge_runs(*context_, what_, std::exchange(levels_[level], {}), less_);
        }
    }

    Context* context_;
    std::string what_;
    Less less_;
    Reservation bytes_;
    std::uint64_t capacity_;
    std::vector<T> buffer_;
    std::vector<std::vector<Spool<T>>> levels_;
};

}  // namespace hewer::ooc

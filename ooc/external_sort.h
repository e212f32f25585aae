// SPDX-License-Identifier: MIT
/// Sorting more records than memory holds: sorted runs on spools, then one merge.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ooc/spool.h"

namespace hewer::ooc {

/// Collects records, then yields them in the order of `Less`, which must be a strict weak order
/// under which equivalent records are interchangeable (compare all that matters): then neither runs
/// nor threads show in the result. Memory: `buffer_bytes` while adding, as much while merging.
/// add() and next() by one thread.
template <typename T, typename Less>
class ExternalSorter {
  public:
    ExternalSorter(Context& context, std::string what, Less less, std::uint64_t buffer_bytes)
        : context_(&context),
          what_(std::move(what)),
          less_(std::move(less)),
          capacity_(std::max<std::uint64_t>(1, buffer_bytes / sizeof(T))) {}

    void add(std::span<const T> records) {
        for (const T& r : records) add(r);
    }
    void add(const T& record) {
        if (buffer_.size() == capacity_) flush();
        buffer_.push_back(record);
    }

    /// All records in order, on a spool. Ends the sorter's life.
    Spool<T> finish() {
        Spool<T> result(*context_, what_);
        std::sort(buffer_.begin(), buffer_.end(), less_);
        if (runs_.empty()) {
            result.append(buffer_);
            buffer_ = {};
            return result;
        }
        if (!buffer_.empty()) flush();
        buffer_ = {};
        merge(result);
        return result;
    }

  private:
    void flush() {
        std::sort(buffer_.begin(), buffer_.end(), less_);
        runs_.emplace_back(*context_, what_);
        runs_.back().append(buffer_);
        buffer_.clear();
    }
    void merge(Spool<T>& result) {
        std::vector<SpoolReader<T>> readers;
        readers.reserve(runs_.size());
        for (const Spool<T>& run : runs_) readers.emplace_back(run);
        std::vector<std::size_t> heap;
        const auto later = [&](std::size_t a, std::size_t b) {
            return less_(*readers[b].peek(), *readers[a].peek());
        };
        for (std::size_t i = 0; i < readers.size(); ++i) heap.push_back(i);
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
    }

    Context* context_;
    std::string what_;
    Less less_;
    std::uint64_t capacity_;
    std::vector<T> buffer_;
    std::vector<Spool<T>> runs_;
};

}  // namespace hewer::ooc

// SPDX-License-Identifier: MIT
/// Loops on all threads of a run. oneTBB underneath.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <utility>

namespace hewer::ooc {

/// The threads of one run; nothing runs on more than n_threads of them at once, the caller's
/// included. An exception of any iteration ends the loop and is thrown to the caller.
class Workers {
  public:
    explicit Workers(unsigned n_threads)
        : n_threads_(n_threads), arena_(static_cast<int>(n_threads)) {}

    [[nodiscard]] unsigned n_threads() const { return n_threads_; }

    /// body(begin, end) over [0, n) in pieces of at most `grain`, in no particular order. Within
    /// the work of another loop it gives threads that have nothing left to do a part of that work;
    /// the caller takes up no other work while it waits for them, which would need memory.
    template <typename Body>
    void for_ranges(std::uint64_t n, std::uint64_t grain, const Body& body) {
        if (n == 0) return;
        if (n_threads_ == 1 || n <= grain) {
            for (std::uint64_t i = 0; i < n; i += grain) body(i, i + grain < n ? i + grain : n);
            return;
        }
        arena_.execute([&] {
            tbb::this_task_arena::isolate([&] {
                tbb::parallel_for(
                    tbb::blocked_range<std::uint64_t>(0, n, grain),
                    [&](const tbb::blocked_range<std::uint64_t>& r) { body(r.begin(), r.end()); },
                    tbb::simple_partitioner());
            });
        });
    }

    /// result = work(i) for i in [0, n) on all threads, at most `most_alive` results at once; then
    /// commit(i, result) one after the other, in order. Of several exceptions, the first in that
    /// order is thrown, after what comes before it is committed.
    template <typename Work, typename Commit>
    void in_order(std::uint64_t n, std::size_t most_alive, const Work& work, const Commit& commit) {
        if (n_threads_ == 1 || most_alive <= 1) {
            for (std::uint64_t i = 0; i < n; ++i) {
                auto result = work(i);
                commit(i, result);
            }
            return;
        }
        using Result = decltype(work(std::uint64_t{0}));
        struct Item {
            std::uint64_t i;
            std::unique_ptr<Result> result;
            std::exception_ptr error;
        };
        // No exception goes through the pipeline: it would leak the items that are under way.
        std::exception_ptr error;
        std::atomic<bool> has_failed{false};
        const auto make = [&](std::uint64_t i) {
            auto item = std::make_shared<Item>(Item{i, nullptr, nullptr});
            try {
                if (!has_failed) item->result = std::make_unique<Result>(work(i));
            } catch (...) {
                item->error = std::current_exception();
            }
            return item;
        };
        const auto take = [&](const std::shared_ptr<Item>& item) {
            if (has_failed) return;
            try {
                if (item->error) std::rethrow_exception(item->error);
                commit(item->i, *item->result);
            } catch (...) {
                error = std::current_exception();
                has_failed = true;
            }
        };
        std::uint64_t next = 0;
        const auto number = [&](tbb::flow_control& control) {
            if (next == n || has_failed) control.stop();
            return next++;
        };
        using tbb::filter_mode;
        arena_.execute([&] {
            tbb::parallel_pipeline(
                most_alive,
                tbb::make_filter<void, std::uint64_t>(filter_mode::serial_in_order, number) &
                    tbb::make_filter<std::uint64_t, std::shared_ptr<Item>>(filter_mode::parallel,
                                                                           make) &
                    tbb::make_filter<std::shared_ptr<Item>, void>(filter_mode::serial_in_order,
                                                                  take));
        });
        if (error) std::rethrow_exception(error);
    }

    /// body() on the caller's thread, with the threads of this run for the parallel algorithms of
    /// oneTBB that it calls.
    template <typename Body>
    void execute(const Body& body) {
        arena_.execute(body);
    }

    /// body(worker) once for each worker 0 .. n_threads-1, as far as possible at the same time: for
    /// consumers that pull their work from a shared source.
    template <typename Body>
    void on_each(const Body& body) {
        if (n_threads_ == 1) {
            body(0U);
            return;
        }
        arena_.execute([&] {
            tbb::parallel_for(
                tbb::blocked_range<unsigned>(0, n_threads_, 1),
                [&](const tbb::blocked_range<unsigned>& r) {
                    for (unsigned i = r.begin(); i != r.end(); ++i) body(i);
                },
                tbb::simple_partitioner());
        });
    }

  private:
    unsigned n_threads_;
    // Else no more than the machine has would work, whatever was asked for.
    tbb::global_control limit_{tbb::global_control::max_allowed_parallelism, n_threads_};
    tbb::task_arena arena_;
};

}  // namespace hewer::ooc

// SPDX-License-Identifier: MIT
#include "ooc/memory_budget.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "hewer/error.h"
#include "ooc/units.h"

namespace hewer::ooc {

Reservation& Reservation::operator=(Reservation&& other) noexcept {
    if (this != &other) {
        release();
        budget_ = std::exchange(other.budget_, nullptr);
        bytes_ = std::exchange(other.bytes_, 0);
    }
    return *this;
}

void Reservation::release() noexcept {
    if (budget_ != nullptr) budget_->give_back(bytes_);
    budget_ = nullptr;
    bytes_ = 0;
}

MemoryBudget::MemoryBudget(std::uint64_t limit, std::uint64_t fixed)
    : limit_(limit), used_(fixed), peak_(fixed) {
    if (fixed > limit) {
        throw OutOfMemoryBudget("memory limit " + format_bytes(limit) +
                                " is below what the program itself needs (" + format_bytes(fixed) +
                                "); raise --memory");
    }
}

std::optional<Reservation> MemoryBudget::try_reserve(std::uint64_t bytes) {
    std::uint64_t used = used_.load(std::memory_order_relaxed);
    do {
        if (bytes > limit_ - std::min(used, limit_)) return std::nullopt;
    } while (!used_.compare_exchange_weak(used, used + bytes, std::memory_order_relaxed));
    std::uint64_t peak = peak_.load(std::memory_order_relaxed);
    while (peak < used + bytes &&
           !peak_.compare_exchange_weak(peak, used + bytes, std::memory_order_relaxed)) {
    }
    return Reservation(this, bytes);
}

Reservation MemoryBudget::reserve(std::string_view what, std::uint64_t bytes) {
    do {
        if (auto reservation = try_reserve(bytes)) return std::move(*reservation);
    } while (bytes <= limit_ && reclaim_ && reclaim_(bytes));
    const std::uint64_t in_use = used();
    const bool overflows = bytes > std::numeric_limits<std::uint64_t>::max() - in_use;
    throw OutOfMemoryBudget(
        "memory limit reached: " + std::string(what) + " needs " + format_bytes(bytes) + ", " +
        format_bytes(in_use) + " of " + format_bytes(limit_) + " are in use; raise --memory" +
        (overflows ? std::string() : " to more than " + format_bytes(in_use + bytes)));
}

std::uint64_t MemoryBudget::available() const {
    const std::uint64_t u = used();
    return u < limit_ ? limit_ - u : 0;
}

void MemoryBudget::give_back(std::uint64_t bytes) noexcept {
    used_.fetch_sub(bytes, std::memory_order_relaxed);
}

namespace {

// A limit file holds a number of bytes, or "max" (v2), or a number near 2^63 (v1) for none.
std::uint64_t read_limit(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::uint64_t value = 0;
    if (!(in >> value) || value >= (1ULL << 62)) return std::numeric_limits<std::uint64_t>::max();
    return value;
}

}  // namespace

std::uint64_t default_memory_limit() {
    const auto pages = static_cast<std::uint64_t>(std::max(0L, ::sysconf(_SC_PHYS_PAGES)));
    const auto page_bytes = static_cast<std::uint64_t>(std::max(0L, ::sysconf(_SC_PAGESIZE)));
    std::uint64_t group = std::numeric_limits<std::uint64_t>::max();
    // Lines "4:memory:/a/b" (v1) and "0::/a/b" (v2). A limit of any ancestor holds as well.
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        std::istringstream fields(line);
        std::string id;
        std::string controllers;
        std::string path;
        std::getline(fields, id, ':');
        std::getline(fields, controllers, ':');
        std::getline(fields, path);
        const bool v2 = controllers.empty();
        const bool v1 = ("," + controllers + ",").find(",memory,") != std::string::npos;
        if (!v1 && !v2) continue;
        const std::filesystem::path root = v2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
        const char* file = v2 ? "memory.max" : "memory.limit_in_bytes";
        std::filesystem::path rest = std::filesystem::path(path).relative_path();
        for (;;) {
            group = std::min(group, read_limit(root / rest / file));
            if (rest.empty()) break;
            rest = rest.parent_path();
        }
    }
    const std::uint64_t machine = pages * page_bytes;
    return group <= machine ? group : machine / 2;
}

}  // namespace hewer::ooc

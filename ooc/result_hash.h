// SPDX-License-Identifier: MIT
/// One number for a whole result: equal for equal vertices and triangles in equal order.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>

#include "hewer/types.h"

namespace hewer::ooc {

/// FNV-1a, in 64-bit words.
class ResultHash {
  public:
    void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3ULL; }
    void add(const Vec3& p) {
        for (const double x : p) add(std::bit_cast<std::uint64_t>(x));
    }
    void add(const Triangle& t) {
        for (const std::uint64_t v : t) add(v);
    }
    [[nodiscard]] std::string hex() const {
        std::array<char, 17> text{};
        std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value_));
        return text.data();
    }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace hewer::ooc

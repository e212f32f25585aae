// SPDX-License-Identifier: MIT
/// --memory and --threads, which most commands have.
#pragma once

#include <cstdint>

#include "app/arguments.h"
#include "hewer/allocator.h"

namespace hewer::app {

/// Sets both in `options`, and the allocator to what they allow.
template <typename Options>
void take_resources(const Arguments& arguments, Options& options) {
    options.memory_bytes = arguments.get<std::uint64_t>("memory");
    options.n_threads = static_cast<unsigned>(arguments.get<std::uint64_t>("threads"));
    tune_allocator(options.memory_bytes, options.n_threads);
}

}  // namespace hewer::app

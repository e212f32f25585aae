// SPDX-License-Identifier: MIT
/// Vertex colours of text formats.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "ooc/spool.h"
#include "streaming/mesh_import.h"

namespace hewer::streaming {

/// Red, green, blue, alpha as they stand in a file; a negative red: no colour; a negative alpha:
/// none.
using TextColor = std::array<float, 4>;
constexpr TextColor kNoTextColor{-1, -1, -1, -1};

/// Of three numbers, or four with alpha.
TextColor make_text_color(std::span<const double> numbers);

/// Collects the colours of an import. Writers use 0..1 or 0..255 without saying so; one number of 2
/// or more in the file means the latter. What was taken for 0..1 until then is scaled at the end.
class TextColors {
  public:
    explicit TextColors(MeshImport& import)
        : import_(import), colors_(import.context(), "imported colours") {}

    /// Of `n_vertices` more vertices; `colors` may end earlier, the others have none.
    void add(std::span<const TextColor> colors, std::uint64_t n_vertices);
    /// Hands them over, if there are any. Once.
    void finish();

  private:
    void append_missing(std::uint64_t n);

    MeshImport& import_;
    ooc::Spool<Rgba16> colors_;
    std::uint64_t n_missing_ = 0;    // vertices without colour since the last one that has one
    std::uint64_t n_as_floats_ = 0;  // of the first colours, taken for 0..1
    bool has_bytes_ = false;
    bool has_missing_ = false;
    bool has_alpha_ = false;
};

}  // namespace hewer::streaming

// SPDX-License-Identifier: MIT
/// The mean colour of a texture over parts of a triangle.
#pragma once

#include <array>
#include <cstdint>

#include "streaming/texture.h"

namespace hewer::streaming {

/// u and v, in images; v downwards (as in glTF).
using TexCoord = std::array<double, 2>;

/// What lies outside of the image.
enum class Wrap : std::uint8_t { Repeat, Mirror, Clamp };

/// Red, green, blue, 0..1.
using MeanColor = std::array<float, 3>;

/// For each corner the mean over the third of the triangle that is nearest to it (in barycentric
/// coordinates).
///
/// The triangle is cut into m x m equal ones, none of which has an edge longer than the diagonal of
/// a texel, and the texture is read, bilinearly, at their centres: one or two samples a texel. From
/// m = 16 on a coarser level of the pyramid is read instead. So the work is at most 256 samples a
/// triangle, and what lies beside the triangle in the image comes in from half a texel away, or
/// from a 22nd of the longest edge. Means are those of the image's own numbers (sRGB), as
/// everywhere in hewer: that keeps the error small that a viewer sees, and the mean of means is the
/// mean.
class TextureFilter {
  public:
    explicit TextureFilter(TexelCache& texels) : texels_(texels) {}

    /// Precondition: finite coordinates.
    std::array<MeanColor, 3> corner_means(const Texture& texture,
                                          const std::array<TexCoord, 3>& triangle,
                                          std::array<Wrap, 2> wrap);

  private:
    TexelCache& texels_;
};

}  // namespace hewer::streaming

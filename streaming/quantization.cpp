// SPDX-License-Identifier: MIT
#include "streaming/quantization.h"

#include <algorithm>
#include <cmath>

namespace hewer::streaming {

namespace {

// Of the error: the rounding then adds half a per cent of its square to its square.
constexpr double kShareOfError = 0.1;

double longest_side(const Bounds& bounds) {
    const Vec3 size = bounds.size();
    return std::max({size[0], size[1], size[2]});
}

}  // namespace

double wanted_step(const Quantization& wanted, const SinkHeader& header) {
    switch (wanted.kind) {
        case Quantization::Kind::None:
            break;
        case Quantization::Kind::Auto:
            return kShareOfError * header.error;
        case Quantization::Kind::Bits:
            return step_of(static_cast<unsigned>(wanted.value), header.bounds);
        case Quantization::Kind::Step:
            return wanted.value;
    }
    return 0;
}

unsigned bits_for(double step, const Bounds& bounds) {
    const double points = longest_side(bounds) / step + 1;
    if (!(points > 2)) return 1;
    // A hair less, so that step_of() leads back.
    const double bits = std::ceil(std::log2(points) - 1e-9);
    return bits >= kMostDracoBits ? kMostDracoBits : static_cast<unsigned>(bits);
}

double step_of(unsigned bits, const Bounds& bounds) {
    return longest_side(bounds) / (std::ldexp(1.0, static_cast<int>(bits)) - 1);
}

}  // namespace hewer::streaming

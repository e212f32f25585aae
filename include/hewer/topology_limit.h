// SPDX-License-Identifier: MIT
/// The error of a run that is to keep the topology of its input.
#pragma once

#include <cstdint>
#include <string>

#include "hewer/error.h"

namespace hewer {

/// A target that cannot be met if the topology is to stay (Topology::Keep). The message names the
/// least that can; nothing is written.
class TopologyLimit : public InvalidArgument {
  public:
    TopologyLimit(const std::string& message, std::uint64_t least_triangles)
        : InvalidArgument(message), least_triangles_(least_triangles) {}
    /// That the edge collapse got down to.
    [[nodiscard]] std::uint64_t least_triangles() const { return least_triangles_; }

  private:
    std::uint64_t least_triangles_;
};

}  // namespace hewer

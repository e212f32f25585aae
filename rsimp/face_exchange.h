// SPDX-License-Identifier: MIT
/// Faces of a mesh of any size, exchanged for others.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/context.h"
#include "ooc/external_sort.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// Takes exchanges in any order, then carries them out in one pass over the faces, which stay
/// sorted. Memory: a sort buffer.
class FaceExchange {
  public:
    explicit FaceExchange(ooc::Context& context);

    /// `before` is a face of the mesh, up to the corner that it begins with.
    void add(const Face& before, const Face& after);

    /// Ends its life. False if there was nothing to do.
    bool carry_out(MeshStore& mesh);

  private:
    struct Item {
        Face face;
        std::uint64_t is_new;
    };
    struct Less {
        bool operator()(const Item& a, const Item& b) const {
            return a.face != b.face ? a.face < b.face : a.is_new < b.is_new;
        }
    };

    ooc::Context& context_;
    ooc::ExternalSorter<Item, Less> items_;
    std::uint64_t n_ = 0;
};

}  // namespace hewer::rsimp

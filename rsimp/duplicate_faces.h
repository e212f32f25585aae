// SPDX-License-Identifier: MIT
/// Faces that merging has laid onto each other.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "rsimp/block_mesh.h"

namespace hewer::rsimp {

/// A face, smallest corner first, without its winding.
template <typename AnyFace>
AnyFace unwound(const AnyFace& t) {
    return {t[0], std::min(t[1], t[2]), std::max(t[1], t[2])};
}

/// Order in which copies of a face and of its opposite come together.
struct ByUnwound {
    template <typename AnyFace>
    bool operator()(const AnyFace& a, const AnyFace& b) const {
        const AnyFace ua = unwound(a);
        const AnyFace ub = unwound(b);
        return ua != ub ? ua < ub : a[1] < b[1];
    }
};

/// Merging vertices of a surface folds parts of it onto each other. As integer chains (each face
/// with its winding as sign) the boundary of a closed surface stays zero under merging, so copies
/// of a face cancel against its opposites; this opens nothing. As many of each: one pair stays, as
/// a sheet folded onto itself, so that thin parts do not vanish. Equally wound copies that are left
/// over all stay if `keeps_copies` (each is part of some sheet, which would have a hole without
/// it), else only one: the rest is dirt.
///
/// Takes faces in the order ByUnwound, smallest corner first, and hands those that stay to `emit`.
template <typename AnyFace, typename Emit>
class DuplicateSettler {
  public:
    DuplicateSettler(bool keeps_copies, Emit emit)
        : keeps_copies_(keeps_copies), emit_(std::move(emit)) {}

    void add(const AnyFace& face) {
        const AnyFace key = unwound(face);
        if (n_ > 0 && key != key_) finish();
        key_ = key;
        sum_ += face[1] < face[2] ? 1 : -1;
        ++n_;
    }
    /// After the last face.
    void finish() {
        if (n_ == 0) return;
        const AnyFace opposite{key_[0], key_[2], key_[1]};
        if (sum_ == 0) {
            emit_(key_);
            emit_(opposite);
        } else {
            if (std::abs(sum_) > 1) ++n_copied_;
            for (int copies = keeps_copies_ ? std::abs(sum_) : 1; copies > 0; --copies) {
                emit_(sum_ > 0 ? key_ : opposite);
            }
        }
        ++n_distinct_;
        n_ = 0;
        sum_ = 0;
    }
    /// After finish(): so many faces are copies that they were in the input.
    [[nodiscard]] bool is_full_of_copies() const {
        return n_copied_ > kMostCopied * n_distinct_ / 100;
    }

  private:
    // Per cent. Folding lays two sheets of a terrain with trees onto each other in 1 % of the
    // faces.
    static constexpr std::uint64_t kMostCopied = 5;

    bool keeps_copies_;
    Emit emit_;
    AnyFace key_{};
    int sum_ = 0;
    std::uint64_t n_ = 0;
    std::uint64_t n_distinct_ = 0;
    std::uint64_t n_copied_ = 0;  // of these, with equally wound copies that are left over
};

/// Whether equally wound copies are to stay: in a closed surface, and where they are few. `visit`
/// calls its argument for each face in the order ByUnwound.
template <typename AnyFace, typename Visit>
bool keeps_copies(bool is_closed, const Visit& visit) {
    if (is_closed) return true;
    const auto ignore = [](const AnyFace&) {};
    DuplicateSettler<AnyFace, decltype(ignore)> settler(true, ignore);
    visit([&](const AnyFace& face) { settler.add(face); });
    settler.finish();
    return !settler.is_full_of_copies();
}

/// Settles the faces of a block. Drops degenerate ones. The result is in the order ByUnwound,
/// whatever the order before. Returns how many of the non-degenerate faces went. O(n log n).
std::uint64_t settle_duplicates(std::vector<LocalFace>& faces, bool is_closed);

}  // namespace hewer::rsimp

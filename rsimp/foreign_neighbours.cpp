// SPDX-License-Identifier: MIT
#include "rsimp/foreign_neighbours.h"

#include <algorithm>
#include <flann/flann.hpp>

namespace hewer::rsimp {

namespace {

constexpr std::size_t kFirstAsked = 8;
constexpr std::size_t kMoreAsked = 4;
constexpr int kLeafPoints = 16;
// Of further parts: so many times the distance of the nearest.
constexpr double kFarther = 2;

}  // namespace

/// FLANN's matrices are views of memory that may be written, though it only reads.
class ForeignNeighbours::Tree {
  public:
    explicit Tree(const std::vector<Vec3>& points)
        : coordinates_(3 * points.size()),
          index_(flann::Matrix<double>(coordinates_.data(), points.size(), 3),
                 flann::KDTreeSingleIndexParams(kLeafPoints)) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            std::copy(points[i].begin(), points[i].end(),
                      coordinates_.begin() + static_cast<std::ptrdiff_t>(3 * i));
        }
        index_.buildIndex(flann::Matrix<double>(coordinates_.data(), points.size(), 3));
    }
    void search(const Vec3& at, std::size_t n, std::vector<std::size_t>& found,
                std::vector<double>& distances) {
        Vec3 query = at;
        found.resize(n);
        distances.resize(n);
        flann::Matrix<std::size_t> indices(found.data(), 1, n);
        flann::Matrix<double> squared(distances.data(), 1, n);
        flann::SearchParams params(flann::FLANN_CHECKS_UNLIMITED);
        params.cores = 1;
        index_.knnSearch(flann::Matrix<double>(query.data(), 1, 3), indices, squared, n, params);
    }

  private:
    std::vector<double> coordinates_;
    flann::KDTreeSingleIndex<flann::L2_3D<double>> index_;
};

ForeignNeighbours::ForeignNeighbours(const std::vector<Vec3>& points,
                                     const std::vector<std::uint32_t>& parts)
    : points_(points), parts_(parts), tree_(std::make_unique<Tree>(points)) {}

ForeignNeighbours::~ForeignNeighbours() = default;

void ForeignNeighbours::nearest(std::uint32_t point, double reach,
                                std::vector<std::uint32_t>& neighbours) {
    for (std::size_t n = kFirstAsked;; n *= kMoreAsked) {
        n = std::min(n, points_.size());
        tree_->search(points_[point], n, found_, distances_);
        neighbours.clear();
        double most = reach * reach;
        for (std::size_t i = 0; i < n; ++i) {
            if (distances_[i] > most) return;
            const auto other = static_cast<std::uint32_t>(found_[i]);
            const auto is_same_part = [&](std::uint32_t p) { return parts_[p] == parts_[other]; };
            if (is_same_part(point) ||
                std::any_of(neighbours.begin(), neighbours.end(), is_same_part)) {
                continue;
            }
            if (neighbours.empty()) most = std::min(most, kFarther * kFarther * distances_[i]);
            neighbours.push_back(other);
        }
        if (n == points_.size()) return;
    }
}

}  // namespace hewer::rsimp

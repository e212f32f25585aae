// SPDX-License-Identifier: MIT
#include "rsimp/point_tree.h"

#include <algorithm>
#include <flann/flann.hpp>

namespace hewer::rsimp {

namespace {

constexpr int kLeafPoints = 16;

}  // namespace

/// FLANN's matrices are views of memory that may be written, though it only reads.
class PointTree::Index {
  public:
    explicit Index(const std::vector<Vec3>& points)
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
                std::vector<double>& squared) {
        Vec3 query = at;
        found.resize(n);
        squared.resize(n);
        flann::Matrix<std::size_t> indices(found.data(), 1, n);
        flann::Matrix<double> distances(squared.data(), 1, n);
        flann::SearchParams params(flann::FLANN_CHECKS_UNLIMITED);
        params.cores = 1;
        index_.knnSearch(flann::Matrix<double>(query.data(), 1, 3), indices, distances, n, params);
    }

  private:
    std::vector<double> coordinates_;
    flann::KDTreeSingleIndex<flann::L2_3D<double>> index_;
};

PointTree::PointTree(const std::vector<Vec3>& points) : index_(std::make_unique<Index>(points)) {}

PointTree::~PointTree() = default;

void PointTree::nearest(const Vec3& at, std::size_t n, std::vector<std::size_t>& found,
                        std::vector<double>& squared) {
    index_->search(at, n, found, squared);
}

}  // namespace hewer::rsimp

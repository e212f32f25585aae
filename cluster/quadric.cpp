// SPDX-License-Identifier: MIT
#include "cluster/quadric.h"

#include <cmath>
#include <utility>

namespace hewer::cluster {

Eigen3 eigen_decomposition(const Symmetric3& m) {
    double a[3][3] = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static constexpr int kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    constexpr int kMaxSweeps = 12;  // converges quadratically; four are usual
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
        const double off = std::fabs(a[0][1]) + std::fabs(a[0][2]) + std::fabs(a[1][2]);
        const double diagonal = std::fabs(a[0][0]) + std::fabs(a[1][1]) + std::fabs(a[2][2]);
        if (off <= 1e-14 * diagonal) break;
        for (const auto& pair : kPairs) {
            const int p = pair[0];
            const int q = pair[1];
            if (a[p][q] == 0) continue;
            const double apq = a[p][q];
            const double difference = a[q][q] - a[p][p];
            const double t =
                (difference >= 0 ? 2 : -2) * apq /
                (std::fabs(difference) + std::sqrt(difference * difference + 4 * apq * apq));
            const double c = 1 / std::sqrt(t * t + 1);
            const double s = t * c;
            a[p][p] -= t * apq;
            a[q][q] += t * apq;
            a[p][q] = a[q][p] = 0;
            const int r = 3 - p - q;
            const double arp = a[r][p];
            const double arq = a[r][q];
            a[r][p] = a[p][r] = c * arp - s * arq;
            a[r][q] = a[q][r] = s * arp + c * arq;
            for (auto& row : v) {
                const double vp = row[p];
                const double vq = row[q];
                row[p] = c * vp - s * vq;
                row[q] = s * vp + c * vq;
            }
        }
    }
    std::array<int, 3> order{0, 1, 2};
    const auto larger_first = [&](std::size_t i, std::size_t j) {
        if (a[order[j]][order[j]] > a[order[i]][order[i]]) std::swap(order[i], order[j]);
    };
    larger_first(0, 1);
    larger_first(1, 2);
    larger_first(0, 1);
    Eigen3 e;
    for (std::size_t i = 0; i < 3; ++i) {
        const int k = order[i];
        e.values[i] = a[k][k];
        e.vectors[i] = {v[0][k], v[1][k], v[2][k]};
    }
    return e;
}

Vec3 minimum_from(const Quadric& q, const Eigen3& eigen, const Vec3& mean) {
    const Vec3 gradient = q.a * mean + q.b;
    Vec3 x = mean;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(eigen.values[i] > kSingular * eigen.values[0])) continue;
        const double step = -dot(eigen.vectors[i], gradient) / eigen.values[i];
        x = x + step * eigen.vectors[i];
    }
    return x;
}

}  // namespace hewer::cluster

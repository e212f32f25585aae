// SPDX-License-Identifier: MIT
#include "rsimp/sample_runs.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ooc/vec3.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint64_t kSamplesPerRun = 1024;
constexpr std::uint64_t kEnoughPerVertex = 24;

}  // namespace

SampleRuns::SampleRuns(ooc::Context& context, const ooc::Spool<FitSample>& samples,
                       const Vec3& origin, std::uint64_t n_vertices)
    : samples_(samples),
      origin_(origin),
      boxes_(context.budget(), "boxes of samples",
             (samples.size() + kSamplesPerRun - 1) / kSamplesPerRun) {
    std::vector<FitSample> run(kSamplesPerRun);
    double area = 0;
    for (std::uint64_t r = 0; r < boxes_.size(); ++r) {
        const std::uint64_t first = r * kSamplesPerRun;
        const std::span<FitSample> read(run.data(),
                                        std::min(kSamplesPerRun, samples_.size() - first));
        samples_.read(first, read);
        FloatBox box;
        for (const FitSample& sample : read) {
            box.extend(sample.position() - origin_);
            area += static_cast<double>(sample.area());
        }
        boxes_.set(r, box);
        context.check_stop();
    }
    boxes_.finish();
    const std::uint64_t n = std::max<std::uint64_t>(1, n_vertices);
    const std::uint64_t enough = kEnoughPerVertex * n;
    spacing_ = std::sqrt(area / static_cast<double>(n));
    stride_ = std::max<std::uint64_t>(1, (samples_.size() + enough / 2) / enough);
}

std::uint64_t SampleRuns::points_at_most(const FloatBox& box, double reach) const {
    std::uint64_t n_runs = 0;
    boxes_.for_each_near(box, reach, [&](std::uint64_t) { ++n_runs; });
    return n_runs * (kSamplesPerRun / stride_ + 1);
}

void SampleRuns::for_each(const FloatBox& box, double reach, const Vec3& centre,
                          const std::function<void(std::span<const WeightedPoint>)>& visit,
                          std::uint64_t share) const {
    const std::uint64_t stride = share * stride_;
    Vec3 low;
    Vec3 high;
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] = static_cast<double>(box.low[k]) - reach;
        high[k] = static_cast<double>(box.high[k]) + reach;
    }
    const auto is_near = [&](const Vec3& p) {
        bool is_inside = true;
        for (std::size_t k = 0; k < 3; ++k) is_inside &= p[k] >= low[k] && p[k] <= high[k];
        return is_inside;
    };
    std::vector<FitSample> samples;
    std::vector<WeightedPoint> points;
    points.reserve(kMostPoints);
    boxes_.for_each_near(box, reach, [&](std::uint64_t run) {
        const std::uint64_t first = run * kSamplesPerRun;
        samples.resize(std::min(kSamplesPerRun, samples_.size() - first));
        samples_.read(first, samples);
        if (points.size() + kSamplesPerRun > kMostPoints) {
            visit(points);
            points.clear();
        }
        for (std::uint64_t i = (stride - first % stride) % stride; i < samples.size();
             i += stride) {
            const Vec3 p = samples[i].position() - origin_;
            if (!is_near(p)) continue;
            points.push_back(
                {to_single(p - centre), samples[i].area(), to_single(samples[i].normal())});
        }
    });
    if (!points.empty()) visit(points);
}

}  // namespace hewer::rsimp

// SPDX-License-Identifier: MIT
#include "measure/original_pass.h"

#include <algorithm>
#include <atomic>
#include <span>
#include <utility>
#include <vector>

#include "measure/points.h"
#include "measure/resident_surface.h"
#include "ooc/external_sort.h"
#include "ooc/parallel.h"
#include "streaming/dereference.h"

namespace hewer::measuring {

namespace {

constexpr std::uint64_t kPiece = 4096;  // corners of a soup

void raise_to(float& greatest, float value) {
    const std::atomic_ref<float> ref(greatest);
    float now = ref.load(std::memory_order_relaxed);
    while (value > now && !ref.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
    }
}

}  // namespace

std::uint64_t OriginalPass::bytes(unsigned n_threads) {
    return TriangleIndex::bytes(kFarPoints + n_threads);
}

OriginalPass::OriginalPass(ooc::Context& context, const Input& input, Direction& forward,
                           WaitingPoints& waiting, ooc::Array<float>& greatest)
    : context_(context), input_(input), forward_(forward), waiting_(waiting), greatest_(greatest) {}

double OriginalPass::measure(Probe& probe, const Vec3& q) {
    const TriangleIndex::Nearest nearest = probe.walk.nearest(q);
    if (!greatest_.empty()) {
        raise_to(greatest_[nearest.triangle], static_cast<float>(nearest.squared_distance));
    }
    return nearest.squared_distance;
}

void OriginalPass::measure_vertex(unsigned worker, Probe& probe, const LatticePoint& p) {
    waiting_.note(p);
    const Vec3 q = to_double(p);
    forward_.add_vertex(worker, q, measure(probe, q));
    if (probe.n_seen++ % far_stride_ == 0) {
        const std::lock_guard lock(mutex_);
        if (n_far_ < far_.size()) far_[n_far_++] = {p, p, p};
    }
}

void OriginalPass::measure_vertices() {
    const bool is_indexed = input_.source.info().is_indexed;
    const std::uint64_t n = is_indexed ? input_.census.n_vertices : 3 * input_.census.n_triangles;
    // One for each worker besides: its first.
    far_ = {context_.budget(), "limits far from the surface",
            std::min(n, kFarPoints) + context_.n_threads()};
    far_stride_ = n / kFarPoints + 1;
    if (is_indexed) {
        measure_indexed_vertices();
    } else {
        measure_soup_corners();
    }
    waiting_.settle(context_, std::move(far_), n_far_);
}

void OriginalPass::measure_indexed_vertices() {
    const LatticeEncoder encoder{input_.lattice};
    std::vector<Probe> probes(context_.n_threads(), {TriangleIndex::Walk(input_.to)});
    for_vertex_batches(context_, input_.source, [&](unsigned worker, const VertexBatch& batch) {
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
            if (!input_.census.used.get(batch.first + i)) continue;
            measure_vertex(worker, probes[worker], encoder.encode(batch.positions[i]));
        }
    });
}

void OriginalPass::measure_soup_corners() {
    const LatticeEncoder encoder{input_.lattice};
    ooc::ExternalSorter<LatticePoint, MortonLess> sorter(context_, "corners", MortonLess(),
                                                         input_.window_bytes);
    input_.source.begin_triangles();
    TriangleBatch batch;
    while (input_.source.next_triangles(batch)) {
        for (const auto& t : batch.points) {
            for (const Vec3& p : t) sorter.add(encoder.encode(p));
        }
        context_.advance(batch.n_faces);
    }
    const ooc::Spool<LatticePoint> corners = sorter.finish();
    const std::uint64_t n_pieces = (corners.size() + kPiece - 1) / kPiece;
    std::atomic<std::uint64_t> next{0};
    context_.workers().on_each([&](unsigned worker) {
        Probe probe{TriangleIndex::Walk(input_.to)};
        std::vector<LatticePoint> points;
        for (std::uint64_t piece = next++; piece < n_pieces; piece = next++) {
            // With the last of the piece before, which the first may be equal to.
            const std::uint64_t begin = piece * kPiece - (piece == 0 ? 0 : 1);
            const std::uint64_t end = std::min(corners.size(), (piece + 1) * kPiece);
            points.resize(end - begin);
            corners.read(begin, points);
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (i == 0 ? piece != 0 : points[i] == points[i - 1]) continue;
                measure_vertex(worker, probe, points[i]);
            }
            context_.check_stop();
        }
    });
}

void OriginalPass::measure_triangles() {
    std::vector<Probe> probes(context_.n_threads(), {TriangleIndex::Walk(input_.to)});
    streaming::Dereference<LatticeEncoder> triangles(context_, input_.source, {input_.lattice},
                                                     input_.window_bytes, input_.census.coherence);
    triangles.for_batches(
        [] {},
        [&](unsigned worker, std::span<const LatticeTriangle> batch, std::span<const Triangle>) {
            Probe& probe = probes[worker];
            for (const LatticeTriangle& t : batch) {
                input_.sampler.for_samples(
                    t, [&](const Vec3& q) { forward_.add_sample(worker, q, measure(probe, q)); });
            }
            waiting_.meet(batch);
        });
}

}  // namespace hewer::measuring

// SPDX-License-Identifier: MIT
#include "hewer/generate.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"

namespace hewer {
namespace {

namespace fs = std::filesystem;

using Point = std::array<float, 3>;
using Rgb = std::array<std::uint8_t, 3>;
using Ids = std::array<std::uint32_t, 3>;

struct Scan {
    std::vector<Point> points;
    std::vector<Rgb> colors;
    std::vector<Ids> triangles;
};

std::string read_bytes(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Reads just what generate() promises to write; anything else fails the test.
Scan parse(const std::string& bytes) {
    const std::string end = "end_header\n";
    const std::size_t at = bytes.find(end);
    EXPECT_NE(at, std::string::npos);
    std::istringstream header(bytes.substr(0, at));
    std::size_t n_vertices = 0;
    std::size_t n_faces = 0;
    std::string properties;
    for (std::string line; std::getline(header, line);) {
        std::sscanf(line.c_str(), "element vertex %zu", &n_vertices);
        std::sscanf(line.c_str(), "element face %zu", &n_faces);
        if (line.rfind("property", 0) == 0) properties += line.substr(9) + ";";
        if (line.rfind("format", 0) == 0) {
            EXPECT_EQ(line, "format binary_little_endian 1.0");
        }
    }
    const bool color = properties.find("uchar red;uchar green;uchar blue;") != std::string::npos;
    EXPECT_EQ(properties, std::string("float x;float y;float z;") +
                              (color ? "uchar red;uchar green;uchar blue;" : "") +
                              "list uchar int vertex_indices;");
    const std::size_t record = color ? 15 : 12;
    EXPECT_EQ(bytes.size(), at + end.size() + n_vertices * record + n_faces * 13);
    Scan scan;
    const char* p = bytes.data() + at + end.size();
    for (std::size_t i = 0; i < n_vertices; ++i, p += record) {
        std::memcpy(scan.points.emplace_back().data(), p, 12);
        if (color) std::memcpy(scan.colors.emplace_back().data(), p + 12, 3);
    }
    for (std::size_t i = 0; i < n_faces; ++i, p += 13) {
        EXPECT_EQ(*p, 3);
        std::memcpy(scan.triangles.emplace_back().data(), p + 1, 12);
        for (const std::uint32_t id : scan.triangles.back()) EXPECT_LT(id, n_vertices);
    }
    return scan;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// How often each directed edge is used.
std::map<Edge, int> directed_edges(const Scan& scan) {
    std::map<Edge, int> edges;
    for (const Ids& t : scan.triangles) {
        for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    }
    return edges;
}

double signed_volume(const Scan& scan) {
    double six = 0;
    for (const Ids& t : scan.triangles) {
        const Point& a = scan.points[t[0]];
        const Point& b = scan.points[t[1]];
        const Point& c = scan.points[t[2]];
        six += double{a[0]} * (double{b[1]} * c[2] - double{b[2]} * c[1]) +
               double{a[1]} * (double{b[2]} * c[0] - double{b[0]} * c[2]) +
               double{a[2]} * (double{b[0]} * c[1] - double{b[1]} * c[0]);
    }
    return six / 6;
}

/// Triangles as points, smallest corner first, so that numbering and order do not matter.
std::multiset<std::array<Point, 3>> as_soup(const Scan& scan) {
    std::multiset<std::array<Point, 3>> soup;
    for (const Ids& t : scan.triangles) {
        std::array<Point, 3> p{scan.points[t[0]], scan.points[t[1]], scan.points[t[2]]};
        std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
        soup.insert(p);
    }
    return soup;
}

class Generate : public testing::Test {
  protected:
    Generate() { fs::create_directories(folder_); }
    ~Generate() override { fs::remove_all(folder_); }
    Generate(const Generate&) = delete;
    Generate& operator=(const Generate&) = delete;

    std::string bytes(const GenerateOptions& options) {
        GenerateOptions o = options;
        o.overwrite = true;
        report_ = generate(folder_ / "scan.ply", o);
        std::string all = read_bytes(folder_ / "scan.ply");
        EXPECT_EQ(report_.bytes, all.size());
        return all;
    }
    Scan scan(const GenerateOptions& options) {
        Scan s = parse(bytes(options));
        EXPECT_EQ(report_.vertices, s.points.size());
        EXPECT_EQ(report_.triangles, s.triangles.size());
        return s;
    }

    fs::path folder_ = fs::temp_directory_path() / ("hewer-generate-" + std::to_string(::getpid()));
    GenerateReport report_;
};

TEST_F(Generate, MakesAClosedManifoldWoundOutwards) {
    for (const std::uint64_t n : {12U, 20U, 50U, 1000U, 30'000U}) {
        const Scan s = scan({.n_triangles = n, .n_threads = 2});
        const auto edges = directed_edges(s);
        for (const auto& [edge, count] : edges) {
            ASSERT_EQ(count, 1);
            ASSERT_EQ(edges.count({edge.second, edge.first}), 1U);
        }
        // Genus 0, one piece: V - E + F = 2.
        EXPECT_EQ(s.points.size() + s.triangles.size(), edges.size() / 2 + 2);
        EXPECT_GT(signed_volume(s), 0.1) << n;
        EXPECT_LT(signed_volume(s), 5) << n;
    }
}

TEST_F(Generate, MeetsTheCountWithinOneRing) {
    for (std::uint64_t n = 12; n < 40'000; n = n * 5 / 4 + 1) {
        (void)bytes({.n_triangles = n, .n_threads = 1});
        std::uint64_t width = 1;
        while (12 * (width + 1) * (width + 1) <= n) ++width;
        EXPECT_LE(report_.triangles, n);
        EXPECT_GT(report_.triangles + 8 * width, n);
    }
}

TEST_F(Generate, GivesEqualBytesForAnyNumberOfThreads) {
    for (GenerateOptions o :
         {GenerateOptions{.n_triangles = 150'000},
          GenerateOptions{.n_triangles = 150'000, .shuffle = true},
          GenerateOptions{.n_triangles = 150'000, .holes = true, .color = true}}) {
        o.n_threads = 1;
        const std::string one = bytes(o);
        for (const unsigned n_threads : {2U, 8U}) {
            o.n_threads = n_threads;
            EXPECT_TRUE(bytes(o) == one) << n_threads << " threads";
        }
    }
}

TEST_F(Generate, SeedsGiveDifferentSurfacesOfEqualCounts) {
    const Scan a = scan({.n_triangles = 5000, .seed = 1});
    const Scan b = scan({.n_triangles = 5000, .seed = 2});
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i) ASSERT_NE(a.points[i], b.points[i]) << i;
}

TEST_F(Generate, ShufflesTheSameSurface) {
    for (const std::uint64_t n : {12U, 500U, 20'000U}) {
        const Scan plain = scan({.n_triangles = n, .color = true});
        const Scan mixed = scan({.n_triangles = n, .shuffle = true, .color = true});
        EXPECT_EQ(as_soup(plain), as_soup(mixed));
        if (n < 500) continue;
        // Nothing near where it was: neighbours in the file are far apart on the surface.
        EXPECT_NE(plain.points, mixed.points);
        const auto span = [](const Scan& s) {
            double sum = 0;
            for (const Ids& t : s.triangles) {
                sum +=
                    *std::max_element(t.begin(), t.end()) - *std::min_element(t.begin(), t.end());
            }
            return sum / static_cast<double>(s.triangles.size() * s.points.size());
        };
        EXPECT_GT(span(mixed), 0.4);
        EXPECT_LT(span(plain), 0.2);
    }
}

TEST_F(Generate, HolesHaveBorderLoopsAndLeaveNoVertexBehind) {
    const Scan whole = scan({.n_triangles = 100'000});
    const Scan open = scan({.n_triangles = 100'000, .holes = true});
    EXPECT_LT(open.triangles.size(), whole.triangles.size() * 995 / 1000);
    EXPECT_GT(open.triangles.size(), whole.triangles.size() * 9 / 10);

    std::vector<bool> used(open.points.size());
    for (const Ids& t : open.triangles) {
        for (const std::uint32_t id : t) used[id] = true;
    }
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);

    // As many border edges enter a vertex as leave it, so they form loops; count those.
    const auto edges = directed_edges(open);
    std::multimap<std::uint32_t, std::uint32_t> border;
    std::map<std::uint32_t, int> balance;
    for (const auto& [edge, count] : edges) {
        ASSERT_EQ(count, 1);
        if (edges.count({edge.second, edge.first}) != 0) continue;
        border.emplace(edge.first, edge.second);
        ++balance[edge.first];
        --balance[edge.second];
    }
    for (const auto& [vertex, n] : balance) ASSERT_EQ(n, 0) << vertex;
    std::vector<std::size_t> loops;
    while (!border.empty()) {
        std::size_t length = 0;
        for (auto it = border.begin(); it != border.end(); ++length) {
            const std::uint32_t next = it->second;
            border.erase(it);
            it = border.find(next);
        }
        loops.push_back(length);
    }
    EXPECT_GE(loops.size(), 5U);
    EXPECT_GE(*std::max_element(loops.begin(), loops.end()),
              8 * *std::min_element(loops.begin(), loops.end()));

    // What is left lies where it lay.
    const auto all = as_soup(whole);
    std::size_t n_same = 0;
    for (const auto& triangle : as_soup(open)) n_same += all.count(triangle);
    EXPECT_GE(n_same, open.triangles.size() * 99 / 100);
}

TEST_F(Generate, PaintsWithManyColorsInFlatRegionsAndBlends) {
    const Scan s = scan({.n_triangles = 20'000, .color = true});
    ASSERT_EQ(s.colors.size(), s.points.size());
    EXPECT_GT(std::set<Rgb>(s.colors.begin(), s.colors.end()).size(), 500U);
    const auto bluish = std::count_if(s.colors.begin(), s.colors.end(),
                                      [](const Rgb& c) { return c[2] > 2 * c[0]; });
    EXPECT_GT(bluish, 500);
}

TEST_F(Generate, LargeShapeDoesNotDependOnTheCount) {
    const double coarse = signed_volume(scan({.n_triangles = 20'000}));
    const double fine = signed_volume(scan({.n_triangles = 200'000}));
    EXPECT_NEAR(coarse / fine, 1, 0.02);
}

TEST_F(Generate, RefusesWhatCannotBeMade) {
    const fs::path out = folder_ / "never.ply";
    EXPECT_THROW(generate(out, {.n_triangles = 0}), InvalidArgument);
    EXPECT_THROW(generate(out, {.n_triangles = 11}), InvalidArgument);
    EXPECT_THROW(generate(out, {.n_triangles = std::uint64_t{1} << 34}), InvalidArgument);
    EXPECT_THROW(generate(out, {.n_triangles = ~std::uint64_t{0}}), InvalidArgument);
    EXPECT_THROW(generate(out, {.shuffle = true, .holes = true}), InvalidArgument);
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Generate, KeepsAnExistingFileUnlessAskedToReplaceIt) {
    const fs::path out = folder_ / "kept.ply";
    std::ofstream(out) << "precious";
    EXPECT_THROW(generate(out, {.n_triangles = 100}), IoError);
    EXPECT_EQ(read_bytes(out), "precious");
    (void)generate(out, {.n_triangles = 100, .overwrite = true});
    EXPECT_NE(read_bytes(out), "precious");
}

TEST_F(Generate, LeavesNothingBehindWhereItCannotWrite) {
    EXPECT_THROW(generate(folder_ / "missing" / "scan.ply", {}), IoError);
    std::ofstream(folder_ / "file") << "x";
    EXPECT_THROW(generate(folder_ / "file" / "scan.ply", {}), IoError);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(Generate, LeavesNothingBehindWhenTheDiskIsFull) {
    // A limit on the size of files stands in for a full disk: write() fails half way.
    rlimit old{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit small = old;
    small.rlim_cur = 3 << 20;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    EXPECT_THROW(generate(folder_ / "scan.ply", {.n_triangles = 1'000'000}), IoError);
    ::setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, old_handler);
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Generate, StopsWhenAskedAndReportsRisingProgress) {
    std::stop_source stop;
    double last = 0;
    bool rises = true;
    Hooks hooks;
    hooks.stop = stop.get_token();
    hooks.on_progress = [&](const Progress& p) {
        rises = rises && p.fraction >= last;
        last = p.fraction;
        if (p.stage == "faces") stop.request_stop();
    };
    EXPECT_THROW(generate(folder_ / "scan.ply", {.n_triangles = 500'000}, hooks), Cancelled);
    EXPECT_TRUE(rises);
    EXPECT_GT(last, 0.5);
    EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace hewer

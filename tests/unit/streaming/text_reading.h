// SPDX-License-Identifier: MIT
/// Text files read by one of the readers for text: what comes out, or the message, must be the same
/// wherever the file is cut into chunks and however many threads parse them.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/text_import.h"
#include "tests/support/read_back.h"
#include "tests/support/temp_dir.h"

namespace hewer::tests {

using OpenText = std::unique_ptr<MeshSource> (*)(const ooc::InputFile&, const OpenOptions&,
                                                 const Hooks&, const streaming::TextTuning&);

/// What a file is read as; if `error` is not empty, the rest is.
struct TextResult {
    SourceInfo info;
    test::ReadBack back;
    std::string error;
};

inline TextResult read_file(OpenText open, const std::filesystem::path& path,
                            const OpenOptions& options = {}, std::uint64_t chunk_bytes = 0) {
    TextResult result;
    try {
        const ooc::InputFile file(path);
        const auto source = open(file, options, {}, {.chunk_bytes = chunk_bytes});
        result.info = source->info();
        result.back = test::read_all(*source);
    } catch (const FormatError& e) {
        result.error = e.what();
    }
    return result;
}

/// Bit by bit, for what may be no number.
template <typename T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline void expect_same(const TextResult& a, const TextResult& b) {
    EXPECT_EQ(a.error, b.error);
    expect_same_bits(a.back.mesh.positions, b.back.mesh.positions);
    expect_same_bits(a.back.mesh.normals, b.back.mesh.normals);
    EXPECT_EQ(a.back.mesh.colors, b.back.mesh.colors);
    EXPECT_EQ(a.back.mesh.triangles, b.back.mesh.triangles);
    expect_same_bits(a.back.soup, b.back.soup);
    EXPECT_EQ(a.info.ignored, b.info.ignored);
    EXPECT_EQ(a.info.has_alpha, b.info.has_alpha);
    const InputDefects& c = a.back.defects;
    const InputDefects& d = b.back.defects;
    EXPECT_EQ(c.nonfinite_vertices, d.nonfinite_vertices);
    EXPECT_EQ(c.nonfinite_triangles, d.nonfinite_triangles);
    EXPECT_EQ(c.out_of_range_triangles, d.out_of_range_triangles);
    EXPECT_EQ(c.short_faces, d.short_faces);
    EXPECT_EQ(c.polygons, d.polygons);
    EXPECT_EQ(c.first_nonfinite, d.first_nonfinite);
    EXPECT_EQ(c.first_out_of_range, d.first_out_of_range);
}

/// Reads `text` as a whole and in all kinds of pieces; they must agree.
inline TextResult read_in_all_ways(OpenText open, const std::string& text,
                                   OpenOptions options = {}) {
    const test::TempDir dir;
    const std::filesystem::path path = dir.write("input", text);
    options.n_threads = 1;
    const TextResult whole = read_file(open, path, options);
    for (const std::uint64_t chunk_bytes : {1U, 2U, 3U, 7U, 16U, 41U, 100U}) {
        for (const unsigned n_threads : {1U, 2U, 8U}) {
            SCOPED_TRACE("chunks of " + std::to_string(chunk_bytes) + " bytes, " +
                         std::to_string(n_threads) + " threads");
            options.n_threads = n_threads;
            expect_same(read_file(open, path, options, chunk_bytes), whole);
            if (testing::Test::HasFailure()) return whole;
        }
    }
    return whole;
}

/// The message without the folder, which differs from run to run.
inline void expect_words(const TextResult& result, const std::vector<std::string>& words) {
    EXPECT_FALSE(result.error.empty()) << "was read; expected: " << words.front();
    for (const std::string& word : words) {
        EXPECT_NE(result.error.find(word), std::string::npos)
            << word << " is not in: " << result.error;
    }
}

}  // namespace hewer::tests

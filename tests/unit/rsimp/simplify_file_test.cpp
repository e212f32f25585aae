// SPDX-License-Identifier: MIT
/// What simplify_file() refuses before any work.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "hewer/simplify.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

/// A PLY file with an honest header, all zeros behind it, and no blocks on the disk.
std::filesystem::path sparse_ply(const std::filesystem::path& path, std::uint64_t n_vertices,
                                 std::uint64_t n_faces) {
    const std::string header =
        "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(n_vertices) +
        "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
        std::to_string(n_faces) + "\nproperty list uchar uint vertex_indices\nend_header\n";
    std::ofstream(path, std::ios::binary) << header;
    std::filesystem::resize_file(path, header.size() + 12 * n_vertices + 13 * n_faces);
    return path;
}

std::string refusal(const std::filesystem::path& input, const std::filesystem::path& output,
                    const Target& target) {
    SimplifyOptions options;
    options.targets = {target};
    try {
        simplify_file(input, output, options);
    } catch (const InvalidArgument& e) {
        return e.what();
    } catch (const std::exception& e) {
        return std::string("another error: ") + e.what();
    }
    return "none";
}

TEST(SimplifyFile, RefusesAnOutputBeyondItsFormatBeforeReadingTheInput) {
    const test::TempDir folder;
    const auto input = sparse_ply(folder.path() / "in.ply", 200'000'000, 400'000'000);
    const auto output = folder.path() / "out.glb";
    for (const Target& target :
         {Target{Target::Kind::Triangles, 300e6}, Target{Target::Kind::Ratio, 0.75},
          Target{Target::Kind::Vertices, 150e6}}) {
        const std::string text = refusal(input, output, target);
        EXPECT_NE(text.find("4 GiB"), std::string::npos) << text;
        EXPECT_NE(text.find("write .gltf or .ply instead"), std::string::npos) << text;
    }
    EXPECT_FALSE(std::filesystem::exists(output));
}

TEST(SimplifyFile, LetsATargetPassThatTheInputCannotFill) {
    // Asked for more than the format holds, but the input has one triangle: not the format's fault.
    const test::TempDir folder;
    const auto input = sparse_ply(folder.path() / "in.ply", 3, 1);
    const std::string text =
        refusal(input, folder.path() / "out.glb", {Target::Kind::Triangles, 300e6});
    EXPECT_EQ(text.find("4 GiB"), std::string::npos) << text;
}

}  // namespace
}  // namespace hewer

// SPDX-License-Identifier: MIT
/// What a writer refuses, and what it leaves behind when it fails.
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "hewer/error.h"
#include "hewer/mesh_sink.h"
#include "tests/support/temp_dir.h"
#include "tests/unit/streaming/parsed_mesh.h"
#include "tests/unit/streaming/sample_mesh.h"

namespace hewer {
namespace {

using test::TempDir;
using tests::header_of;
using tests::pour;
using tests::wavy_sheet;

/// The message of the E that `action` throws.
template <typename E, typename Action>
std::string message_of(const Action& action) {
    try {
        action();
    } catch (const E& e) {
        return e.what();
    } catch (const std::exception& e) {
        ADD_FAILURE() << "another error: " << e.what();
        return {};
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

class WriterFaults : public testing::TestWithParam<const char*> {
  protected:
    WriterFaults() : path_(folder_.path() / (std::string("out") + GetParam())) {}
    TempDir folder_;
    std::filesystem::path path_;
};

INSTANTIATE_TEST_SUITE_P(Formats, WriterFaults,
                         testing::Values(".ply", ".obj", ".off", ".stl", ".glb", ".drc"),
                         [](const auto& test) { return std::string(test.param + 1); });

TEST_P(WriterFaults, MissingFolderIsNamedBeforeAnyWork) {
    const auto path = folder_.path() / "not-there" / path_.filename();
    const std::string text = message_of<IoError>([&] { create_mesh_file(path); });
    EXPECT_TRUE(contains(text, "not-there")) << text;
}

TEST_P(WriterFaults, FolderInPlaceOfTheFileIsRefused) {
    std::filesystem::create_directory(path_);
    EXPECT_THROW(create_mesh_file(path_, {.overwrite = true}), IoError);
}

TEST_P(WriterFaults, FolderThatCannotBeWrittenIsRefused) {
    // Permissions do not hold root back; a read-only file system does.
    const bool is_mounted =
        ::mount("tmpfs", folder_.path().c_str(), "tmpfs", MS_RDONLY, nullptr) == 0;
    if (!is_mounted) {
        if (::geteuid() == 0)
            GTEST_SKIP() << "root without the right to mount may write everywhere";
        std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_read |
                                                         std::filesystem::perms::owner_exec);
    }
    const std::string text = message_of<IoError>([&] { create_mesh_file(path_); });
    EXPECT_TRUE(contains(text, path_.string() + ": cannot create")) << text;
    if (is_mounted) {
        ::umount(folder_.path().c_str());
    } else {
        std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_all);
    }
}

TEST_P(WriterFaults, ExistingFileNeedsOverwrite) {
    std::ofstream(path_) << "mine";
    EXPECT_THROW(create_mesh_file(path_), IoError);
    EXPECT_EQ(tests::read_whole(path_), "mine");
    const Mesh mesh = wavy_sheet(5, 1, {0, 0, 0});
    const auto sink = create_mesh_file(path_, {.overwrite = true});
    EXPECT_EQ(tests::read_whole(path_), "mine") << "before finish()";
    pour(mesh, *sink);
    EXPECT_GT(std::filesystem::file_size(path_), 100U);
    EXPECT_EQ(folder_.n_entries(), 1U);
}

TEST_P(WriterFaults, DestroyedSinkLeavesNothingAndTouchesNothing) {
    const Mesh mesh = wavy_sheet(100, 1, {0, 0, 0});
    {
        const auto sink = create_mesh_file(path_);
        sink->begin(header_of(mesh));
        sink->add_vertices({mesh.positions, mesh.normals, mesh.colors});
        sink->add_triangles(mesh.triangles);
        EXPECT_FALSE(std::filesystem::exists(path_)) << "visible before finish()";
    }
    EXPECT_EQ(folder_.n_entries(), 0U);
    std::ofstream(path_) << "mine";
    {
        const auto sink = create_mesh_file(path_, {.overwrite = true});
        sink->begin(header_of(mesh));
        sink->add_vertices({mesh.positions, mesh.normals, mesh.colors});
    }
    EXPECT_EQ(tests::read_whole(path_), "mine");
    EXPECT_EQ(folder_.n_entries(), 1U);
}

TEST_P(WriterFaults, MisuseIsAnInternalErrorAndLeavesNothing) {
    const Mesh mesh = wavy_sheet(3, 1, {0, 0, 0});
    const VertexSpan all{mesh.positions, mesh.normals, mesh.colors};
    const std::vector<Triangle> wild{{0, 1, mesh.positions.size()}};
    const auto with = [&](const auto& action) {
        const auto sink = create_mesh_file(path_);
        return message_of<InternalError>([&] { action(*sink); });
    };
    const auto begin = [&](MeshSink& s) { s.begin(header_of(mesh)); };
    with([&](MeshSink& s) { s.add_vertices(all); });
    with([&](MeshSink& s) { s.finish(); });
    with([&](MeshSink& s) { begin(s), begin(s); });
    with([&](MeshSink& s) { begin(s), s.finish(); });
    with([&](MeshSink& s) { begin(s), s.add_triangles(mesh.triangles); });
    with([&](MeshSink& s) { begin(s), s.add_vertices(all), s.add_vertices(all); });
    with([&](MeshSink& s) { begin(s), s.add_vertices({mesh.positions, {}, mesh.colors}); });
    with([&](MeshSink& s) { begin(s), s.add_vertices({mesh.positions, mesh.normals, {}}); });
    const std::string few = with([&](MeshSink& s) {
        begin(s), s.add_vertices(all), s.add_triangles(std::span(mesh.triangles).first(3)),
            s.finish();
    });
    EXPECT_TRUE(contains(few, "3 of 8 announced triangles")) << few;
    with([&](MeshSink& s) {
        begin(s), s.add_vertices(all), s.add_triangles(mesh.triangles),
            s.add_triangles(mesh.triangles);
    });
    const std::string out_of_range =
        with([&](MeshSink& s) { begin(s), s.add_vertices(all), s.add_triangles(wild); });
    EXPECT_TRUE(contains(out_of_range, "vertex 9 of 9")) << out_of_range;
    EXPECT_EQ(folder_.n_entries(), 0U);
}

TEST_P(WriterFaults, FileSizeLimitIsAnIoErrorAndLeavesTheOldFile) {
    std::ofstream(path_) << "mine";
    const Mesh mesh = wavy_sheet(200, 1, {0, 0, 0});
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit small = before;
    small.rlim_cur = 100'000;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string text = message_of<IoError>([&] {
        const auto sink = create_mesh_file(path_, {.overwrite = true});
        pour(mesh, *sink);
    });
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old_handler);
    EXPECT_TRUE(contains(text, path_.string())) << text;
    EXPECT_EQ(tests::read_whole(path_), "mine");
    EXPECT_EQ(folder_.n_entries(), 1U);
}

TEST_P(WriterFaults, FullDiskIsAnIoErrorAndLeavesTheOldFile) {
    if (::mount("tmpfs", folder_.path().c_str(), "tmpfs", 0, "size=256k") != 0) {
        GTEST_SKIP() << "a file system of our own to fill needs root";
    }
    std::ofstream(path_) << "mine";
    const Mesh mesh = wavy_sheet(200, 1, {0, 0, 0});
    const std::string text = message_of<IoError>([&] {
        const auto sink = create_mesh_file(path_, {.overwrite = true});
        pour(mesh, *sink);
    });
    EXPECT_TRUE(contains(text, "No space left")) << text;
    EXPECT_EQ(tests::read_whole(path_), "mine");
    EXPECT_EQ(folder_.n_entries(), 1U);
    ::umount(folder_.path().c_str());
}

TEST(CreateMeshFile, UnsupportedExtensionListsTheSupportedOnes) {
    const TempDir folder;
    for (const char* name : {"a.txt", "a.ply.gz", "a", ".ply", "a."}) {
        const std::string text =
            message_of<InvalidArgument>([&] { create_mesh_file(folder.path() / name); });
        EXPECT_TRUE(contains(text, ".ply, .obj, .off, .stl, .glb, .gltf, .drc")) << text;
    }
    EXPECT_EQ(folder.n_entries(), 0U);
}

TEST(FormatLimits, AreToldInBeginAndLeaveNothing) {
    const TempDir folder;
    const auto refuse = [&](const char* name, const SinkHeader& header) {
        const auto sink = create_mesh_file(folder.path() / name);
        return message_of<InvalidArgument>([&] { sink->begin(header); });
    };
    SinkHeader many;
    many.n_vertices = 3;
    many.n_triangles = 1ULL << 32;
    EXPECT_TRUE(contains(refuse("a.stl", many), "4,294,967,295"));
    EXPECT_TRUE(contains(refuse("a.glb", many), "write .gltf or .ply instead"));
    many.n_triangles = 1;
    many.n_vertices = (1ULL << 32) + 1;
    EXPECT_TRUE(contains(refuse("a.ply", many), "4,294,967,296"));
    many.n_vertices = 400'000'000;  // 4.8e9 bytes of positions
    EXPECT_TRUE(contains(refuse("a.glb", many), "4 GiB"));
    many.n_vertices = ~0ULL / 12;  // would wrap
    EXPECT_TRUE(contains(refuse("a.glb", many), "4 GiB"));
    EXPECT_TRUE(contains(refuse("a.glb", SinkHeader{}), "without triangles"));
    SinkHeader wide;
    wide.n_vertices = 3;
    wide.n_triangles = 1;
    wide.bounds.extend(Vec3{0, 0, -1e39});
    wide.bounds.extend(Vec3{1, 1, 0});
    EXPECT_TRUE(contains(refuse("a.stl", wide), "3.4e38"));
    EXPECT_TRUE(contains(refuse("a.glb", wide), "3.4e38"));
    EXPECT_EQ(folder.n_entries(), 0U);
}

TEST(FormatLimits, GlbTakesWhatJustFits) {
    const TempDir folder;
    SinkHeader header;
    header.n_triangles = 1;
    // 2 * 16 + 12 + 2048 + 12 bytes besides the positions.
    header.n_vertices = (0xFFFFFFFFULL - 2048 - 28 - 12) / 12;
    create_mesh_file(folder.path() / "a.glb")->begin(header);
    ++header.n_vertices;
    const auto sink = create_mesh_file(folder.path() / "a.glb");
    EXPECT_THROW(sink->begin(header), InvalidArgument);
}

}  // namespace
}  // namespace hewer

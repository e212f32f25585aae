// SPDX-License-Identifier: MIT
/// Files that appear whole or not at all, whatever becomes of the process that writes them.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <string>

#include "hewer/error.h"
#include "hewer/text_file.h"
#include "ooc/file.h"
#include "ooc/pending_file.h"
#include "tests/support/temp_dir.h"

namespace hewer::ooc {

namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;
using Naming = PendingFile::Naming;

Names names_in(const fs::path& folder) {
    Names names;
    for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
    return names;
}

std::string content(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

void put(const PendingFile& file, const std::string& text) {
    ASSERT_EQ(::write(file.descriptor(), text.data(), text.size()),
              static_cast<ssize_t>(text.size()));
}

/// What a process leaves that is killed while it writes `path`.
void write_and_die(const fs::path& path, Naming naming) {
    const pid_t child = ::fork();
    if (child == 0) {
        const PendingFile file(path, naming);
        put(file, "half");
        ::raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
}

class PendingFiles : public testing::TestWithParam<Naming> {
  protected:
    test::TempDir folder_;
    const fs::path path_ = folder_.path() / "out.ply";
};

INSTANTIATE_TEST_SUITE_P(Namings, PendingFiles,
                         testing::Values(Naming::WhenWhole, Naming::FromTheStart),
                         [](const auto& test) {
                             return test.param == Naming::WhenWhole ? "when_whole"
                                                                    : "from_the_start";
                         });

}  // namespace

TEST_P(PendingFiles, AppearWhenPublished) {
    {
        PendingFile file(path_, GetParam());
        put(file, "new");
        EXPECT_FALSE(fs::exists(path_));
        file.publish(false);
        EXPECT_EQ(content(path_), "new");
    }
    EXPECT_EQ(names_in(folder_.path()), Names{"out.ply"});
    struct stat st {};
    ASSERT_EQ(::stat(path_.c_str(), &st), 0);
    const mode_t mask = ::umask(0);
    ::umask(mask);
    EXPECT_EQ(st.st_mode & 0777U, 0666U & ~mask);
}

TEST_P(PendingFiles, LeaveNothingUnpublished) {
    {
        const PendingFile file(path_, GetParam());
        put(file, "half");
    }
    EXPECT_EQ(names_in(folder_.path()), Names{});
}

TEST_P(PendingFiles, ReplaceOnlyWhenTold) {
    std::ofstream(path_) << "old";
    {
        PendingFile file(path_, GetParam());
        put(file, "new");
        EXPECT_THROW(file.publish(false), IoError);
    }
    EXPECT_EQ(content(path_), "old");
    EXPECT_EQ(names_in(folder_.path()), Names{"out.ply"});
    {
        PendingFile file(path_, GetParam());
        put(file, "new");
        EXPECT_EQ(content(path_), "old");
        file.publish(true);
    }
    EXPECT_EQ(content(path_), "new");
    EXPECT_EQ(names_in(folder_.path()), Names{"out.ply"});
}

TEST_P(PendingFiles, OfAKilledProcessAreGoneWhenTheNextIsOpened) {
    write_and_die(path_, GetParam());
    EXPECT_EQ(names_in(folder_.path()).size(), GetParam() == Naming::WhenWhole ? 0U : 1U);
    { const PendingFile next(path_, GetParam()); }
    EXPECT_EQ(names_in(folder_.path()), Names{});
}

TEST(PendingFile, KeepsWhatLivingProcessesAndOthersWrite) {
    const test::TempDir folder;
    const fs::path path = folder.path() / "out.ply";
    write_and_die(path, Naming::FromTheStart);
    write_and_die(folder.path() / "other.ply", Naming::FromTheStart);
    std::ofstream(folder.path() / "out.ply.hewer-notes.tmp") << "mine";
    PendingFile living(path, Naming::FromTheStart);  // removes the first
    put(living, "living");
    const Names before = names_in(folder.path());
    EXPECT_EQ(before.size(), 3U);
    { const PendingFile next(path, Naming::FromTheStart); }
    EXPECT_EQ(names_in(folder.path()), before);
    living.publish(false);
    EXPECT_EQ(content(path), "living");
}

TEST(OutputGroup, NamesItsFilesTogether) {
    const test::TempDir folder;
    const auto write_both = [&](OutputGroup& group, const std::string& text) {
        for (const char* name : {"a", "b"}) {
            OutputFile file(folder.path() / name, true);
            file.publish_with(group);
            file.write(text);
            file.commit();
            EXPECT_EQ(file.bytes_written(), text.size());
        }
    };
    {
        OutputGroup group;
        write_both(group, "one");
        EXPECT_EQ(names_in(folder.path()), Names{});
        group.publish();
        EXPECT_EQ(names_in(folder.path()), (Names{"a", "b"}));
    }
    {
        OutputGroup group;
        write_both(group, "two");
    }
    EXPECT_EQ(names_in(folder.path()), (Names{"a", "b"}));
    EXPECT_EQ(content(folder.path() / "a") + content(folder.path() / "b"), "oneone");
}

TEST(OutputFile, RefusesWhatIsNoOrdinaryFile) {
    const test::TempDir folder;
    const fs::path pipe = folder.path() / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    fs::create_symlink("/dev/full", folder.path() / "full");
    for (const fs::path& path : {pipe, folder.path() / "full", folder.path()}) {
        for (const bool overwrite : {false, true}) {
            EXPECT_THROW(OutputFile(path, overwrite), IoError) << path;
        }
    }
    EXPECT_TRUE(fs::is_fifo(pipe));
    EXPECT_TRUE(fs::is_symlink(folder.path() / "full"));
}

TEST(TextFile, IsWholeAndReplacesOnlyWhenTold) {
    const test::TempDir folder;
    const fs::path path = folder.path() / "report.json";
    write_text_file(path, "one");
    EXPECT_THROW(write_text_file(path, "two"), IoError);
    EXPECT_EQ(content(path), "one");
    write_text_file(path, "two", true);
    EXPECT_EQ(content(path), "two");
    EXPECT_EQ(names_in(folder.path()), Names{"report.json"});
}

}  // namespace hewer::ooc

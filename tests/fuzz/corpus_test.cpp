// SPDX-License-Identifier: MIT
/// Replays the small files that fuzzing began with or ended at: tests/fuzz/corpus/FORMAT/*.
#include <gtest/gtest.h>

#include "tests/fuzz/read_all.h"

namespace hewer {
namespace {

TEST(FuzzCorpus, IsReadOrRefused) {
    std::size_t n_files = 0;
    std::size_t n_read = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(HEWER_FUZZ_CORPUS)) {
        if (!entry.is_regular_file()) continue;
        const std::string folder = entry.path().parent_path().filename().string();
        const std::string format = folder == "packed" ? std::string() : folder;
        for (const bool is_strict : {false, true}) {
            SCOPED_TRACE(entry.path().string());
            n_read += fuzz::read_all(entry.path(), format, is_strict) ? 1U : 0U;
        }
        ++n_files;
    }
    EXPECT_GE(n_files, 20U);
    EXPECT_GT(n_read, n_files / 2) << "the corpus is to have good files, too";
}

}  // namespace
}  // namespace hewer

// SPDX-License-Identifier: MIT
#include "ooc/spool.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/mount.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "hewer/error.h"
#include "ooc/array.h"
#include "ooc/external_sort.h"
#include "ooc/parallel.h"
#include "ooc/ranked_set.h"
#include "ooc/spool_cache.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"

namespace hewer::ooc {

namespace {

namespace fs = std::filesystem;

struct Odd {  // a size that divides no page
    std::array<std::uint32_t, 7> words;
    bool operator==(const Odd&) const = default;
};

Odd odd(std::uint64_t i) {
    Odd record{};
    for (std::size_t k = 0; k < 7; ++k) record.words[k] = static_cast<std::uint32_t>(i * 31 + k);
    return record;
}

/// Room for `bytes` beside what the process itself takes.
ResourceLimits tight(std::uint64_t bytes, std::uint64_t page_bytes) {
    return {.memory_bytes = MemoryBudget::kFixedBytes + bytes,
            .n_threads = 2,
            .page_bytes = page_bytes};
}

void fill(Spool<Odd>& spool, std::uint64_t n, std::uint64_t seed) {
    test::Random random(seed);
    std::vector<Odd> piece;
    while (spool.size() < n) {
        piece.clear();
        const std::uint64_t count = std::min(n - spool.size(), random.below(300));
        for (std::uint64_t i = 0; i < count; ++i) piece.push_back(odd(spool.size() + i));
        spool.append(piece);
    }
}

void expect_all(const Spool<Odd>& spool, std::uint64_t seed) {
    SpoolReader<Odd> reader(spool);
    for (std::uint64_t i = 0; i < spool.size(); ++i) ASSERT_EQ(*reader.next(), odd(i)) << i;
    EXPECT_EQ(reader.next(), nullptr);
    test::Random random(seed);
    std::vector<Odd> out;
    for (int k = 0; k < 200; ++k) {
        const std::uint64_t first = random.below(spool.size());
        out.resize(random.below(std::min<std::uint64_t>(5000, spool.size() - first)) + 1);
        spool.read(first, out);
        for (std::uint64_t i = 0; i < out.size(); ++i) ASSERT_EQ(out[i], odd(first + i));
    }
    SpoolCache<Odd> cache(spool);
    for (int k = 0; k < 500; ++k) {
        const std::uint64_t i = random.below(spool.size());
        ASSERT_EQ(cache.at(i), odd(i));
    }
}

}  // namespace

TEST(Spool, GivesBackWhatWasAppendedWhereverItIs) {
    for (const std::uint64_t page : {4096U, 70'000U, 1U << 20}) {
        for (const std::uint64_t memory : {std::uint64_t{3} << 20, std::uint64_t{1} << 30}) {
            Context context(tight(memory, page));
            Spool<Odd> spool(context, "odd records");
            fill(spool, 300'000, page);  // 8.4 MB
            expect_all(spool, page);
            EXPECT_EQ(context.spill().used() > 0, memory < (1U << 30)) << page;
        }
    }
}

TEST(Spool, MakesRoomForReservations) {
    Context context(tight(20 << 20, 256 << 10));
    std::vector<Spool<Odd>> spools;
    for (std::uint64_t k = 0; k < 3; ++k) {
        spools.emplace_back(context, "odd records");
        fill(spools.back(), 100'000 * (k + 1), k);
    }
    EXPECT_EQ(context.spill().used(), 0U);
    {
        const Array<std::byte> large(context.budget(), "working memory", 15 << 20);
        EXPECT_GT(context.spill().used(), 8U << 20);
        for (const auto& spool : spools) expect_all(spool, 9);
    }
    // What cannot fit at all is still refused.
    EXPECT_THROW((Array<std::byte>(context.budget(), "too much", 21 << 20)), OutOfMemoryBudget);
    for (const auto& spool : spools) expect_all(spool, 10);
    spools.clear();
    EXPECT_EQ(context.spill().used(), 0U);
    EXPECT_EQ(context.budget().used(), MemoryBudget::kFixedBytes);
}

TEST(Spool, ManyThreadsAppendReadAndEvict) {
    Context context({.memory_bytes = MemoryBudget::kFixedBytes + (6U << 20),
                     .n_threads = 8,
                     .page_bytes = 32 << 10});
    Spool<Odd> shared(context, "shared");
    fill(shared, 60'000, 1);
    context.workers().on_each([&](unsigned worker) {
        for (int round = 0; round < 5; ++round) {
            Spool<Odd> own(context, "own");
            fill(own, 30'000, worker);
            expect_all(own, worker);
            std::vector<Odd> out(1000);
            shared.read(worker * 5000U, out);
            ASSERT_EQ(out[999], odd(worker * 5000U + 999));
        }
    });
}

TEST(Spool, DiscardedPagesGiveTheirSpaceBack) {
    for (const std::uint64_t memory : {2U << 20, 200U << 20}) {
        Context context(tight(memory, 64 << 10));
        Spool<Odd> spool(context, "odd records");
        fill(spool, 300'000, 5);
        const std::uint64_t before = context.spill().used() + context.budget().used();
        spool.discard_before(200'000);
        EXPECT_LT(context.spill().used() + context.budget().used() + (5U << 20), before);
        std::vector<Odd> out(100'000);
        spool.read(200'000, out);
        EXPECT_EQ(out.front(), odd(200'000));
        EXPECT_EQ(out.back(), odd(299'999));
    }
}

TEST(Spool, DamageIsAnErrorAndNeverAWrongRecord) {
    Context context(tight(1 << 20, 64 << 10));
    Spool<Odd> spool(context, "odd records");
    fill(spool, 200'000, 6);
    ASSERT_GE(spool.spill_descriptor(), 0);
    // One bit of each 64 KiB.
    for (off_t at = 1000; at < static_cast<off_t>(context.spill().used()); at += 64 << 10) {
        unsigned char byte = 0;
        ASSERT_EQ(::pread(spool.spill_descriptor(), &byte, 1, at), 1);
        byte ^= 4;
        ASSERT_EQ(::pwrite(spool.spill_descriptor(), &byte, 1, at), 1);
    }
    std::vector<Odd> out(200'000);
    try {
        spool.read(0, out);
        FAIL() << "the damage was not seen";
    } catch (const IoError& e) {
        EXPECT_NE(std::string(e.what()).find("odd records"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("damaged"), std::string::npos) << e.what();
    }
}

TEST(Spool, PagesThatAreCutOffAreAnError) {
    Context context(tight(1 << 20, 64 << 10));
    Spool<Odd> spool(context, "odd records");
    fill(spool, 200'000, 6);
    ASSERT_EQ(::ftruncate(spool.spill_descriptor(), 100'000), 0);
    std::vector<Odd> out(200'000);
    EXPECT_THROW(spool.read(0, out), IoError);
}

TEST(SpillSpace, StaysWithinItsLimitAndSaysSo) {
    ResourceLimits limits = tight(1 << 20, 64 << 10);
    limits.max_temp_bytes = 2 << 20;
    Context context(limits);
    Spool<Odd> spool(context, "odd records");
    try {
        fill(spool, 1'000'000, 7);
        FAIL() << "the limit did not hold";
    } catch (const OutOfDiskBudget& e) {
        EXPECT_NE(std::string(e.what()).find("--max-temp"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("2.00 MiB"), std::string::npos) << e.what();
    }
    EXPECT_LE(context.spill().peak(), 2U << 20);
}

TEST(SpillSpace, LeavesNothingInItsFolder) {
    const test::TempDir folder;
    ResourceLimits limits = tight(1 << 20, 64 << 10);
    limits.temp_dir = folder.path();
    {
        Context context(limits);
        EXPECT_TRUE(fs::is_empty(folder.path()));
        Spool<Odd> spool(context, "odd records");
        fill(spool, 200'000, 8);
        EXPECT_GT(context.spill().used(), 0U);
        EXPECT_TRUE(fs::is_empty(folder.path()));  // not even while it runs
    }
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(SpillSpace, RefusesAFolderThatCannotBeUsed) {
    const test::TempDir folder;
    EXPECT_THROW(Context({.temp_dir = folder.path() / "missing"}), IoError);
}

TEST(SpillSpace, AFullDiskIsReported) {
    const test::TempDir folder;
    if (::mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=2m") != 0) {
        GTEST_SKIP() << "no small file system can be mounted here (needs root)";
    }
    std::string message;
    try {
        ResourceLimits limits = tight(1 << 20, 64 << 10);
        limits.temp_dir = folder.path();
        Context context(limits);
        Spool<Odd> spool(context, "odd records");
        fill(spool, 1'000'000, 9);
    } catch (const OutOfDiskBudget& e) {
        message = e.what();
    }
    ::umount(folder.path().c_str());
    EXPECT_NE(message.find(folder.path().string()), std::string::npos) << message;
}

TEST(Checksum, SeesEveryBit) {
    std::vector<unsigned char> data(300);
    std::iota(data.begin(), data.end(), static_cast<unsigned char>(1));
    for (const std::size_t n : {1U, 31U, 32U, 33U, 100U, 300U}) {
        const std::uint64_t sum = checksum(data.data(), n);
        for (std::size_t bit = 0; bit < 8 * n; ++bit) {
            data[bit / 8] = static_cast<unsigned char>(data[bit / 8] ^ (1U << (bit % 8)));
            EXPECT_NE(checksum(data.data(), n), sum);
            data[bit / 8] = static_cast<unsigned char>(data[bit / 8] ^ (1U << (bit % 8)));
        }
        EXPECT_EQ(checksum(data.data(), n), sum);
    }
}

TEST(ExternalSorter, SortsLikeStdSortWithAnyBuffer) {
    test::Random random(11);
    for (const std::uint64_t n : {0U, 1U, 1000U, 100'000U}) {
        std::vector<std::uint64_t> values;
        for (std::uint64_t i = 0; i < n; ++i) values.push_back(random.below(n / 2 + 1));
        std::vector<std::uint64_t> expected = values;
        std::sort(expected.begin(), expected.end());
        for (const std::uint64_t buffer : {400U, 10'000U, 10'000'000U}) {
            if (n > 10'000 && buffer < 10'000) continue;
            Context context(tight(12 << 20, 4096));
            ExternalSorter<std::uint64_t, std::less<>> sorter(context, "numbers", {}, buffer);
            sorter.add(values);
            const Spool<std::uint64_t> sorted = sorter.finish();
            std::vector<std::uint64_t> out(sorted.size());
            sorted.read(0, out);
            EXPECT_EQ(out, expected) << n << ' ' << buffer;

            ExternalSorter<std::uint64_t, std::less<>> other(context, "numbers", {}, buffer);
            other.add(values);
            auto stream = other.stream();
            EXPECT_EQ(stream.n_left(), n);
            for (const std::uint64_t value : expected) {
                ASSERT_NE(stream.peek(), nullptr);
                ASSERT_EQ(*stream.peek(), value);
                ASSERT_EQ(*stream.next(), value) << n << ' ' << buffer;
            }
            EXPECT_EQ(stream.n_left(), 0U);
            EXPECT_EQ(stream.peek(), nullptr);
            EXPECT_EQ(stream.next(), nullptr);
        }
    }
}

TEST(ExternalSorter, HoldsNoMoreThanItsBufferAndGivesItBack) {
    constexpr std::uint64_t kBuffer = 4 << 20;
    Context context(tight(64 << 20, 64 << 10));
    const std::uint64_t before = context.budget().used();
    const auto heap_bytes = [] {
        const struct mallinfo2 info = ::mallinfo2();
        return info.uordblks + info.hblkhd;
    };
    const std::uint64_t heap_before = heap_bytes();
    {
        ExternalSorter<std::uint64_t, std::less<>> sorter(context, "numbers", {}, kBuffer);
        EXPECT_EQ(context.budget().used(), before + kBuffer);
        test::Random random(12);
        for (std::uint64_t i = 0; i < 1'000'000; ++i) sorter.add(random.below(1'000'000));
        auto stream = sorter.stream();
        // The buffer is gone, from the heap as well as from the budget.
        EXPECT_LT(heap_bytes(), heap_before + kBuffer / 2);
        std::uint64_t last = 0;
        while (const std::uint64_t* value = stream.next()) {
            ASSERT_LE(last, *value);
            last = *value;
        }
        // Nothing is left of the runs that were read: the buffers of their readers are.
        EXPECT_LE(context.budget().used(), before + kBuffer);
    }
    EXPECT_EQ(context.budget().used(), before);
}

TEST(SpoolReader, TakesAsMuchOfAPieceAsIsWanted) {
    Context context(tight(8 << 20, 4096));
    Spool<Odd> spool(context, "records");
    fill(spool, 20000, 7);
    SpoolReader<Odd> reader(spool);
    test::Random random(8);
    std::uint64_t i = 0;
    for (;;) {
        const std::span<const Odd> piece = reader.peek_piece();
        if (piece.empty()) break;
        const std::uint64_t n = 1 + random.below(piece.size());
        for (std::uint64_t k = 0; k < n; ++k) ASSERT_EQ(piece[k], odd(i + k));
        reader.skip(n);
        i += n;
        ASSERT_EQ(reader.position(), i);
    }
    EXPECT_EQ(i, spool.size());
}

TEST(Spool, KeepsItsRecordsWhenSealed) {
    for (const std::uint64_t n : {0U, 1U, 1000U, 40'000U}) {
        for (const bool is_tight : {false, true}) {
            Context context(tight(is_tight ? 2 << 20 : 64 << 20, 64 << 10));
            Spool<std::array<std::uint32_t, 3>> spool(context, "triples");
            for (std::uint32_t i = 0; i < n; ++i) spool.push({i, i + 1, i + 2});
            spool.seal();
            EXPECT_EQ(spool.size(), n);
            SpoolReader<std::array<std::uint32_t, 3>> reader(spool);
            for (std::uint32_t i = 0; i < n; ++i) {
                const auto* record = reader.next();
                ASSERT_NE(record, nullptr);
                ASSERT_EQ((*record)[0], i);
                ASSERT_EQ((*record)[2], i + 2);
            }
            EXPECT_EQ(reader.next(), nullptr);
        }
    }
}

TEST(RankedSet, CountsTheMembersBelow) {
    test::Random random(13);
    Context context(tight(64 << 20, 64 << 10));
    for (const std::uint64_t n : {1U, 63U, 64U, 65U, 513U, 20'000U}) {
        RankedSet set(context.budget(), "ids", n);
        std::vector<bool> members(n);
        for (std::uint64_t i = 0; i < n; ++i) {
            if (random.below(3) != 0) continue;
            set.insert(i);
            members[i] = true;
        }
        const std::uint64_t size = set.number();
        std::uint64_t below = 0;
        for (std::uint64_t i = 0; i < n; ++i) {
            EXPECT_EQ(set.rank(i), below);
            EXPECT_EQ(set.has(i), members[i]);
            if (members[i]) ++below;
        }
        EXPECT_EQ(size, below);
    }
}

}  // namespace hewer::ooc

// SPDX-License-Identifier: MIT
/// Texts for people: numbers, the progress bar, the option table.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "app/arguments.h"
#include "app/format_text.h"
#include "app/option_table.h"
#include "app/progress_bar.h"
#include "hewer/units.h"

namespace hewer::app {
namespace {

TEST(FormatText, separates_thousands) {
    EXPECT_EQ(format_count(0), "0");
    EXPECT_EQ(format_count(999), "999");
    EXPECT_EQ(format_count(1000), "1,000");
    EXPECT_EQ(format_count(1234567), "1,234,567");
    EXPECT_EQ(format_plural(1, "cell"), "1 cell");
    EXPECT_EQ(format_plural(2000, "cell"), "2,000 cells");
}

TEST(FormatText, writes_times_as_people_do) {
    EXPECT_EQ(format_seconds(3.14), "3.1 s");
    EXPECT_EQ(format_seconds(245), "4 min 05 s");
    EXPECT_EQ(format_seconds(7380), "2 h 03 min");
}

TEST(FormatText, has_no_share_of_nothing) {
    EXPECT_EQ(format_percent(1, 200), "0.5 %");
    EXPECT_EQ(format_percent(1, 0), "-");
}

TEST(ProgressBar, shows_stage_percent_rate_and_time_left) {
    Progress p;
    p.stage = "cluster";
    p.fraction = 0.5;
    p.remaining_seconds = 12;
    p.unit = "triangles";
    const std::string bar = format_bar(p, 3.14e6, 200);
    EXPECT_EQ(bar, "[############            ]  50 %  cluster, 3.1 M triangles/s, 12.0 s left");
    EXPECT_EQ(format_bar(p, 3.14e6, 20), bar.substr(0, 20));
    p.remaining_seconds = -1;
    EXPECT_EQ(format_bar(p, 0, 200), "[############            ]  50 %  cluster");
}

TEST(ProgressBar, is_drawn_on_request_only_when_there_is_no_terminal) {
    EXPECT_EQ(choose_progress_style("bar", true), ProgressStyle::Bar);
    EXPECT_EQ(choose_progress_style("json", false), ProgressStyle::Json);
    EXPECT_EQ(choose_progress_style("none", false), ProgressStyle::None);
    EXPECT_EQ(choose_progress_style("", true), ProgressStyle::None);
}

TEST(OptionTable, has_unique_keys_and_flags_in_every_command) {
    for (const CommandSpec& command : command_table()) {
        std::set<std::string_view> keys;
        std::set<std::string_view> flags;
        for (const OptionSpec& option : option_table()) {
            if (!option.belongs_to(command.command)) continue;
            EXPECT_TRUE(keys.insert(option.key).second) << command.name << ' ' << option.key;
            EXPECT_TRUE(flags.insert(long_name(option)).second) << command.name << option.flags;
        }
    }
}

TEST(OptionTable, has_defaults_that_its_own_parser_accepts) {
    for (const CommandSpec& command : command_table()) {
        EXPECT_NO_THROW(Arguments{command.command}) << command.name;
    }
    EXPECT_EQ(Arguments(Command::Generate).get<std::uint64_t>("triangles"), 1'000'000U);
}

TEST(OptionTable, explains_every_option) {
    for (const OptionSpec& option : option_table()) {
        EXPECT_TRUE(option.help.ends_with('.')) << option.key;
        EXPECT_NE(option.commands, 0U) << option.key;
        EXPECT_EQ(option.metavar.empty(), option.is_operand() || option.type == ValueType::Flag)
            << option.key;
    }
}

}  // namespace
}  // namespace hewer::app

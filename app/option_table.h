// SPDX-License-Identifier: MIT
/// The one table of what the command line takes. It drives the parser, --help, the README's table
/// (`hewer help --markdown`) and the keys of the report's "options".
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace hewer::app {

enum class Command : unsigned { Simplify, Measure, Info, Plan, Generate, Render, Help };

/// How the text of a value is read; parse_units.h has the grammar of each.
enum class ValueType {
    Flag,    ///< no value
    Name,    ///< of something in the input
    Path,    ///< a file or folder name
    Paths,   ///< one or more of them; an operand
    Choice,  ///< one of OptionSpec::choices
    Count,
    CountOrOff,  ///< "off" is 0
    Bytes,
    Ratio,
    Error,
    Lods,
    Number,
    Box,
    FocusBoxes,  ///< boxes with a weight each; may be given again and again
    Pixels,
    Pair,
    Quantization,
};

struct OptionSpec {
    /// Of the value in the report's "options" and in Arguments; unique within a command.
    std::string_view key;
    std::string_view flags;    ///< "-o,--output"; for an operand the name in usage lines: "INPUT"
    std::string_view metavar;  ///< of the value: "SIZE"; empty for flags and operands
    ValueType type;
    unsigned commands;          ///< bits of the commands that take it
    std::string_view unit;      ///< "model units"; empty: none
    std::string_view fallback;  ///< default, as a user would write it, or in words after a '='
    double least;               ///< of Count, Bytes, Number and both of Pixels; inclusive
    double most;                ///< inclusive
    std::string_view choices;   ///< "a|b": of a Choice; for an output path its extensions
    std::string_view group;     ///< heading in --help
    bool is_required;
    std::string_view help;

    [[nodiscard]] bool is_operand() const { return !flags.starts_with('-'); }
    [[nodiscard]] bool belongs_to(Command c) const {
        return ((commands >> static_cast<unsigned>(c)) & 1U) != 0;
    }
    /// The default can be parsed; a default in words ("=half of the machine") is only shown.
    [[nodiscard]] bool has_parsed_default() const {
        return !fallback.empty() && !fallback.starts_with('=');
    }
};

struct CommandSpec {
    Command command;
    std::string_view name;
    std::string_view usage;    ///< what follows the name
    std::string_view summary;  ///< one line
};

std::span<const OptionSpec> option_table();
std::span<const CommandSpec> command_table();

std::string_view command_name(Command command);

/// The row of `key` in `command`. Throws InternalError for an unknown key.
const OptionSpec& find_option(Command command, std::string_view key);

/// The long form: "--output" of "-o,--output"; an operand as it is.
std::string_view long_name(const OptionSpec& option);

}  // namespace hewer::app

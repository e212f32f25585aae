// SPDX-License-Identifier: MIT
#include "app/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include "app/help_text.h"
#include "app/option_table.h"
#include "hewer/error.h"
#include "hewer/version.h"

namespace hewer::app {

namespace {

const CommandSpec* find_command(std::string_view name) {
    const auto commands = command_table();
    const auto it = std::find_if(commands.begin(), commands.end(),
                                 [&](const CommandSpec& c) { return c.name == name; });
    return it == commands.end() ? nullptr : &*it;
}

std::string list_commands() {
    std::string text;
    for (const CommandSpec& c : command_table()) {
        text += (text.empty() ? "" : ", ") + std::string(c.name);
    }
    return text;
}

// Fewest letters to insert, delete or replace to make `b` of `a` (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t k = 0; k < b.size(); ++k) {
            const std::size_t replaced = diagonal + (a[i] == b[k] ? 0 : 1);
            diagonal = row[k + 1];
            row[k + 1] = std::min({row[k + 1] + 1, row[k] + 1, replaced});
        }
    }
    return row.back();
}

// What to say of arguments that no option took: the first unknown option, else the first operand.
std::string describe_extras(Command command, const std::vector<std::string>& extras) {
    const auto unknown = std::find_if(extras.begin(), extras.end(),
                                      [](const std::string& s) { return s.starts_with('-'); });
    if (unknown == extras.end()) return "one argument too many: '" + extras.front() + "'";
    std::string text = "unknown option '" + *unknown + "'";
    constexpr std::size_t kTypo = 3;
    std::size_t best = kTypo;
    std::string_view nearest;
    for (const OptionSpec& o : option_table()) {
        if (!o.belongs_to(command) || o.is_operand()) continue;
        const std::size_t distance = edit_distance(*unknown, long_name(o));
        if (distance >= best) continue;
        best = distance;
        nearest = long_name(o);
    }
    if (!nearest.empty()) text += "; did you mean " + std::string(nearest) + "?";
    return text;
}

// One option of the table and where CLI11 puts its texts.
struct Slot {
    const OptionSpec* spec;
    std::vector<std::string> texts;
    CLI::Option* option = nullptr;
};

constexpr int kMostValues = 1 << 20;

bool may_be_repeated(const OptionSpec& option) {
    return option.type == ValueType::Paths || option.type == ValueType::FocusBoxes;
}

// The values of `command`, whose arguments are args.
std::variant<Arguments, HelpText> parse_command(const CommandSpec& command,
                                                std::vector<std::string> args) {
    CLI::App app;
    app.set_help_flag("-h,--help");
    std::vector<Slot> slots;
    for (const OptionSpec& option : option_table()) {
        if (option.belongs_to(command.command)) slots.push_back({&option, {}});
    }
    for (Slot& slot : slots) {
        const OptionSpec& o = *slot.spec;
        const std::string name(o.is_operand() ? o.key : o.flags);
        if (o.type == ValueType::Flag) {
            slot.option = app.add_flag(name);
        } else if (o.type == ValueType::Paths) {
            slot.option = app.add_option(name, slot.texts)->expected(1, kMostValues);
        } else if (o.type == ValueType::FocusBoxes) {
            slot.option =
                app.add_option(name, slot.texts)->expected(1, kMostValues)->allow_extra_args(false);
        } else {
            slot.option = app.add_option(name, slot.texts)->expected(1)->allow_extra_args(false);
        }
    }
    try {
        std::reverse(args.begin(), args.end());  // CLI11 takes them from the back
        app.parse(args);
    } catch (const CLI::CallForHelp&) {
        return HelpText{command_help(command)};
    } catch (const CLI::ExtrasError&) {
        throw InvalidArgument(describe_extras(command.command, app.remaining()));
    } catch (const CLI::ArgumentMismatch& e) {
        const auto twice = std::find_if(slots.begin(), slots.end(), [](const Slot& s) {
            return s.option->count() > 1 && !may_be_repeated(*s.spec);
        });
        if (twice != slots.end()) {
            throw InvalidArgument(std::string(long_name(*twice->spec)) +
                                  " is given more than once");
        }
        const std::string text = e.what();  // "--cell: 1 required TEXT missing"
        throw InvalidArgument(text.substr(0, text.find(':')) + ": its value is missing");
    }
    Arguments arguments(command.command);
    for (const Slot& slot : slots) {
        const OptionSpec& o = *slot.spec;
        if (slot.option->count() != 0) {
            arguments.set(o, slot.texts);
        } else if (o.is_required) {
            throw InvalidArgument(std::string(o.flags) + " is missing");
        }
    }
    return arguments;
}

}  // namespace

std::variant<Arguments, HelpText> parse_command_line(int argc, const char* const* argv) {
    std::vector<std::string> args(argv + std::min(argc, 1), argv + argc);
    if (args.empty()) throw UsageError("no command; commands are " + list_commands(), "");
    const std::string name = args.front();
    if (name == "--help" || name == "-h") return HelpText{general_help()};
    if (name == "--version") return HelpText{"hewer " + std::string(version()) + "\n"};
    const CommandSpec* command = find_command(name);
    if (command == nullptr) {
        throw UsageError("unknown command '" + name + "'; commands are " + list_commands(), "");
    }
    args.erase(args.begin());
    try {
        auto parsed = parse_command(*command, std::move(args));
        const auto* arguments = std::get_if<Arguments>(&parsed);
        if (arguments == nullptr || command->command != Command::Help) return parsed;
        if (arguments->flag("markdown")) return HelpText{markdown_reference()};
        const std::string topic = arguments->get<std::string>("topic");
        return HelpText{topic.empty() ? general_help() : command_help(*find_command(topic))};
    } catch (const CLI::ParseError& e) {
        throw UsageError(e.what(), name);
    } catch (const InvalidArgument& e) {
        throw UsageError(e.what(), name);
    }
}

}  // namespace hewer::app

// SPDX-License-Identifier: MIT
#include "app/help_text.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>
#include <vector>

#include "app/exit_code.h"
#include "hewer/version.h"

namespace hewer::app {

namespace {

constexpr std::size_t kColumns = 96;
constexpr std::size_t kHelpColumn = 26;

// `text` broken at spaces; every line but the first is indented.
std::string wrap(std::string_view text, std::size_t indent) {
    std::string out;
    std::size_t column = indent;
    while (!text.empty()) {
        const std::size_t space = std::min(text.find(' '), text.size());
        const std::string_view word = text.substr(0, space);
        if (column > indent && column + 1 + word.size() > kColumns) {
            out += '\n' + std::string(indent, ' ');
            column = indent;
        }
        if (column > indent) {
            out += ' ';
            ++column;
        }
        out += word;
        column += word.size();
        text.remove_prefix(std::min(space + 1, text.size()));
    }
    return out;
}

std::string row(const std::string& left, std::string_view right) {
    std::string line = "  " + left;
    if (line.size() + 2 > kHelpColumn) {
        line += '\n' + std::string(kHelpColumn, ' ');
    } else {
        line.resize(kHelpColumn, ' ');
    }
    return line + wrap(right, kHelpColumn) + '\n';
}

std::string join_choices(std::string_view choices, std::string_view separator) {
    std::string text;
    for (const char c : choices) text += c == '|' ? std::string(separator) : std::string(1, c);
    return text;
}

// "--memory SIZE", "-o, --output OUTPUT", "INPUT".
std::string spell(const OptionSpec& o) {
    std::string text(o.flags);
    if (const std::size_t comma = text.find(','); comma != std::string::npos) {
        text.insert(comma + 1, " ");
    }
    if (!o.metavar.empty()) text += ' ' + std::string(o.metavar);
    return text;
}

std::string describe_default(const OptionSpec& o) {
    return std::string(o.fallback.starts_with('=') ? o.fallback.substr(1) : o.fallback);
}

std::string plain_number(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.10g", value);
    return text.data();
}

// "1 to 1024"; empty where the type alone limits the value.
std::string describe_range(const OptionSpec& o) {
    const bool is_number = o.type == ValueType::Count || o.type == ValueType::CountOrOff ||
                           o.type == ValueType::Number || o.type == ValueType::Pixels;
    constexpr double kWorthTelling = 1e9;  // larger bounds are not met in practice
    if (!is_number) return {};
    if (o.most < kWorthTelling) return plain_number(o.least) + " to " + plain_number(o.most);
    if (o.least >= 1) return "at least " + plain_number(o.least);
    return o.least > 0 ? "above 0" : "";
}

std::string describe_value(const OptionSpec& o) {
    if (o.type == ValueType::Choice) return join_choices(o.choices, ", ");
    std::string text(o.unit);
    const std::string range = describe_range(o);
    return text + (text.empty() || range.empty() ? "" : ", ") + range;
}

std::string describe(const OptionSpec& o) {
    std::string text(o.help);
    std::string notes;
    const auto add = [&](const std::string& note) { notes += (notes.empty() ? "" : "; ") + note; };
    if (const std::string value = describe_value(o); !value.empty()) add(value);
    if (!o.fallback.empty()) add("default: " + describe_default(o));
    if (!notes.empty()) text += " [" + notes + "]";
    return text;
}

std::string list_users(const OptionSpec& o) {
    std::string text;
    for (const CommandSpec& c : command_table()) {
        if (!o.belongs_to(c.command)) continue;
        text += (text.empty() ? "" : ", ") + std::string(c.name);
    }
    return text;
}

std::string exit_codes() {
    std::string text = "Exit codes:\n";
    for (const ExitMeaning& m : exit_meanings()) {
        text += row(std::to_string(static_cast<int>(m.code)), m.meaning);
    }
    return text;
}

}  // namespace

std::string general_help() {
    std::string text = "hewer " + std::string(version()) +
                       ": simplifies triangle meshes of any size within a memory limit\n\n"
                       "Usage: hewer COMMAND ...\n\nCommands:\n";
    for (const CommandSpec& c : command_table()) text += row(std::string(c.name), c.summary);
    text +=
        "\n`hewer COMMAND --help` lists the options of a command; --version prints the version.\n";
    text +=
        "Numbers take k, M, G (1.5M is 1,500,000); sizes take K, M, G, KiB, MiB, GiB, powers of "
        "1024.\n\n";
    return text + exit_codes();
}

std::string command_help(const CommandSpec& command) {
    std::string text = "Usage: hewer " + std::string(command.name) + ' ' +
                       std::string(command.usage) + "\n\n" + std::string(command.summary) + '\n';
    std::vector<std::string_view> groups;
    for (const OptionSpec& o : option_table()) {
        if (o.belongs_to(command.command) &&
            std::find(groups.begin(), groups.end(), o.group) == groups.end()) {
            groups.push_back(o.group);
        }
    }
    for (const std::string_view group : groups) {
        text += '\n' + std::string(group) + ":\n";
        for (const OptionSpec& o : option_table()) {
            if (o.belongs_to(command.command) && o.group == group) {
                text += row(spell(o), describe(o));
            }
        }
    }
    return text + '\n' + exit_codes();
}

std::string markdown_reference() {
    std::string text = "| option | commands | value | default | meaning |\n|---|---|---|---|---|\n";
    for (const OptionSpec& o : option_table()) {
        text += "| `" + spell(o) + "` | " + list_users(o) + " | " + describe_value(o) + " | " +
                describe_default(o) + " | " + std::string(o.help) + " |\n";
    }
    text += "\n### Exit codes\n\n| code | meaning |\n|---|---|\n";
    for (const ExitMeaning& m : exit_meanings()) {
        text += "| " + std::to_string(static_cast<int>(m.code)) + " | " + std::string(m.meaning) +
                " |\n";
    }
    return text;
}

}  // namespace hewer::app

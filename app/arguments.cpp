// SPDX-License-Identifier: MIT
#include "app/arguments.h"

#include <cstdio>

#include "app/parse_units.h"
#include "hewer/error.h"

namespace hewer::app {

namespace {

std::string short_number(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.17g", value);
    std::array<char, 32> brief{};
    std::snprintf(brief.data(), brief.size(), "%g", value);
    return parse_number(brief.data()) == value ? brief.data() : text.data();
}

void check_range(const OptionSpec& option, const std::string& text, double value) {
    if (value < option.least) {
        std::string why = "'" + text + "' is below " + short_number(option.least);
        if (option.type == ValueType::Bytes) {
            why = "'" + text + "' is less than a mebibyte; did you mean " + text + "M?";
        } else if (option.least > 0 && option.least < 1e-300) {
            why = "'" + text + "' is not above 0";
        }
        throw InvalidArgument(why);
    }
    if (value > option.most) {
        throw InvalidArgument("'" + text + "' is above " + short_number(option.most));
    }
}

// The words of "a|b|c" are `choices`; true if `text` is one of them.
bool is_one_of(std::string_view choices, std::string_view text) {
    while (!choices.empty()) {
        const std::size_t bar = choices.find('|');
        if (choices.substr(0, bar) == text) return true;
        if (bar == std::string_view::npos) break;
        choices.remove_prefix(bar + 1);
    }
    return false;
}

std::string list_choices(std::string_view choices) {
    std::string text;
    for (const char c : choices) text += c == '|' ? std::string(", ") : std::string(1, c);
    return text;
}

std::string parse_path(const OptionSpec& option, const std::string& text) {
    if (text.empty()) throw InvalidArgument("the name is empty");
    if (option.choices.empty()) return text;
    std::string extension = std::filesystem::path(text).extension().string();
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    if (!is_one_of(option.choices, extension)) {
        throw InvalidArgument("'" + text + "' has " +
                              (extension.empty() ? "no extension" : "the extension " + extension) +
                              "; the format follows it, and hewer writes " +
                              list_choices(option.choices) + " here");
    }
    return text;
}

Value parse_any(const OptionSpec& option, const std::string& text) {
    switch (option.type) {
        case ValueType::Flag:
            return true;
        case ValueType::Name:
            if (text.empty()) throw InvalidArgument("the name is empty");
            return text;
        case ValueType::Path:
        case ValueType::Paths:
            return parse_path(option, text);
        case ValueType::Choice:
            if (!is_one_of(option.choices, text)) {
                throw InvalidArgument("'" + text + "' is none of " + list_choices(option.choices));
            }
            return text;
        case ValueType::CountOrOff:
            if (text == "off") return std::uint64_t{0};
            [[fallthrough]];
        case ValueType::Count: {
            const std::uint64_t count = parse_count(text);
            check_range(option, text, static_cast<double>(count));
            return count;
        }
        case ValueType::Bytes: {
            const std::uint64_t bytes = parse_bytes(text);
            check_range(option, text, static_cast<double>(bytes));
            return bytes;
        }
        case ValueType::Ratio:
            return parse_ratio(text);
        case ValueType::Error:
            return parse_error(text);
        case ValueType::Lods:
            return parse_lods(text);
        case ValueType::Number: {
            const double number = parse_number(text);
            check_range(option, text, number);
            return number;
        }
        case ValueType::Box:
            return parse_box(text);
        case ValueType::FocusBoxes:
            return std::vector{parse_focus(text)};
        case ValueType::Pixels: {
            const auto pixels = parse_pixels(text);
            for (const std::uint64_t n : pixels) {
                check_range(option, text, static_cast<double>(n));
            }
            return pixels;
        }
        case ValueType::Pair:
            return parse_pair(text);
        case ValueType::Quantization:
            return parse_quantization(text);
    }
    throw InternalError("value type without a parser");
}

}  // namespace

Value parse_value(const OptionSpec& option, const std::string& text) {
    try {
        return parse_any(option, text);
    } catch (const InvalidArgument& e) {
        throw InvalidArgument(std::string(long_name(option)) + ": " + e.what());
    }
}

Arguments::Arguments(Command command) : command_(command) {
    for (const OptionSpec& option : option_table()) {
        if (!option.belongs_to(command) || !option.has_parsed_default()) continue;
        entries_[option.key] = {parse_value(option, std::string(option.fallback)), false};
    }
}

void Arguments::set(const OptionSpec& option, const std::vector<std::string>& texts) {
    if (option.type == ValueType::Paths) {
        for (const std::string& text : texts) parse_value(option, text);
        entries_[option.key] = {texts, true};
        return;
    }
    if (option.type == ValueType::FocusBoxes) {
        std::vector<FocusBox> boxes;
        boxes.reserve(texts.size());
        for (const std::string& text : texts) {
            boxes.push_back(std::get<std::vector<FocusBox>>(parse_value(option, text)).front());
        }
        entries_[option.key] = {boxes, true};
        return;
    }
    entries_[option.key] = {parse_value(option, texts.empty() ? std::string() : texts.front()),
                            true};
}

bool Arguments::is_given(std::string_view key) const {
    const auto it = entries_.find(find_option(command_, key).key);
    return it != entries_.end() && it->second.is_given;
}

const Value* Arguments::find(std::string_view key) const {
    const auto it = entries_.find(find_option(command_, key).key);
    return it == entries_.end() ? nullptr : &it->second.value;
}

bool Arguments::flag(std::string_view key) const {
    return is_given(key);
}

std::filesystem::path Arguments::path(std::string_view key) const {
    return get<std::string>(key);
}

std::vector<std::filesystem::path> Arguments::paths(std::string_view key) const {
    const auto texts = get<std::vector<std::string>>(key);
    return {texts.begin(), texts.end()};
}

}  // namespace hewer::app

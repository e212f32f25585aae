// SPDX-License-Identifier: MIT
/// The values of one command line, parsed and within their ranges.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/option_table.h"
#include "hewer/options.h"

namespace hewer::app {

using Value = std::variant<bool, std::uint64_t, double, std::string, std::vector<std::string>,
                           Target, std::vector<Target>, Bounds, std::array<std::uint64_t, 2>,
                           std::array<double, 2>, Quantization, std::vector<FocusBox>>;

/// Reads `text` as the option says and checks its range and choices.
/// Throws InvalidArgument: "--triangles: '0' is below 1".
Value parse_value(const OptionSpec& option, const std::string& text);

/// Values by key. Options that were not given hold their default, or nothing.
class Arguments {
  public:
    explicit Arguments(Command command);

    [[nodiscard]] Command command() const { return command_; }

    /// `texts` are several only for options of type Paths and FocusBoxes.
    void set(const OptionSpec& option, const std::vector<std::string>& texts);

    /// The user wrote it.
    [[nodiscard]] bool is_given(std::string_view key) const;
    /// Null if it was not given and has no default that can be parsed.
    [[nodiscard]] const Value* find(std::string_view key) const;

    [[nodiscard]] bool flag(std::string_view key) const;
    [[nodiscard]] std::filesystem::path path(std::string_view key) const;
    [[nodiscard]] std::vector<std::filesystem::path> paths(std::string_view key) const;
    /// `otherwise` if find() is null.
    template <typename T>
    [[nodiscard]] T get(std::string_view key, T otherwise = {}) const {
        const Value* value = find(key);
        return value != nullptr ? std::get<T>(*value) : otherwise;
    }

  private:
    struct Entry {
        Value value;
        bool is_given = false;
    };
    Command command_;
    std::map<std::string_view, Entry> entries_;
};

}  // namespace hewer::app

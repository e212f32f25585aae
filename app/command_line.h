// SPDX-License-Identifier: MIT
/// From argv to Arguments, by the option table. CLI11 does the splitting.
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "app/arguments.h"
#include "hewer/error.h"

namespace hewer::app {

/// The user asked for a text instead of a run: for standard output.
struct HelpText {
    std::string text;
};

/// Throws UsageError.
std::variant<Arguments, HelpText> parse_command_line(int argc, const char* const* argv);

/// InvalidArgument that knows which command's help would have prevented it.
class UsageError : public InvalidArgument {
  public:
    UsageError(const std::string& text, std::string command)
        : InvalidArgument(text), command_(std::move(command)) {}
    /// "simplify", or empty.
    [[nodiscard]] const std::string& command() const { return command_; }

  private:
    std::string command_;
};

}  // namespace hewer::app

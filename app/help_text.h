// SPDX-License-Identifier: MIT
/// Texts for people, made from the option table.
#pragma once

#include <string>

#include "app/option_table.h"

namespace hewer::app {

std::string general_help();
std::string command_help(const CommandSpec& command);

/// The README's tables of all options and of the exit codes, Markdown.
std::string markdown_reference();

}  // namespace hewer::app

// SPDX-License-Identifier: MIT
/// Values out of a JSON file, for shell scripts on machines without jq.
///
///     json_value FILE POINTER...
///
/// Prints the value at each JSON pointer ("/forward/rms"), parted by spaces on one line. A missing
/// one is an error: a benchmark must not go on with an empty number.
#include <cstdio>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fputs("usage: json_value FILE POINTER...\n", stderr);
        return 2;
    }
    try {
        std::ifstream file(argv[1]);
        const nlohmann::json document = nlohmann::json::parse(file);
        std::string line;
        for (int i = 2; i < argc; ++i) {
            const nlohmann::json& value = document.at(nlohmann::json::json_pointer(argv[i]));
            if (i > 2) line += ' ';
            line += value.is_string() ? value.get<std::string>() : value.dump();
        }
        std::puts(line.c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "json_value: %s: %s\n", argv[1], error.what());
        return 1;
    }
    return 0;
}

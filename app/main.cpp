// SPDX-License-Identifier: MIT
/// The program: parse, run, and turn whatever happens into one sentence and an exit code.

#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <variant>

#include "app/command_line.h"
#include "app/commands.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "hewer/error.h"

namespace hewer::app {

namespace {

ExitCode run(const Arguments& arguments, const std::stop_token& stop) {
    switch (arguments.command()) {
        case Command::Simplify:
            run_simplify(arguments, stop);
            return ExitCode::Ok;
        case Command::Measure:
            return run_measure(arguments, stop);
        case Command::Info:
            run_info(arguments, stop);
            return ExitCode::Ok;
        case Command::Plan:
            run_plan(arguments);
            return ExitCode::Ok;
        case Command::Generate:
            run_generate(arguments, stop);
            return ExitCode::Ok;
        case Command::Render:
            run_render(arguments, stop);
            return ExitCode::Ok;
        case Command::Help:
            break;  // became a HelpText
    }
    throw InternalError("command without a body");
}

void flush_output() {
    std::cout.flush();
    if (!std::cout || std::fflush(stdout) != 0) {
        throw IoError("standard output: cannot write the results");
    }
}

ExitCode run_all(int argc, const char* const* argv) {
    const auto parsed = parse_command_line(argc, argv);
    if (const auto* help = std::get_if<HelpText>(&parsed)) {
        std::cout << help->text;
        flush_output();
        return ExitCode::Ok;
    }
    const auto& arguments = std::get<Arguments>(parsed);
    const Interrupt interrupt;
    ExitCode code = ExitCode::Ok;
    try {
        code = run(arguments, interrupt.token());
    } catch (const Cancelled&) {
        std::cerr << "hewer: interrupted; no file was left behind\n";
        return Interrupt::signal() == SIGINT ? ExitCode::Interrupted : ExitCode::Terminated;
    } catch (const UsageError&) {
        throw;
    } catch (const InvalidArgument& e) {
        throw UsageError(e.what(), std::string(command_name(arguments.command())));
    }
    flush_output();
    return code;
}

ExitCode report_failure(const std::exception& error) {
    const ExitCode code = classify(error);
    std::string text = error.what();
    if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
        text = "the system refused memory; lower --memory or free some";
    } else if (code == ExitCode::Internal) {
        text = "internal error: " + text + "; please report it with the command line";
    }
    std::cerr << "hewer: error: " << text << '\n';
    if (const auto* usage = dynamic_cast<const UsageError*>(&error)) {
        std::cerr << "see hewer " << usage->command() << (usage->command().empty() ? "" : " ")
                  << "--help\n";
    }
    return code;
}

}  // namespace

}  // namespace hewer::app

int main(int argc, char** argv) {
    using hewer::app::ExitCode;
    // A file size limit then makes a write fail, with a message, instead of ending the process.
    std::signal(SIGXFSZ, SIG_IGN);
    ExitCode code = ExitCode::Internal;
    try {
        code = hewer::app::run_all(argc, argv);
    } catch (const std::exception& e) {
        code = hewer::app::report_failure(e);
    } catch (...) {
        std::cerr << "hewer: error: internal error: unknown exception\n";
    }
    return static_cast<int>(code);
}

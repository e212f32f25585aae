// SPDX-License-Identifier: MIT
/// Ctrl-C and its kin, turned into a stop request.
#pragma once

#include <memory>
#include <stop_token>

namespace hewer::app {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP requests a stop; a second one removes the
/// temporary files and ends the process at once. A signal that was ignored when the program started
/// (nohup, a shell's background job) stays ignored. One at a time in a process.
class Interrupt {
  public:
    Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;
    ~Interrupt();

    [[nodiscard]] std::stop_token token() const { return stop_.get_token(); }
    /// The first signal that came, 0 for none.
    [[nodiscard]] static int signal();

  private:
    std::stop_source stop_;
    struct Waiter;
    std::unique_ptr<Waiter> waiter_;
};

}  // namespace hewer::app

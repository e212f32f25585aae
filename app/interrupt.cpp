// SPDX-License-Identifier: MIT
#include "app/interrupt.h"

#include <semaphore.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <thread>

#include "hewer/cleanup.h"

namespace hewer::app {

namespace {

constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};
constexpr int kSignalBase = 128;  // a shell's code for "ended by signal n" is 128 + n

std::atomic<int> g_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler writes it");
sem_t g_arrived;

// A stop request may run callbacks and take locks, so a thread makes it; all that the handler does
// is async-signal-safe.
extern "C" void on_signal(int signal) {
    const int error = errno;
    int none = 0;
    if (!g_signal.compare_exchange_strong(none, signal)) {
        remove_temporary_files();
        ::_exit(kSignalBase + (signal == SIGHUP ? SIGTERM : signal));
    }
    ::sem_post(&g_arrived);
    errno = error;
}

}  // namespace

struct Interrupt::Waiter {
    std::array<struct sigaction, kSignals.size()> before{};
    std::atomic<bool> is_over{false};
    std::thread thread;
};

Interrupt::Interrupt() : waiter_(std::make_unique<Waiter>()) {
    ::sem_init(&g_arrived, 0, 0);
    waiter_->thread = std::thread([this] {
        while (::sem_wait(&g_arrived) != 0) {
        }
        if (!waiter_->is_over) stop_.request_stop();
    });
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        ::sigaction(kSignals[i], nullptr, &waiter_->before[i]);
        if (waiter_->before[i].sa_handler == SIG_IGN) continue;
        ::sigaction(kSignals[i], &action, nullptr);
    }
}

Interrupt::~Interrupt() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        ::sigaction(kSignals[i], &waiter_->before[i], nullptr);
    }
    waiter_->is_over = true;
    ::sem_post(&g_arrived);
    waiter_->thread.join();
    ::sem_destroy(&g_arrived);
}

int Interrupt::signal() {
    return g_signal.load();
}

}  // namespace hewer::app

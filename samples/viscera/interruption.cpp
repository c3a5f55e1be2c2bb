#include "samples/viscera/interruption.h"

#include <csignal>

namespace viscera::app {
namespace {

// A signal handler can reach nothing else.
volatile std::sig_atomic_t pressed = 0;

void on_interrupt(int) {
    pressed = 1;
    std::signal(SIGINT, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
    std::signal(SIGINT, on_interrupt);
}

bool interrupted() {
    return pressed != 0;
}

}  // namespace viscera::app

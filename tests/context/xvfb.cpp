#include "tests/context/xvfb.h"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cctype>

namespace viscera::test {

const Xvfb& Xvfb::of_process() {
    static const Xvfb server;
    return server;
}

Xvfb::Xvfb() {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) {
        return;
    }
    // Xvfb picks a free display itself and writes its number once it takes connections.
    std::string number = std::to_string(ends[1]);
    std::array<std::string, 8> words{"Xvfb", "-displayfd", number,      "-screen",
                                     "0",    "640x480x24", "-nolisten", "tcp"};
    std::array<char*, 9> arguments{};
    for (std::size_t i = 0; i < words.size(); ++i) {
        arguments[i] = words[i].data();
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", 1, 0);  // 1: write only
    if (posix_spawnp(&pid_, "Xvfb", &actions, nullptr, arguments.data(), environ) != 0) {
        pid_ = -1;
    }
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    char digit = '\0';
    while (pid_ > 0 && read(ends[0], &digit, 1) == 1 &&
           std::isdigit(static_cast<unsigned char>(digit)) != 0) {
        display_ += display_.empty() ? std::string(":") + digit : std::string(1, digit);
    }
    close(ends[0]);
}

Xvfb::~Xvfb() {
    if (pid_ > 0) {
        kill(pid_, SIGTERM);
        waitpid(pid_, nullptr, 0);
    }
}

}  // namespace viscera::test

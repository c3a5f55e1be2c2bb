#include "tests/app/process.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>

#include <fcntl.h>

#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

void apply(const Call& call, const std::string& folder) {
    // What a program writes where it stands must not stay in the checkout.
    if (chdir(folder.c_str()) != 0) {
        _exit(126);
    }
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    unsetenv("XDG_CACHE_HOME");  // no test reads what another one kept
    unsetenv("HOME");
    for (const auto& [name, value] : call.environment) {
        value ? setenv(name.c_str(), value->c_str(), 1) : unsetenv(name.c_str());
    }
    if (call.most_file_bytes) {
        // The limit shows as an error of write(), as a full disk does, and not as a signal.
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{*call.most_file_bytes, *call.most_file_bytes};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
}

}  // namespace

Ended run(const std::vector<std::string>& arguments, const Call& call) {
    const TempFolder folder;
    const std::string out = (folder / "out").string();
    const std::string err = (folder / "err").string();
    const std::string here = (folder / "here").string();
    std::filesystem::create_directory(here);
    std::vector<char*> words;
    words.reserve(arguments.size() + 1);
    for (const std::string& argument : arguments) {
        words.push_back(const_cast<char*>(argument.c_str()));
    }
    words.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        constexpr int mode = O_WRONLY | O_CREAT | O_TRUNC;
        dup2(open(out.c_str(), mode, 0600), STDOUT_FILENO);
        dup2(open(err.c_str(), mode, 0600), STDERR_FILENO);
        apply(call, here);
        execvp(words[0], words.data());
        _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    Ended ended;
    ended.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    ended.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    ended.out = slurp(out);
    ended.err = slurp(err);
    return ended;
}

Ended viscera(const std::vector<std::string>& arguments, const Call& call) {
    std::vector<std::string> all{VISCERA_APP};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run(all, call);
}

}  // namespace viscera::test

#pragma once

#include <sys/types.h>

#include <string>

namespace viscera::test {

/// A virtual X server of this process, started at first use and ended with the process: GLFW keeps its
/// connection.
class Xvfb {
  public:
    /// Empty display() when Xvfb is not installed.
    static const Xvfb& of_process();

    Xvfb(const Xvfb&) = delete;
    Xvfb& operator=(const Xvfb&) = delete;
    ~Xvfb();
    [[nodiscard]] const std::string& display() const { return display_; }

  private:
    Xvfb();
    pid_t pid_ = -1;
    std::string display_;  ///< ":1"
};

}  // namespace viscera::test

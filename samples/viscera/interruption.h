#pragma once

namespace viscera::app {

/// What shells give for a program that Ctrl-C ended.
inline constexpr int interrupted_exit_code = 130;

/// From now on Ctrl-C asks the command to end at the next good moment. A second one ends the process as ever.
void catch_interrupts();
/// Whether Ctrl-C has been pressed.
[[nodiscard]] bool interrupted();

}  // namespace viscera::app

#include "samples/viscera/title_progress.h"

#include <cmath>
#include <utility>

namespace viscera::app {

bool TitleProgress::operator()(std::string_view what, double fraction) {
    const long percent = std::lround(100.0 * fraction);
    if (std::exchange(percent_, percent) != percent) {
        window_.set_title(percent < 100
                              ? title_ + ": " + std::string(what) + ' ' + std::to_string(percent) + " %"
                              : title_);
        // The renderer is at work: what else the user does must not reach it.
        WindowEvents events = std::exchange(window_.events, {});
        window_.events.key = [this](int key, bool, Modifiers) {
            if (key == key::escape) {
                window_.close();
            }
        };
        window_.poll();
        window_.events = std::move(events);
    }
    cancelled_ = window_.should_close();
    return !cancelled_;
}

}  // namespace viscera::app

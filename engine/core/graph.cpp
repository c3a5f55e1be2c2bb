#include "engine/core/graph.h"

namespace viscera {

std::string_view to_string(Access access) {
    switch (access) {
        case Access::read:
            return "read";
        case Access::write:
            return "write";
        case Access::modify:
            return "modify";
        case Access::previous:
            return "previous";
    }
    return "unknown";
}

bool is_target_name(std::string_view name) {
    constexpr std::size_t longest = 128;
    bool in_word = false;
    for (const char c : name) {
        const bool word_character = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
        if (!word_character && !(c == '.' && in_word)) {
            return false;
        }
        in_word = word_character;
    }
    return in_word && name.size() <= longest;
}

}  // namespace viscera

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

}  // namespace viscera

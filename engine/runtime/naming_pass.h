#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "engine/core/error.h"

namespace viscera {

/// Returns what `call` returns. What only a frame shows of a scene's faults (a size, a picture that does not
/// fit) is said by effects with their parameters; which pass it is, only the executor knows, and adds it.
template <class Call>
decltype(auto) naming_pass(std::string_view pass, Call&& call) {
    try {
        return std::forward<Call>(call)();
    } catch (const Error& error) {
        if (error.code() != ErrorCode::scene) {
            throw;
        }
        throw Error(error.code(), "pass '" + std::string(pass) + "', " + error.where(),
                    std::string(error.message()));
    }
}

}  // namespace viscera

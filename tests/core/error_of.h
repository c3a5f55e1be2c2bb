#pragma once

#include <optional>

#include "engine/core/error.h"

namespace viscera::test {

/// The Error that a call throws; none when it returns.
template <class Call>
std::optional<Error> error_of(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        return error;
    }
    return std::nullopt;
}

}  // namespace viscera::test

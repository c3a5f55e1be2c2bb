#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/core/params_json.h"
#include "engine/core/scene.h"

namespace viscera {

/// Puts each override's value where its pointer says: a member that is there or new, an element that is
/// there, or a new last one ("-"). A pointer whose parent is not there is a fault.
void apply_overrides(nlohmann::json& document, std::span<const SceneOverride> overrides,
                     std::vector<JsonFault>& faults);

/// Replaces `$ref`s by the parts of `shared` that they name.
class References {
  public:
    /// Both must outlive the references; `shared` is an object.
    References(const nlohmann::json& shared, std::vector<JsonFault>& faults)
        : shared_(shared), faults_(faults) {}

    /// The value without `$ref`s. Missing and cyclic ones are faults at `pointer` and below.
    [[nodiscard]] nlohmann::json expand(const nlohmann::json& value, const std::string& pointer);

  private:
    [[nodiscard]] nlohmann::json expand_reference(const nlohmann::json& value, const std::string& pointer);
    [[nodiscard]] const nlohmann::json* find(const std::string& reference, const std::string& pointer);
    [[nodiscard]] bool spend(const nlohmann::json& value, const std::string& pointer);

    const nlohmann::json& shared_;
    std::vector<JsonFault>& faults_;
    std::vector<std::string> open_;  ///< references being expanded
    std::size_t depth_ = 0;
    std::size_t spent_ = 0;
};

}  // namespace viscera

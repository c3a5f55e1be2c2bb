#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/core/params_json.h"

namespace viscera {

enum class FieldKind { boolean, integer, number, vector, text, path, choice, group, list, optional };

/// A field of a parameter struct as schema and documentation need it.
struct FieldNode {
    FieldInfo info;
    FieldKind kind = FieldKind::boolean;
    int components = 1;                ///< of a vector
    std::vector<std::string> choices;  ///< of a choice
    nlohmann::json value;              ///< as write_params gives it; null for a group
    std::vector<FieldNode> children;   ///< of a group: its fields; of a list or an optional: what it holds
};

/// Fields in the order they are visited. The texts in `info` must outlive the tree. Lists and optionals are
/// grown by one element to look into it, and left as they were.
[[nodiscard]] std::vector<FieldNode> params_tree(const VisitFunction& visit);

}  // namespace viscera

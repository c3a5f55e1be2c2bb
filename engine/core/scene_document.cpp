#include "engine/core/scene_document.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "engine/core/json_text.h"

namespace viscera {
namespace {

using nlohmann::json;

constexpr std::string_view ref_key = "$ref";
constexpr std::string_view shared_prefix = "#/shared/";
constexpr std::size_t deepest = 128;
/// Few references to references multiply without end; no scene needs this much.
constexpr std::size_t budget = 2'000'000;

[[nodiscard]] std::optional<std::size_t> index_of(std::string_view token) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), index);
    const bool whole = error == std::errc{} && end == token.data() + token.size();
    return whole ? std::optional(index) : std::nullopt;
}

/// The member or element of a value that a pointer's token names, or null.
template <class Json>
[[nodiscard]] Json* child_of(Json& value, const std::string& token) {
    if (value.is_object()) {
        const auto found = value.find(token);
        return found == value.end() ? nullptr : &*found;
    }
    const std::optional<std::size_t> index = value.is_array() ? index_of(token) : std::nullopt;
    return index && *index < value.size() ? &value[*index] : nullptr;
}

/// Empty when done, else why not.
[[nodiscard]] std::string_view apply(json& document, const SceneOverride& change) {
    std::optional<std::vector<std::string>> tokens = pointer_tokens(change.pointer);
    if (!tokens || tokens->empty()) {
        return "not a pointer to a part of the scene";
    }
    const std::string last = std::move(tokens->back());
    tokens->pop_back();
    json* parent = &document;
    for (const std::string& token : *tokens) {
        parent = child_of(*parent, token);
        if (parent == nullptr) {
            return "cannot be set: what it would be part of does not exist";
        }
    }
    if (parent->is_object()) {
        (*parent)[last] = change.value;
        return {};
    }
    if (!parent->is_array()) {
        return "cannot be set: what it would be part of is neither an object nor a list";
    }
    const std::size_t index = last == "-" ? parent->size() : index_of(last).value_or(parent->size() + 1);
    if (index > parent->size()) {
        return "cannot be set: the list has no such element";
    }
    if (index == parent->size()) {
        parent->push_back(change.value);
    } else {
        (*parent)[index] = change.value;
    }
    return {};
}

}  // namespace

void apply_overrides(json& document, std::span<const SceneOverride> overrides,
                     std::vector<JsonFault>& faults) {
    for (const SceneOverride& change : overrides) {
        if (const std::string_view why_not = apply(document, change); !why_not.empty()) {
            faults.push_back({change.pointer, std::string(why_not)});
        }
    }
}

json References::expand(const json& value, const std::string& pointer) {
    if (!spend(value, pointer)) {
        return nullptr;
    }
    if (depth_ >= deepest) {
        faults_.push_back({pointer, "nested too deeply"});
        return nullptr;
    }
    ++depth_;
    json result =
        value.is_object() && value.contains(ref_key) ? expand_reference(value, pointer) : json(value.type());
    if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i) {
            result.push_back(expand(value[i], child_pointer(pointer, i)));
        }
    } else if (!value.is_object()) {
        result = value;
    } else if (result.is_object()) {
        for (const auto& [key, member] : value.items()) {
            if (key != ref_key) {
                result[key] = expand(member, child_pointer(pointer, key));
            }
        }
    }
    --depth_;
    return result;
}

/// What the `$ref` of an object stands for; an empty object where it stands for nothing.
json References::expand_reference(const json& value, const std::string& pointer) {
    const std::string here = child_pointer(pointer, ref_key);
    const json& written = value[std::string(ref_key)];
    if (!written.is_string() || !written.get_ref<const std::string&>().starts_with(shared_prefix)) {
        faults_.push_back({here, "expected \"#/shared/NAME\""});
        return json::object();
    }
    const std::string& reference = written.get_ref<const std::string&>();
    if (std::ranges::find(open_, reference) != open_.end()) {
        std::string chain;
        for (const std::string& name : open_) {
            chain += name + " -> ";
        }
        faults_.push_back({here, "refers to itself: " + chain + reference});
        return json::object();
    }
    const json* const target = find(reference, here);
    if (target == nullptr) {
        return json::object();
    }
    open_.push_back(reference);
    json result = expand(*target, pointer);
    open_.pop_back();
    const bool alone = value.size() == 1 || (value.size() == 2 && value.contains("comment"));
    if (!result.is_object() && !alone) {
        faults_.push_back({here, "keys stand beside it, but it names " + std::string(kind_name(result))});
    }
    return result;
}

const json* References::find(const std::string& reference, const std::string& pointer) {
    const std::optional<std::vector<std::string>> tokens =
        pointer_tokens(std::string_view(reference).substr(shared_prefix.size() - 1));
    const json* target = tokens ? &shared_ : nullptr;
    for (std::size_t i = 0; target != nullptr && i < tokens->size(); ++i) {
        target = child_of(*target, (*tokens)[i]);
    }
    if (target == nullptr) {
        std::vector<std::string> names;
        for (const auto& [name, part] : shared_.items()) {
            names.push_back(name);
        }
        const std::string word = tokens && !tokens->empty() ? tokens->front() : "";
        const std::string_view near = nearest_word(word, names);
        const std::string hint =
            near.empty() || near == word
                ? ""
                : "; did you mean " + quote(std::string(shared_prefix).append(near)) + "?";
        faults_.push_back({pointer, "nothing stands at " + quote(reference) + hint});
    }
    return target;
}

bool References::spend(const json& value, const std::string& pointer) {
    constexpr std::size_t characters_per_value = 64;
    const std::size_t before = spent_;
    if (spent_ <= budget) {
        spent_ += 1;
        if (value.is_string()) {
            spent_ += value.get_ref<const std::string&>().size() / characters_per_value;
        } else if (value.is_object()) {
            for (const auto& [key, member] : value.items()) {
                spent_ += key.size() / characters_per_value;
            }
        }
    }
    if (before <= budget && spent_ > budget) {
        faults_.push_back({pointer, "the references expand to too much"});
    }
    return spent_ <= budget;
}

}  // namespace viscera

#include "engine/core/params_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/core/json_text.h"

namespace viscera {
namespace {

using nlohmann::json;

/// Keys that every object may hold, for people's notes.
constexpr std::string_view comment_key = "comment";

[[nodiscard]] bool in_range(const FieldInfo& info, double value) {
    return value <= info.max && (info.min_excluded ? value > info.min : value >= info.min);
}

class Reader final : public ParamVisitor {
  public:
    Reader(const json& object, std::string_view pointer, const std::filesystem::path& base,
           std::span<const std::string_view> others, std::vector<JsonFault>& faults)
        : base_(base), faults_(faults) {
        levels_.push_back(open(&object, std::string(pointer)));
        levels_.back().known.assign(others.begin(), others.end());
    }

    /// Reports what nobody asked for in the innermost object, and leaves it.
    void finish() {
        const Level level = std::move(levels_.back());
        levels_.pop_back();
        if (level.object == nullptr) {
            return;
        }
        for (const auto& [key, value] : level.object->items()) {
            if (key == comment_key || std::ranges::find(level.known, key) != level.known.end()) {
                continue;
            }
            const std::string_view near = nearest_word(key, level.known);
            fault(child_pointer(level.pointer, key),
                  "unknown key" + (near.empty() ? "" : "; did you mean " + quote(near) + "?"));
        }
    }

    void field(const FieldInfo& info, bool& value) override {
        if (const auto source = find(info)) {
            if (source->value->is_boolean()) {
                value = source->value->get<bool>();
            } else {
                wrong_kind(*source, "true or false");
            }
        }
    }

    void field(const FieldInfo& info, int& value) override {
        const auto source = find(info);
        const std::optional<double> number =
            source ? number_of(info, *source, "a whole number") : std::nullopt;
        if (!number) {
            return;
        }
        if (*number != std::trunc(*number)) {
            fault(source->pointer, "expected a whole number, not " + number_text(*number));
        } else if (std::abs(*number) > std::numeric_limits<int>::max()) {
            fault(source->pointer, number_text(*number) + " is too large for a whole number");
        } else {
            value = static_cast<int>(*number);
        }
    }

    void field(const FieldInfo& info, double& value) override {
        const auto source = find(info);
        if (const auto number = source ? number_of(info, *source, "a number") : std::nullopt) {
            value = *number;
        }
    }

    void field(const FieldInfo& info, std::string& value) override {
        const auto source = find(info);
        if (const std::string* text = source ? string_of(*source, "a string") : nullptr) {
            value = *text;
        }
    }

    void field(const FieldInfo& info, glm::dvec2& value) override { vector(info, value); }
    void field(const FieldInfo& info, glm::dvec3& value) override { vector(info, value); }
    void field(const FieldInfo& info, glm::dvec4& value) override { vector(info, value); }

    void field(const FieldInfo& info, AssetPath& value) override {
        const auto source = find(info);
        const std::string* const text = source ? string_of(*source, "the path of a file") : nullptr;
        if (text == nullptr) {
            return;
        }
        if (text->find('\0') != std::string::npos) {
            fault(source->pointer, "a path cannot hold a zero byte");
            return;
        }
        if (info.required && text->empty()) {
            fault(source->pointer, "names no file");
            return;
        }
        const std::filesystem::path path(*text);
        value.path = path.empty() ? path : (base_ / path).lexically_normal();
    }

  protected:
    void choice(const FieldInfo& info, const ChoiceRef& value) override {
        const auto source = find(info);
        const std::string* const text = source ? string_of(*source, "a word") : nullptr;
        if (text == nullptr) {
            return;
        }
        const auto found = std::ranges::find(value.names, *text);
        if (found != value.names.end()) {
            value.set(static_cast<std::size_t>(found - value.names.begin()));
            return;
        }
        const std::vector<std::string> names(value.names.begin(), value.names.end());
        const std::string_view near = nearest_word(*text, names);
        std::string message = "unknown value " + quote(*text);
        if (!near.empty()) {
            message += "; did you mean " + quote(near) + "?";
        } else {
            message += "; expected one of";
            for (const std::string& name : names) {
                message += (name == names.front() ? " " : ", ") + quote(name);
            }
        }
        fault(source->pointer, message);
    }

    void begin_group(const FieldInfo& info) override {
        const std::size_t faults_before = faults_.size();
        const auto source = find(info);
        if (source) {
            levels_.push_back(open(source->value, source->pointer));
            return;
        }
        // An absent group is an empty one: what it must have is missing, unless its absence is already
        // reported.
        Level level{nullptr, child_pointer(levels_.back().pointer, info.name), {}, levels_.back().silent};
        level.silent = level.silent || faults_.size() > faults_before;
        levels_.push_back(std::move(level));
    }

    void end_group() override { finish(); }

    void list(const FieldInfo& info, const ListRef& value) override {
        const auto source = find(info);
        if (!source) {
            return;
        }
        if (!source->value->is_array()) {
            wrong_kind(*source, "a list");
            return;
        }
        // Fresh elements: what an element leaves out is its type's default, not what a default list held
        // there.
        value.resize(0);
        value.resize(source->value->size());
        FieldInfo item = info;
        item.required = false;
        for (std::size_t i = 0; i < source->value->size(); ++i) {
            item_ = Source{&(*source->value)[i], child_pointer(source->pointer, i)};
            value.visit(*this, i, item);
        }
    }

    void optional(const FieldInfo& info, const OptionalRef& value) override {
        auto source = find(info);
        if (!source) {
            return;
        }
        if (source->value->is_null()) {
            value.set(false);
            return;
        }
        const bool had = value.has();
        const std::size_t faults_before = faults_.size();
        value.set(true);
        item_ = std::move(source);
        value.visit(*this, info);
        if (!had && faults_.size() > faults_before) {
            value.set(false);
        }
    }

  private:
    struct Source {
        const json* value = nullptr;
        std::string pointer;
    };

    /// An object being read; null where it is absent or of the wrong kind.
    struct Level {
        const json* object = nullptr;
        std::string pointer;
        std::vector<std::string> known;
        bool silent = false;  ///< its absence is already reported, so that what it lacks is not
    };

    [[nodiscard]] Level open(const json* object, std::string pointer) {
        if (!object->is_object()) {
            fault(pointer, "expected an object, not " + std::string(kind_name(*object)));
            return {nullptr, std::move(pointer), {}, true};
        }
        return {object, std::move(pointer), {}, false};
    }

    void fault(std::string pointer, std::string message) {
        faults_.push_back({std::move(pointer), std::move(message)});
    }

    void wrong_kind(const Source& source, std::string_view expected) {
        fault(source.pointer,
              "expected " + std::string(expected) + ", not " + std::string(kind_name(*source.value)));
    }

    /// Where the next field stands: the element of a list at hand, or a member of the innermost object.
    [[nodiscard]] std::optional<Source> find(const FieldInfo& info) {
        if (item_) {
            return std::exchange(item_, std::nullopt);
        }
        Level& level = levels_.back();
        level.known.emplace_back(info.name);
        if (level.object != nullptr) {
            const auto found = level.object->find(level.known.back());
            if (found != level.object->end()) {
                return Source{&*found, child_pointer(level.pointer, info.name)};
            }
        }
        if (info.required && !level.silent) {
            fault(child_pointer(level.pointer, info.name), "missing");
        }
        return std::nullopt;
    }

    [[nodiscard]] std::optional<double> number_of(const FieldInfo& info, const Source& source,
                                                  std::string_view expected) {
        if (!source.value->is_number()) {
            wrong_kind(source, expected);
            return std::nullopt;
        }
        const double number = source.value->get<double>();
        if (!std::isfinite(number)) {
            fault(source.pointer, "the number is not finite");
            return std::nullopt;
        }
        if (!in_range(info, number)) {
            fault(source.pointer, range_words(info) + ", is " + number_text(number));
            return std::nullopt;
        }
        return number;
    }

    [[nodiscard]] const std::string* string_of(const Source& source, std::string_view expected) {
        if (!source.value->is_string()) {
            wrong_kind(source, expected);
            return nullptr;
        }
        return source.value->get_ptr<const std::string*>();
    }

    template <int N>
    void vector(const FieldInfo& info, glm::vec<N, double>& value) {
        const auto source = find(info);
        if (!source) {
            return;
        }
        const std::string expected = "a list of " + std::to_string(N) + " numbers";
        if (!source->value->is_array()) {
            wrong_kind(*source, expected);
            return;
        }
        if (source->value->size() != N) {
            fault(source->pointer,
                  "expected " + expected + ", not of " + std::to_string(source->value->size()));
            return;
        }
        glm::vec<N, double> read = value;
        bool good = true;
        for (int i = 0; i < N; ++i) {
            const auto index = static_cast<std::size_t>(i);
            const auto number = number_of(
                info, Source{&(*source->value)[index], child_pointer(source->pointer, index)}, "a number");
            good = good && number.has_value();
            read[i] = number.value_or(0.0);
        }
        value = good ? read : value;
    }

    const std::filesystem::path& base_;
    std::vector<JsonFault>& faults_;
    std::vector<Level> levels_;
    std::optional<Source> item_;
};

}  // namespace

std::string range_words(const FieldInfo& info) {
    const std::string unit = info.unit.empty() ? "" : " " + std::string(info.unit);
    const std::string low = number_text(info.min);
    const std::string high = number_text(info.max) + unit;
    if (info.min == info.max) {
        return "must be " + high;
    }
    const std::string above = std::string("must be ") + (info.min_excluded ? "above " : "at least ") + low;
    if (std::isinf(info.max)) {
        return above + unit;
    }
    return std::isinf(info.min) ? "must be at most " + high : above + " and at most " + high;
}

void read_params_beside(const json& object, std::string_view pointer, const std::filesystem::path& base,
                        const VisitFunction& visit, std::span<const std::string_view> others,
                        std::vector<JsonFault>& faults) {
    Reader reader(object, pointer, base, others, faults);
    visit(reader);
    reader.finish();
}

void read_params(const json& object, std::string_view pointer, const std::filesystem::path& base,
                 const VisitFunction& visit, std::vector<JsonFault>& faults) {
    read_params_beside(object, pointer, base, visit, {}, faults);
}

}  // namespace viscera

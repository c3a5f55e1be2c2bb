#pragma once

#include <concepts>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace viscera {

/// What is known of a parameter besides its value: enough for reading, writing, the schema and the option
/// tables.
struct FieldInfo {
    std::string_view name;  ///< JSON key, with its unit: "radius_mm"
    std::string_view doc;   ///< one sentence
    std::string_view unit = "";
    double min = -std::numeric_limits<double>::infinity();  ///< allowed, for every component
    double max = std::numeric_limits<double>::infinity();   ///< allowed, for every component
    bool min_excluded = false;                              ///< the minimum itself is not allowed
    bool required = false;                                  ///< a reader faults when the key is missing
};

/// A file that a parameter names. Kept as text until an effect that lives asks for it, so that unused files
/// are never opened. `path` is absolute or relative to the working directory once a scene has been read.
struct AssetPath {
    std::filesystem::path path;
    [[nodiscard]] bool empty() const { return path.empty(); }
    bool operator==(const AssetPath&) const = default;
};

/// An enumeration seen as its names: index into `names`.
struct ChoiceRef {
    std::span<const std::string_view> names;
    std::function<std::size_t()> get;
    std::function<void(std::size_t)> set;
};

class ParamVisitor;

/// A list of values or structs seen without its type.
struct ListRef {
    std::function<std::size_t()> size;
    std::function<void(std::size_t)> resize;
    std::function<void(ParamVisitor&, std::size_t index, const FieldInfo&)> visit;
};

/// A struct that may be absent.
struct OptionalRef {
    std::function<bool()> has;
    std::function<void(bool)> set;
    std::function<void(ParamVisitor&, const FieldInfo&)> visit;
};

template <class T>
concept VisitedStruct = requires(T value, ParamVisitor& visitor) {
    value.visit(visitor);
};

/// An enumeration takes part by a free function found by argument-dependent lookup:
/// `std::span<const std::string_view> choice_names(E)`, names in the order of the enumerators 0, 1, 2, ...
template <class E>
concept NamedChoice = std::is_enum_v<E> && requires(E value) {
    { choice_names(value) } -> std::convertible_to<std::span<const std::string_view>>;
};

/// Walks over a parameter struct. A struct has `void visit(ParamVisitor& v)` that calls `v.field(info,
/// member)` for each member; readers fill the members, writers and documenters look at them.
class ParamVisitor {
  public:
    virtual ~ParamVisitor() = default;

    virtual void field(const FieldInfo& info, bool& value) = 0;
    virtual void field(const FieldInfo& info, int& value) = 0;
    virtual void field(const FieldInfo& info, double& value) = 0;
    virtual void field(const FieldInfo& info, std::string& value) = 0;
    virtual void field(const FieldInfo& info, glm::dvec2& value) = 0;
    virtual void field(const FieldInfo& info, glm::dvec3& value) = 0;
    virtual void field(const FieldInfo& info, glm::dvec4& value) = 0;
    virtual void field(const FieldInfo& info, AssetPath& value) = 0;

    template <NamedChoice E>
    void field(const FieldInfo& info, E& value) {
        choice(info, ChoiceRef{choice_names(value), [&value] { return static_cast<std::size_t>(value); },
                               [&value](std::size_t index) { value = static_cast<E>(index); }});
    }

    template <VisitedStruct S>
    void field(const FieldInfo& info, S& value) {
        begin_group(info);
        value.visit(*this);
        end_group();
    }

    template <class T>
    void field(const FieldInfo& info, std::vector<T>& values) {
        list(info,
             ListRef{[&values] { return values.size(); }, [&values](std::size_t n) { values.resize(n); },
                     [&values](ParamVisitor& v, std::size_t i, const FieldInfo& item) {
                         v.field(item, values[i]);
                     }});
    }

    template <class T>
    void field(const FieldInfo& info, std::optional<T>& value) {
        optional(info,
                 OptionalRef{[&value] { return value.has_value(); },
                             [&value](bool present) {
                                 if (present != value.has_value()) {
                                     value = present ? std::optional<T>(T{}) : std::nullopt;
                                 }
                             },
                             [&value](ParamVisitor& v, const FieldInfo& item) { v.field(item, *value); }});
    }

  protected:
    virtual void choice(const FieldInfo& info, const ChoiceRef& value) = 0;
    virtual void begin_group(const FieldInfo& info) = 0;
    virtual void end_group() = 0;
    virtual void list(const FieldInfo& info, const ListRef& value) = 0;
    virtual void optional(const FieldInfo& info, const OptionalRef& value) = 0;
};

}  // namespace viscera

#include "engine/core/params_json.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

namespace viscera {
namespace {

using nlohmann::json;

class Writer final : public ParamVisitor {
  public:
    explicit Writer(json& root) : open_{&root} {}

    void field(const FieldInfo& info, bool& value) override { place(info) = value; }
    void field(const FieldInfo& info, int& value) override { place(info) = value; }
    void field(const FieldInfo& info, double& value) override { place(info) = value; }
    void field(const FieldInfo& info, std::string& value) override { place(info) = value; }
    void field(const FieldInfo& info, glm::dvec2& value) override { place(info) = {value.x, value.y}; }
    void field(const FieldInfo& info, glm::dvec3& value) override {
        place(info) = {value.x, value.y, value.z};
    }
    void field(const FieldInfo& info, glm::dvec4& value) override {
        place(info) = {value.x, value.y, value.z, value.w};
    }
    void field(const FieldInfo& info, AssetPath& value) override {
        place(info) = value.path.generic_string();
    }

  protected:
    void choice(const FieldInfo& info, const ChoiceRef& value) override {
        const std::size_t index = value.get();
        place(info) = index < value.names.size() ? std::string(value.names[index]) : std::string();
    }

    void begin_group(const FieldInfo& info) override {
        json& group = place(info);
        group = json::object();
        open_.push_back(&group);
    }

    void end_group() override { open_.pop_back(); }

    void list(const FieldInfo& info, const ListRef& value) override {
        json& items = place(info);
        items = json::array();
        items.get_ref<json::array_t&>().resize(value.size());
        for (std::size_t i = 0; i < items.size(); ++i) {
            item_ = &items[i];
            value.visit(*this, i, info);
        }
    }

    void optional(const FieldInfo& info, const OptionalRef& value) override {
        json& written = place(info);
        written = nullptr;
        if (value.has()) {
            item_ = &written;
            value.visit(*this, info);
        }
    }

  private:
    [[nodiscard]] json& place(const FieldInfo& info) {
        return item_ != nullptr ? *std::exchange(item_, nullptr) : (*open_.back())[std::string(info.name)];
    }

    std::vector<json*> open_;
    json* item_ = nullptr;
};

/// Lower case, and '-' as '_': spellings that people mix up.
[[nodiscard]] std::string plain(std::string_view word) {
    std::string text(word);
    for (char& c : text) {
        c = c == '-' || c == ' ' ? '_' : c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return text;
}

/// Edit distance in which swapping two neighbours counts once (optimal string alignment).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before_last(b.size() + 1);
    std::vector<std::size_t> last(b.size() + 1);
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) {
        last[j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], before_last[j - 2] + 1);
            }
        }
        std::swap(before_last, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

}  // namespace

json write_params(const VisitFunction& visit) {
    json root = json::object();
    Writer writer(root);
    visit(writer);
    return root;
}

std::string_view nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
    constexpr std::size_t longest = 128;
    if (word.size() > longest) {
        return {};
    }
    const std::string wanted = plain(word);
    std::string_view nearest;
    std::size_t least = longest;
    for (const std::string& candidate : candidates) {
        const std::string known = plain(candidate);
        if (known.size() > longest || wanted.empty()) {
            continue;
        }
        // A forgotten unit is near, however long the unit: "radius" for "radius_mm".
        const bool without_unit = known.starts_with(wanted + "_");
        const std::size_t distance = without_unit ? 1 : edit_distance(wanted, known);
        if (distance <= std::max<std::size_t>(1, known.size() / 3) && distance < known.size() &&
            distance < least) {
            least = distance;
            nearest = candidate;
        }
    }
    return nearest;
}

}  // namespace viscera

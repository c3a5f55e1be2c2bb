#include "engine/core/params_tree.h"

#include <deque>
#include <utility>

namespace viscera {
namespace {

using nlohmann::json;

class TreeBuilder final : public ParamVisitor {
  public:
    [[nodiscard]] std::vector<FieldNode> build(const VisitFunction& visit) {
        std::vector<FieldNode> fields;
        std::vector<FieldNode>* const outer = std::exchange(fields_, &fields);
        visit(*this);
        fields_ = outer;
        return fields;
    }

    void field(const FieldInfo& info, bool& value) override { leaf(info, value, FieldKind::boolean); }
    void field(const FieldInfo& info, int& value) override { leaf(info, value, FieldKind::integer); }
    void field(const FieldInfo& info, double& value) override { leaf(info, value, FieldKind::number); }
    void field(const FieldInfo& info, std::string& value) override { leaf(info, value, FieldKind::text); }
    void field(const FieldInfo& info, glm::dvec2& value) override { leaf(info, value, FieldKind::vector, 2); }
    void field(const FieldInfo& info, glm::dvec3& value) override { leaf(info, value, FieldKind::vector, 3); }
    void field(const FieldInfo& info, glm::dvec4& value) override { leaf(info, value, FieldKind::vector, 4); }
    void field(const FieldInfo& info, AssetPath& value) override { leaf(info, value, FieldKind::path); }

  protected:
    void choice(const FieldInfo& info, const ChoiceRef& value) override {
        const std::size_t index = value.get();
        FieldNode& node = add(info, FieldKind::choice);
        node.choices.assign(value.names.begin(), value.names.end());
        node.value = index < node.choices.size() ? json(node.choices[index]) : json();
    }

    void begin_group(const FieldInfo& info) override {
        (void)add(info, FieldKind::group);
        groups_.push_back({std::exchange(fields_, nullptr), {}});
        fields_ = &groups_.back().children;
    }

    void end_group() override {
        Group group = std::move(groups_.back());
        groups_.pop_back();
        fields_ = group.outer;
        fields_->back().children = std::move(group.children);
    }

    void list(const FieldInfo& info, const ListRef& value) override {
        json items = json::array();
        for (std::size_t i = 0; i < value.size(); ++i) {
            items.push_back(written(info, [&](ParamVisitor& v) { value.visit(v, i, info); }));
        }
        const std::size_t size = value.size();
        value.resize(size + 1);
        std::vector<FieldNode> element = build([&](ParamVisitor& v) { value.visit(v, size, info); });
        value.resize(size);
        FieldNode& node = add(info, FieldKind::list);
        node.value = std::move(items);
        node.children = std::move(element);
    }

    void optional(const FieldInfo& info, const OptionalRef& value) override {
        const bool had = value.has();
        value.set(true);
        const auto visit = [&](ParamVisitor& v) { value.visit(v, info); };
        json content = had ? written(info, visit) : json();
        std::vector<FieldNode> held = build(visit);
        value.set(had);
        FieldNode& node = add(info, FieldKind::optional);
        node.value = std::move(content);
        node.children = std::move(held);
    }

  private:
    struct Group {
        std::vector<FieldNode>* outer = nullptr;
        std::vector<FieldNode> children;
    };

    [[nodiscard]] static json written(const FieldInfo& info, const VisitFunction& visit) {
        return write_params(visit)[std::string(info.name)];
    }

    FieldNode& add(const FieldInfo& info, FieldKind kind) {
        FieldNode node;
        node.info = info;
        node.kind = kind;
        return fields_->emplace_back(std::move(node));
    }

    template <class T>
    void leaf(const FieldInfo& info, T& value, FieldKind kind, int components = 1) {
        json content = written(info, [&](ParamVisitor& v) { v.field(info, value); });
        FieldNode& node = add(info, kind);
        node.components = components;
        node.value = std::move(content);
    }

    std::vector<FieldNode>* fields_ = nullptr;
    std::deque<Group> groups_;  // whose elements stay in place, as fields_ points into them
};

}  // namespace

std::vector<FieldNode> params_tree(const VisitFunction& visit) {
    return TreeBuilder().build(visit);
}

}  // namespace viscera

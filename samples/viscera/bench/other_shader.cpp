#include "samples/viscera/bench/other_shader.h"

#include "effects/organ/surface_effect.h"
#include "effects/volume/ray_cast_effect.h"

namespace viscera::app {
namespace {

template <class Measured>
class OtherShader final : public Effect {
  public:
    explicit OtherShader(std::string name) : name_(std::move(name)) {}

    void visit(ParamVisitor& visitor) override { effect_.visit(visitor); }
    void validate() const override { effect_.validate(); }
    std::vector<Port> ports() const override { return effect_.ports(); }
    std::span<const ProgramDesc> programs() const override {
        const std::span<const ProgramDesc> own = effect_.programs();
        programs_.assign(own.begin(), own.end());
        for (ProgramDesc& program : programs_) {
            std::string& file = program.compute.empty() ? program.fragment : program.compute;
            file = "bench/" + name_ + (program.compute.empty() ? ".frag" : ".comp");
        }
        return programs_;
    }
    Work prepare(Prepare& prepare) override { return effect_.prepare(prepare); }
    void draw(const Pass& pass) override { effect_.draw(pass); }

  private:
    std::string name_;
    Measured effect_;
    mutable std::vector<ProgramDesc> programs_;
};

template <class Measured>
void add(Registry& registry, const std::string& name) {
    registry.add("bench." + name, "Measured by the bench.",
                 [name] { return std::make_unique<OtherShader<Measured>>(name); });
}

}  // namespace

void register_other_shaders(Registry& registry) {
    add<volume::RayCastEffect>(registry, "ray_ceiling");
    add<volume::RayCastEffect>(registry, "ray_count");
    add<organ::SurfaceEffect>(registry, "organ_ceiling");
}

}  // namespace viscera::app

#include "samples/viscera/bench/volume_pass.h"

#include "effects/volume/ray_cast_effect.h"

namespace viscera::app {
namespace {

class OtherRayShader final : public Effect {
  public:
    explicit OtherRayShader(std::string name) : name_(std::move(name)) {}

    void visit(ParamVisitor& visitor) override { caster_.visit(visitor); }
    void validate() const override { caster_.validate(); }
    std::vector<Port> ports() const override { return caster_.ports(); }
    std::span<const ProgramDesc> programs() const override {
        const std::span<const ProgramDesc> own = caster_.programs();
        programs_.assign(own.begin(), own.end());
        for (ProgramDesc& program : programs_) {
            std::string& file = program.compute.empty() ? program.fragment : program.compute;
            file = "bench/" + name_ + (program.compute.empty() ? ".frag" : ".comp");
        }
        return programs_;
    }
    Work prepare(Prepare& prepare) override { return caster_.prepare(prepare); }
    void draw(const Pass& pass) override { caster_.draw(pass); }

  private:
    std::string name_;
    volume::RayCastEffect caster_;
    mutable std::vector<ProgramDesc> programs_;
};

}  // namespace

void register_volume_passes(Registry& registry) {
    for (const std::string name : {"ray_ceiling", "ray_count"}) {
        registry.add("bench." + name, "Measured by the bench.",
                     [name] { return std::make_unique<OtherRayShader>(name); });
    }
}

}  // namespace viscera::app

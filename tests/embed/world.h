#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine/core/image.h"
#include "engine/core/scene.h"
#include "engine/runtime/renderer.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {

/// A vessel, smoke and a background of a few pixels each, and scenes over them that use every effect.
class World {
  public:
    World();

    /// Every registered effect, each drawn at time_s.
    [[nodiscard]] Scene everything() const;
    /// A vessel over a background: few passes, one output "final".
    [[nodiscard]] Scene small() const;
    [[nodiscard]] Scene parse(const std::string& text) const;
    [[nodiscard]] const TempFolder& folder() const { return folder_; }

    /// Densities for `everything`'s "host_density" and one emitter for "host_emitters".
    [[nodiscard]] HostValues values(float density = 0.75F) const;

    static constexpr double time_s = 0.6;

  private:
    TempFolder folder_;
    std::size_t vertices_ = 0;
};

/// Effects as the app knows them.
[[nodiscard]] Registry all_effects();

/// Every output of the last frame, by name.
[[nodiscard]] std::map<std::string, Image> pictures(Renderer& renderer);

/// Names of the targets in which two sets of pictures differ in any bit.
[[nodiscard]] std::vector<std::string> differing(const std::map<std::string, Image>& a,
                                                 const std::map<std::string, Image>& b);

}  // namespace viscera::test

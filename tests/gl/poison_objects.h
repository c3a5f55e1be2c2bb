#pragma once

#include "engine/gl/host_state_rows.h"

namespace viscera::test {

/// Objects for poisoning, as a host might have them; deleted at the end of the scope. Leaves bindings as they
/// come.
class ScopedPoison {
  public:
    explicit ScopedPoison(const gl::Functions& gl);
    ~ScopedPoison();
    ScopedPoison(const ScopedPoison&) = delete;
    ScopedPoison& operator=(const ScopedPoison&) = delete;

    [[nodiscard]] const gl::PoisonObjects& objects() const { return objects_; }

  private:
    const gl::Functions& gl_;
    gl::PoisonObjects objects_;
};

}  // namespace viscera::test

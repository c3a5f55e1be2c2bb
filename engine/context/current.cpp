#include "engine/context/context_info.h"
#include "engine/context/current_slot.h"
#include "engine/core/error.h"

namespace viscera {

namespace {

/// The caller's context. It is bound again where EGL, GLX or OSMesa said what was current, and never
/// destroyed.
class CallersContext final : public Context {
  public:
    explicit CallersContext(ProcAddress proc) : proc_(proc), slot_(CurrentSlot::capture()) {
        info_ = read_context_info(Backend::current, proc);
    }
    void make_current() override {
        if (slot_.empty()) {
            return;  // made by a library that viscera does not know: only the caller can bind it
        }
        CurrentSlot::release();
        if (!slot_.bind()) {
            throw Error(ErrorCode::context, "current", "the caller's context cannot be made current again");
        }
    }
    void release() override {
        if (CurrentSlot::capture() == slot_) {
            CurrentSlot::release();
        }
    }
    [[nodiscard]] ProcAddress proc_address() const override { return proc_; }

  private:
    ProcAddress proc_;
    CurrentSlot slot_;
};

}  // namespace

std::unique_ptr<Context> wrap_current_context(ProcAddress proc) {
    return std::make_unique<CallersContext>(proc);
}

}  // namespace viscera

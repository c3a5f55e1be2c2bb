#include <GL/osmesa.h>

#include <array>

#include "engine/context/backends.h"
#include "engine/context/context_info.h"
#include "engine/context/current_slot.h"
#include "engine/context/shared_library.h"
#include "engine/core/error.h"

namespace viscera {

namespace {

constexpr auto osmesa = "osmesa";

struct OsmesaApi {
    decltype(&OSMesaCreateContextAttribs) create_context = nullptr;
    decltype(&OSMesaDestroyContext) destroy_context = nullptr;
    decltype(&OSMesaMakeCurrent) make_current = nullptr;
    decltype(&OSMesaGetCurrentContext) get_current_context = nullptr;
    decltype(&OSMesaGetProcAddress) get_proc_address = nullptr;

    static OsmesaApi load() {
        const auto library = SharedLibrary::open(
            osmesa, {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"},
            "install the Debian package libosmesa6 (Mesa has none from 25.1 on: use EGL)");
        OsmesaApi api;
        library.require(osmesa, "OSMesaCreateContextAttribs", api.create_context);
        library.require(osmesa, "OSMesaDestroyContext", api.destroy_context);
        library.require(osmesa, "OSMesaMakeCurrent", api.make_current);
        library.require(osmesa, "OSMesaGetCurrentContext", api.get_current_context);
        library.require(osmesa, "OSMesaGetProcAddress", api.get_proc_address);
        return api;
    }
};

/// A context of Mesa's off-screen library. Its framebuffer 0 is a small buffer that nothing looks at.
class OsmesaContext final : public Context {
  public:
    explicit OsmesaContext(const OsmesaApi& api) : api_(api) {
        constexpr std::array<int, 15> attributes{OSMESA_FORMAT,
                                                 OSMESA_RGBA,
                                                 OSMESA_DEPTH_BITS,
                                                 0,
                                                 OSMESA_STENCIL_BITS,
                                                 0,
                                                 OSMESA_ACCUM_BITS,
                                                 0,
                                                 OSMESA_PROFILE,
                                                 OSMESA_CORE_PROFILE,
                                                 OSMESA_CONTEXT_MAJOR_VERSION,
                                                 3,
                                                 OSMESA_CONTEXT_MINOR_VERSION,
                                                 3,
                                                 0};
        context_ = api_.create_context(attributes.data(), nullptr);
        if (context_ == nullptr) {
            throw Error(ErrorCode::context, osmesa,
                        "no OpenGL 3.3 core context: OSMesaCreateContextAttribs failed");
        }
        try {
            make_current();
            info_ = read_context_info(Backend::osmesa, proc_address());
        } catch (...) {
            destroy();
            throw;
        }
    }
    ~OsmesaContext() override { destroy(); }

    void make_current() override {
        CurrentSlot::release();
        if (api_.make_current(context_, buffer_.data(), GL_UNSIGNED_BYTE, side, side) != GL_TRUE) {
            throw Error(ErrorCode::context, osmesa, "OSMesaMakeCurrent failed");
        }
    }
    void release() override {
        if (api_.get_current_context() == context_) {
            api_.make_current(nullptr, nullptr, 0, 0, 0);
        }
    }
    [[nodiscard]] ProcAddress proc_address() const override {
        return reinterpret_cast<ProcAddress>(api_.get_proc_address);
    }

  private:
    void destroy() noexcept {
        if (api_.get_current_context() == context_) {
            api_.make_current(nullptr, nullptr, 0, 0, 0);
        }
        api_.destroy_context(context_);
    }

    static constexpr int side = 16;  ///< of the buffer [pixels]
    OsmesaApi api_;
    OSMesaContext context_ = nullptr;
    std::array<unsigned char, std::size_t{4} * side * side> buffer_{};
};

}  // namespace

std::unique_ptr<Context> create_osmesa(const ContextOptions& options) {
    auto context = std::make_unique<OsmesaContext>(OsmesaApi::load());
    check_hardware(context->info(), options);
    return context;
}

}  // namespace viscera

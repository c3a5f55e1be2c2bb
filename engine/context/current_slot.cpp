#include "engine/context/current_slot.h"

#define EGL_NO_X11  // keeps X11's macros out
#include <EGL/egl.h>
#include <GL/osmesa.h>

#include "engine/context/shared_library.h"

namespace viscera {

namespace {

struct Egl {
    decltype(&eglGetCurrentContext) get_context;
    decltype(&eglGetCurrentDisplay) get_display;
    decltype(&eglGetCurrentSurface) get_surface;
    decltype(&eglMakeCurrent) make_current;
};

struct Glx {
    void* (*get_context)();
    void* (*get_display)();
    unsigned long (*get_drawable)();
    unsigned long (*get_read_drawable)();
    int (*make_current)(void* display, unsigned long draw, unsigned long read, void* context);
};

struct Osmesa {
    decltype(&OSMesaGetCurrentContext) get_context;
    decltype(&OSMesaGetColorBuffer) get_buffer;
    decltype(&OSMesaGetIntegerv) get_integer;
    decltype(&OSMesaMakeCurrent) make_current;
};

std::optional<Egl> loaded_egl() {
    const auto library = SharedLibrary::find_loaded({"libEGL.so.1"});
    if (!library) {
        return std::nullopt;
    }
    Egl egl{library->find<decltype(Egl::get_context)>("eglGetCurrentContext"),
            library->find<decltype(Egl::get_display)>("eglGetCurrentDisplay"),
            library->find<decltype(Egl::get_surface)>("eglGetCurrentSurface"),
            library->find<decltype(Egl::make_current)>("eglMakeCurrent")};
    return egl.get_context && egl.get_display && egl.get_surface && egl.make_current ? std::optional(egl)
                                                                                     : std::nullopt;
}

std::optional<Glx> loaded_glx() {
    const auto library = SharedLibrary::find_loaded({"libGLX.so.0", "libGL.so.1"});
    if (!library) {
        return std::nullopt;
    }
    Glx glx{library->find<decltype(Glx::get_context)>("glXGetCurrentContext"),
            library->find<decltype(Glx::get_display)>("glXGetCurrentDisplay"),
            library->find<decltype(Glx::get_drawable)>("glXGetCurrentDrawable"),
            library->find<decltype(Glx::get_read_drawable)>("glXGetCurrentReadDrawable"),
            library->find<decltype(Glx::make_current)>("glXMakeContextCurrent")};
    return glx.get_context && glx.get_display && glx.get_drawable && glx.get_read_drawable && glx.make_current
               ? std::optional(glx)
               : std::nullopt;
}

std::optional<Osmesa> loaded_osmesa() {
    const auto library = SharedLibrary::find_loaded({"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"});
    if (!library) {
        return std::nullopt;
    }
    Osmesa osmesa{library->find<decltype(Osmesa::get_context)>("OSMesaGetCurrentContext"),
                  library->find<decltype(Osmesa::get_buffer)>("OSMesaGetColorBuffer"),
                  library->find<decltype(Osmesa::get_integer)>("OSMesaGetIntegerv"),
                  library->find<decltype(Osmesa::make_current)>("OSMesaMakeCurrent")};
    return osmesa.get_context && osmesa.get_buffer && osmesa.get_integer && osmesa.make_current
               ? std::optional(osmesa)
               : std::nullopt;
}

}  // namespace

CurrentSlot CurrentSlot::capture() {
    CurrentSlot slot;
    if (const auto egl = loaded_egl(); egl && egl->get_context() != EGL_NO_CONTEXT) {
        slot.kind_ = Kind::egl;
        slot.context_ = egl->get_context();
        slot.display_ = egl->get_display();
        slot.egl_draw_ = egl->get_surface(EGL_DRAW);
        slot.egl_read_ = egl->get_surface(EGL_READ);
        return slot;
    }
    if (const auto glx = loaded_glx(); glx && glx->get_context() != nullptr) {
        slot.kind_ = Kind::glx;
        slot.context_ = glx->get_context();
        slot.display_ = glx->get_display();
        slot.glx_draw_ = glx->get_drawable();
        slot.glx_read_ = glx->get_read_drawable();
        return slot;
    }
    // OSMesa is asked last: it takes another Mesa library's context in the shared slot for its own.
    if (const auto osmesa = loaded_osmesa(); osmesa && osmesa->get_context() != nullptr) {
        slot.kind_ = Kind::osmesa;
        const OSMesaContext context = osmesa->get_context();
        slot.context_ = context;
        GLint format = 0;
        osmesa->get_buffer(context, &slot.osmesa_width_, &slot.osmesa_height_, &format, &slot.osmesa_buffer_);
        osmesa->get_integer(OSMESA_TYPE, &slot.osmesa_type_);
    }
    return slot;
}

void CurrentSlot::release() {
    if (const auto egl = loaded_egl(); egl && egl->get_context() != EGL_NO_CONTEXT) {
        egl->make_current(egl->get_display(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    if (const auto glx = loaded_glx(); glx && glx->get_context() != nullptr) {
        glx->make_current(glx->get_display(), 0, 0, nullptr);
    }
    if (const auto osmesa = loaded_osmesa(); osmesa && osmesa->get_context() != nullptr) {
        osmesa->make_current(nullptr, nullptr, 0, 0, 0);
    }
}

bool CurrentSlot::bind() const {
    switch (kind_) {
        case Kind::none:
            return false;
        case Kind::egl: {
            const auto egl = loaded_egl();
            return egl && egl->make_current(display_, egl_draw_, egl_read_, context_) == EGL_TRUE;
        }
        case Kind::glx: {
            const auto glx = loaded_glx();
            return glx && glx->make_current(display_, glx_draw_, glx_read_, context_) != 0;
        }
        case Kind::osmesa: {
            const auto osmesa = loaded_osmesa();
            return osmesa && osmesa->make_current(static_cast<OSMesaContext>(context_), osmesa_buffer_,
                                                  static_cast<GLenum>(osmesa_type_), osmesa_width_,
                                                  osmesa_height_) == GL_TRUE;
        }
    }
    return false;
}

}  // namespace viscera

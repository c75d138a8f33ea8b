/* EGL over OSMesa, as much as piglit's programs ask for: every window, pbuffer or nothing is a picture in memory.
 *
 * Built twice: with -DAS_GL as libGL.so.1, which has the GLX names that piglit's library is linked to (all say that
 * there is no GLX), and without as libEGL.so.1. Both are linked to libOSMesa.so.8, where gl* are found.
 */
#define _GNU_SOURCE
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#ifdef AS_GL

#define NONE(name) void *name(void); void *name(void) { return NULL; }
NONE(glXChooseFBConfig)
NONE(glXChooseVisual)
NONE(glXCreateContext)
NONE(glXCreateNewContext)
NONE(glXCreatePixmap)
NONE(glXDestroyContext)
NONE(glXGetCurrentDisplay)
NONE(glXGetCurrentDrawable)
NONE(glXGetFBConfigAttrib)
NONE(glXGetFBConfigs)
NONE(glXGetVisualFromFBConfig)
NONE(glXMakeCurrent)
NONE(glXQueryExtension)
NONE(glXQueryExtensionsString)
NONE(glXQueryVersion)
NONE(glXSwapBuffers)

/* Before a context is made, gl* are looked for here. */
OSMESAproc glXGetProcAddress(const unsigned char *name) { return OSMesaGetProcAddress((const char *)name); }
OSMESAproc glXGetProcAddressARB(const unsigned char *name) { return OSMesaGetProcAddress((const char *)name); }

#else

struct surface {
    EGLint width, height;
    void *pixels;
};

static EGLDisplay the_display = (EGLDisplay)1;
static EGLConfig the_config = (EGLConfig)1;
static void *x_display;
static _Thread_local EGLint error = EGL_SUCCESS;
static _Thread_local EGLContext current;
static _Thread_local struct surface *current_surface;

static EGLBoolean fails(EGLint code)
{
    error = code;
    return EGL_FALSE;
}

EGLint eglGetError(void)
{
    EGLint was = error;
    error = EGL_SUCCESS;
    return was;
}

EGLDisplay eglGetDisplay(EGLNativeDisplayType native)
{
    x_display = (void *)native;
    return the_display;
}

EGLDisplay eglGetPlatformDisplay(EGLenum platform, void *native, const EGLAttrib *list)
{
    (void)list;
    x_display = platform == EGL_PLATFORM_X11_KHR ? native : NULL;
    return the_display;
}

EGLDisplay eglGetPlatformDisplayEXT(EGLenum platform, void *native, const EGLint *list)
{
    (void)list;
    return eglGetPlatformDisplay(platform, native, NULL);
}

EGLBoolean eglInitialize(EGLDisplay display, EGLint *major, EGLint *minor)
{
    (void)display;
    if (major)
        *major = 1;
    if (minor)
        *minor = 4;
    return EGL_TRUE;
}

EGLBoolean eglTerminate(EGLDisplay display) { (void)display; return EGL_TRUE; }
EGLenum eglQueryAPI(void) { return EGL_OPENGL_API; }

EGLBoolean eglBindAPI(EGLenum api)
{
    return api == EGL_OPENGL_API ? EGL_TRUE : fails(EGL_BAD_PARAMETER);
}

const char *eglQueryString(EGLDisplay display, EGLint name)
{
    if (name == EGL_EXTENSIONS && display == EGL_NO_DISPLAY)
        return "EGL_EXT_client_extensions EGL_EXT_platform_base EGL_EXT_platform_x11 EGL_MESA_platform_surfaceless";
    switch (name) {
    case EGL_VENDOR: return "EGL over OSMesa";
    case EGL_VERSION: return "1.4";
    case EGL_CLIENT_APIS: return "OpenGL";
    case EGL_EXTENSIONS: return "EGL_KHR_create_context EGL_KHR_surfaceless_context";
    }
    fails(EGL_BAD_PARAMETER);
    return NULL;
}

/* The visual of the screen's root, when there is a screen; Xlib is in the process then. */
static EGLint visual(void)
{
    int (*screen)(void *) = (int (*)(void *))dlsym(RTLD_DEFAULT, "XDefaultScreen");
    void *(*of)(void *, int) = (void *(*)(void *, int))dlsym(RTLD_DEFAULT, "XDefaultVisual");
    unsigned long (*id)(void *) = (unsigned long (*)(void *))dlsym(RTLD_DEFAULT, "XVisualIDFromVisual");
    return x_display && screen && of && id ? (EGLint)id(of(x_display, screen(x_display))) : 0;
}

static EGLint attribute(EGLint name)
{
    switch (name) {
    case EGL_RED_SIZE:
    case EGL_GREEN_SIZE:
    case EGL_BLUE_SIZE:
    case EGL_ALPHA_SIZE:
    case EGL_STENCIL_SIZE: return 8;
    case EGL_DEPTH_SIZE: return 24;
    case EGL_BUFFER_SIZE: return 32;
    case EGL_SURFACE_TYPE: return EGL_WINDOW_BIT | EGL_PBUFFER_BIT;
    case EGL_RENDERABLE_TYPE:
    case EGL_CONFORMANT: return EGL_OPENGL_BIT;
    case EGL_COLOR_BUFFER_TYPE: return EGL_RGB_BUFFER;
    case EGL_CONFIG_CAVEAT:
    case EGL_TRANSPARENT_TYPE: return EGL_NONE;
    case EGL_CONFIG_ID: return 1;
    case EGL_NATIVE_VISUAL_ID: return visual();
    case EGL_MAX_PBUFFER_WIDTH:
    case EGL_MAX_PBUFFER_HEIGHT: return 8192;
    }
    return 0;
}

EGLBoolean eglGetConfigAttrib(EGLDisplay display, EGLConfig config, EGLint name, EGLint *value)
{
    (void)display, (void)config;
    *value = attribute(name);
    return EGL_TRUE;
}

EGLBoolean eglGetConfigs(EGLDisplay display, EGLConfig *configs, EGLint room, EGLint *count)
{
    (void)display;
    if (configs && room > 0)
        configs[0] = the_config;
    *count = 1;
    return EGL_TRUE;
}

/* Whether the one configuration has what is asked for. */
static int fits(EGLint name, EGLint wanted)
{
    EGLint have = attribute(name);
    switch (name) {
    case EGL_SURFACE_TYPE:
    case EGL_RENDERABLE_TYPE:
    case EGL_CONFORMANT: return (wanted & have) == wanted;
    case EGL_RED_SIZE:
    case EGL_GREEN_SIZE:
    case EGL_BLUE_SIZE:
    case EGL_ALPHA_SIZE:
    case EGL_DEPTH_SIZE:
    case EGL_STENCIL_SIZE:
    case EGL_BUFFER_SIZE:
    case EGL_SAMPLES:
    case EGL_SAMPLE_BUFFERS: return wanted <= have;
    }
    return 1;
}

EGLBoolean eglChooseConfig(EGLDisplay display, const EGLint *list, EGLConfig *configs, EGLint room, EGLint *count)
{
    EGLint all;
    for (; list && list[0] != EGL_NONE; list += 2) {
        if (list[1] != EGL_DONT_CARE && !fits(list[0], list[1])) {
            *count = 0;
            return EGL_TRUE;
        }
    }
    eglGetConfigs(display, configs, room, &all);
    *count = 1;
    return EGL_TRUE;
}

EGLContext eglCreateContext(EGLDisplay display, EGLConfig config, EGLContext share, const EGLint *list)
{
    EGLint major = 1, flags = 0;
    OSMesaContext context = NULL;
    (void)display, (void)config;
    for (; list && list[0] != EGL_NONE; list += 2) {
        if (list[0] == EGL_CONTEXT_MAJOR_VERSION)
            major = list[1];
        else if (list[0] == EGL_CONTEXT_FLAGS_KHR)
            flags = list[1] & ~EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR;
    }
    /* Programs that want "any version" ask for 1.0. */
    if (major < 2 && !flags)
        context = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 16, share);
    if (!context)
        fails(EGL_BAD_MATCH);
    return context;
}

EGLBoolean eglDestroyContext(EGLDisplay display, EGLContext context)
{
    (void)display;
    if (context == current)
        current = NULL;
    OSMesaDestroyContext(context);
    return EGL_TRUE;
}

static EGLSurface surface(EGLint width, EGLint height)
{
    struct surface *s = calloc(1, sizeof *s);
    s->width = width > 0 ? width : 250;
    s->height = height > 0 ? height : 250;
    s->pixels = calloc((size_t)s->width * (size_t)s->height, 4);
    return s;
}

EGLSurface eglCreatePbufferSurface(EGLDisplay display, EGLConfig config, const EGLint *list)
{
    EGLint width = 0, height = 0;
    (void)display, (void)config;
    for (; list && list[0] != EGL_NONE; list += 2) {
        if (list[0] == EGL_WIDTH)
            width = list[1];
        if (list[0] == EGL_HEIGHT)
            height = list[1];
    }
    return surface(width, height);
}

EGLSurface eglCreateWindowSurface(EGLDisplay display, EGLConfig config, EGLNativeWindowType window, const EGLint *list)
{
    typedef int geometry(void *, unsigned long, unsigned long *, int *, int *, unsigned *, unsigned *, unsigned *,
                         unsigned *);
    geometry *ask = (geometry *)dlsym(RTLD_DEFAULT, "XGetGeometry");
    unsigned long root;
    int x, y;
    unsigned width = 0, height = 0, border, depth;
    (void)display, (void)config, (void)list;
    if (x_display && ask && window)
        ask(x_display, (unsigned long)window, &root, &x, &y, &width, &height, &border, &depth);
    return surface((EGLint)width, (EGLint)height);
}

EGLBoolean eglDestroySurface(EGLDisplay display, EGLSurface which)
{
    struct surface *s = which;
    (void)display;
    if (s != current_surface) {
        free(s->pixels);
        free(s);
    }
    return EGL_TRUE;
}

EGLBoolean eglQuerySurface(EGLDisplay display, EGLSurface which, EGLint name, EGLint *value)
{
    struct surface *s = which;
    (void)display;
    *value = name == EGL_WIDTH ? s->width : name == EGL_HEIGHT ? s->height : 0;
    return EGL_TRUE;
}

EGLBoolean eglMakeCurrent(EGLDisplay display, EGLSurface draw, EGLSurface read, EGLContext context)
{
    static struct surface nothing = {16, 16, NULL};
    static unsigned char pixels[16 * 16 * 4];
    struct surface *s = draw ? draw : &nothing;
    (void)display, (void)read;
    nothing.pixels = pixels;
    if (!context)
        s = NULL;
    if (!OSMesaMakeCurrent(context, s ? s->pixels : NULL, GL_UNSIGNED_BYTE, s ? s->width : 0, s ? s->height : 0))
        return fails(EGL_BAD_MATCH);
    current = context;
    current_surface = s == &nothing ? NULL : s;
    return EGL_TRUE;
}

EGLContext eglGetCurrentContext(void) { return current; }
EGLDisplay eglGetCurrentDisplay(void) { return current ? the_display : EGL_NO_DISPLAY; }
EGLSurface eglGetCurrentSurface(EGLint which) { (void)which; return current_surface; }
EGLBoolean eglSwapInterval(EGLDisplay display, EGLint interval) { (void)display, (void)interval; return EGL_TRUE; }

EGLBoolean eglSwapBuffers(EGLDisplay display, EGLSurface which)
{
    (void)display, (void)which;
    glFinish();
    return EGL_TRUE;
}

__eglMustCastToProperFunctionPointerType eglGetProcAddress(const char *name)
{
    if (strncmp(name, "egl", 3) == 0)
        return (__eglMustCastToProperFunctionPointerType)dlsym(RTLD_DEFAULT, name);
    return (__eglMustCastToProperFunctionPointerType)OSMesaGetProcAddress(name);
}

#endif

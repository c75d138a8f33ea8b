/* Windows, pixmaps and off-screen buffers of X drawn by OpenGL, and looked at through X. */
#include <GL/gl.h>
#include <GL/glx.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int wrong = 0;
static Display *display;

#define CHECK(condition)                                              \
    do {                                                              \
        if (!(condition)) {                                           \
            printf("%s:%d: %s\n", __FILE__, __LINE__, #condition);    \
            wrong++;                                                  \
        }                                                             \
    } while (0)

static unsigned long pixel(Drawable drawable, int x, int y)
{
    XImage *image = XGetImage(display, drawable, x, y, 1, 1, AllPlanes, ZPixmap);
    unsigned long value = image ? XGetPixel(image, 0, 0) & 0xffffff : 0x1000000;
    if (image) {
        XDestroyImage(image);
    }
    return value;
}

/* A window beside those before: what another one covers cannot be read. */
static Window window(XVisualInfo *visual, int width, int height)
{
    Window root = RootWindow(display, visual->screen);
    XSetWindowAttributes attributes;
    Window made;
    static int left = 0;
    attributes.colormap = XCreateColormap(display, root, visual->visual, AllocNone);
    attributes.border_pixel = 0;
    attributes.background_pixel = 0;
    made = XCreateWindow(display, root, left, 0, width, height, 0, visual->depth, InputOutput, visual->visual,
                         CWColormap | CWBorderPixel | CWBackPixel, &attributes);
    left += 150;
    XMapWindow(display, made);
    XSync(display, False);
    return made;
}

static void clear(float red, float green, float blue)
{
    glClearColor(red, green, blue, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

static void double_buffered(void)
{
    int wanted[] = {GLX_RGBA, GLX_DOUBLEBUFFER, GLX_DEPTH_SIZE, 16, None};
    XVisualInfo *visual = glXChooseVisual(display, DefaultScreen(display), wanted);
    GLXContext context, other;
    Window first, second;
    GLint box[4];
    int value = 0;
    CHECK(visual != NULL);
    CHECK(glXGetConfig(display, visual, GLX_DOUBLEBUFFER, &value) == 0 && value == 1);
    CHECK(glXGetConfig(display, visual, GLX_DEPTH_SIZE, &value) == 0 && value >= 16);
    CHECK(glXGetConfig(display, visual, 4711, &value) == GLX_BAD_ATTRIBUTE);
    context = glXCreateContext(display, visual, NULL, True);
    other = glXCreateContext(display, visual, context, True);
    first = window(visual, 100, 80);
    second = window(visual, 60, 50);
    CHECK(context != NULL && glXIsDirect(display, context));
    CHECK(glXMakeCurrent(display, first, context));
    CHECK(glXGetCurrentContext() == context && glXGetCurrentDrawable() == first);
    CHECK(glXGetCurrentDisplay() == display);
    glGetIntegerv(GL_VIEWPORT, box);
    CHECK(box[2] == 100 && box[3] == 80);

    /* Upper half red, lower half green; not to be seen before the swap. */
    clear(1, 0, 0);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, 100, 40);
    clear(0, 1, 0);
    glDisable(GL_SCISSOR_TEST);
    glFinish();
    CHECK(pixel(first, 50, 10) == 0);
    glXSwapBuffers(display, first);
    CHECK(pixel(first, 50, 10) == 0xff0000 && pixel(first, 50, 70) == 0x00ff00);

    /* Another window by the same context, and back again. */
    CHECK(glXMakeCurrent(display, second, context));
    glGetIntegerv(GL_VIEWPORT, box);
    CHECK(box[2] == 100);
    clear(0, 0, 1);
    glXSwapBuffers(display, second);
    CHECK(pixel(second, 30, 20) == 0x0000ff && pixel(first, 50, 10) == 0xff0000);
    CHECK(glXMakeCurrent(display, first, other));
    glDrawBuffer(GL_FRONT);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, 10, 10);
    clear(1, 1, 1);
    glFlush();
    CHECK(pixel(first, 5, 75) == 0xffffff && pixel(first, 50, 10) == 0xff0000);

    /* Another size. */
    XResizeWindow(display, first, 140, 120);
    XSync(display, False);
    CHECK(glXMakeCurrent(display, first, other));
    glViewport(0, 0, 140, 120);
    glDisable(GL_SCISSOR_TEST);
    glDrawBuffer(GL_BACK);
    clear(1, 1, 0);
    glXSwapBuffers(display, first);
    CHECK(pixel(first, 135, 5) == 0xffff00);

    /* A window that goes away under a context is no error. */
    XDestroyWindow(display, first);
    clear(1, 0, 0);
    glXSwapBuffers(display, first);
    CHECK(!glXMakeCurrent(display, first, context) && !glXMakeCurrent(display, first, other));
    /* A context that is destroyed while it is current lives on until it is not. */
    CHECK(glXMakeCurrent(display, second, other));
    glXDestroyContext(display, other);
    CHECK(glXGetCurrentContext() == other && glGetString(GL_VERSION) != NULL);
    CHECK(glXMakeCurrent(display, None, NULL));
    CHECK(glXGetCurrentContext() == NULL && !glXMakeCurrent(display, second, other));
    glXDestroyContext(display, other);
    glXDestroyContext(display, context);
    glXDestroyContext(display, context);
    CHECK(!glXMakeCurrent(display, second, context));
    XFree(visual);
}

static void single_buffered(void)
{
    int wanted[] = {GLX_RGBA, GLX_RED_SIZE, 1, None};
    XVisualInfo *visual = glXChooseVisual(display, DefaultScreen(display), wanted);
    GLXContext context = glXCreateContext(display, visual, NULL, True);
    Window shown = window(visual, 40, 30);
    Pixmap pixmap = XCreatePixmap(display, shown, 20, 10, visual->depth);
    GLXPixmap drawable;
    int value;
    CHECK(glXGetConfig(display, visual, GLX_DOUBLEBUFFER, &value) == 0 && value == 0);
    CHECK(glXMakeCurrent(display, shown, context));
    clear(1, 0, 1);
    glFlush();
    CHECK(pixel(shown, 20, 20) == 0xff00ff);
    drawable = glXCreateGLXPixmap(display, visual, pixmap);
    CHECK(glXMakeCurrent(display, drawable, context));
    clear(0, 1, 1);
    glXWaitGL();
    CHECK(pixel(pixmap, 19, 9) == 0x00ffff);
    glXMakeCurrent(display, None, NULL);
    glXDestroyGLXPixmap(display, drawable);
    glXDestroyContext(display, context);
    XFree(visual);
}

static void framebuffer_configs(void)
{
    int wanted[] = {GLX_DRAWABLE_TYPE, GLX_PBUFFER_BIT | GLX_WINDOW_BIT, GLX_DOUBLEBUFFER, True, None};
    int size[] = {GLX_PBUFFER_WIDTH, 33, GLX_PBUFFER_HEIGHT, 22, None};
    int newer[] = {GLX_CONTEXT_MAJOR_VERSION_ARB, 3, GLX_CONTEXT_MINOR_VERSION_ARB, 3, None};
    int count = 0, value = 0;
    unsigned int width = 0;
    GLubyte color[4] = {0};
    GLXFBConfig *configs = glXChooseFBConfig(display, DefaultScreen(display), wanted, &count);
    PFNGLXCREATECONTEXTATTRIBSARBPROC create;
    GLXContext context;
    GLXPbuffer buffer;
    XVisualInfo *visual;
    CHECK(configs != NULL && count > 0);
    CHECK(glXGetFBConfigAttrib(display, configs[0], GLX_DOUBLEBUFFER, &value) == 0 && value == 1);
    visual = glXGetVisualFromFBConfig(display, configs[0]);
    CHECK(glXGetFBConfigAttrib(display, configs[0], GLX_VISUAL_ID, &value) == 0);
    CHECK(visual != NULL && (int)visual->visualid == value);
    create = (PFNGLXCREATECONTEXTATTRIBSARBPROC)glXGetProcAddressARB((const GLubyte *)"glXCreateContextAttribsARB");
    CHECK(create != NULL && create(display, configs[0], NULL, True, newer) == NULL);
    context = create(display, configs[0], NULL, True, NULL);
    buffer = glXCreatePbuffer(display, configs[0], size);
    CHECK(context != NULL && buffer != None);
    CHECK(glXMakeContextCurrent(display, buffer, buffer, context));
    glXQueryDrawable(display, buffer, GLX_WIDTH, &width);
    CHECK(width == 33);
    CHECK(glXQueryContext(display, context, GLX_RENDER_TYPE, &value) == 0 && value == GLX_RGBA_TYPE);
    clear(0, 0.2f, 1);
    glReadPixels(32, 21, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, color);
    CHECK(color[0] == 0 && color[1] == 51 && color[2] == 255);
    glXDestroyPbuffer(display, buffer);
    glXMakeCurrent(display, None, NULL);
    glXDestroyContext(display, context);
    XFree(visual);
    XFree(configs);
}

static void fonts(void)
{
    int wanted[] = {GLX_RGBA, None};
    XVisualInfo *visual = glXChooseVisual(display, DefaultScreen(display), wanted);
    GLXContext context = glXCreateContext(display, visual, NULL, True);
    Window shown = window(visual, 40, 30);
    XFontStruct *font = XLoadQueryFont(display, "fixed");
    GLubyte pixels[40 * 30];
    int k, lit = 0;
    if (font == NULL) {
        printf("left out: the server has no fonts\n");
        return;
    }
    CHECK(glXMakeCurrent(display, shown, context));
    clear(0, 0, 0);
    glOrtho(0, 40, 0, 30, -1, 1);
    glXUseXFont(font->fid, 'A', 26, 1000 + 'A');
    CHECK(glIsList(1000 + 'Z'));
    glColor3f(1, 1, 1);
    glRasterPos2i(5, 5);
    glListBase(1000);
    glCallLists(2, GL_UNSIGNED_BYTE, "IL");
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, 40, 30, GL_RED, GL_UNSIGNED_BYTE, pixels);
    for (k = 0; k < 40 * 30; k++) {
        lit += pixels[k] == 255;
    }
    CHECK(lit > 10 && lit < 100);
    CHECK(glGetError() == GL_NO_ERROR);
    glXMakeCurrent(display, None, NULL);
    glXDestroyContext(display, context);
}

static void nonsense(void)
{
    int list[] = {4711, 1, None}, value = 5;
    glXSwapBuffers(NULL, 0);
    glXSwapBuffers(display, 12345678);
    CHECK(!glXMakeCurrent(display, 12345678, (GLXContext)16));
    CHECK(!glXMakeCurrent(NULL, 1, (GLXContext)16));
    CHECK(glXChooseVisual(display, DefaultScreen(display), list) == NULL);
    CHECK(glXChooseVisual(display, 99, list) == NULL);
    CHECK(glXChooseVisual(display, -1, NULL) == NULL);
    CHECK(glXChooseFBConfig(display, DefaultScreen(display), list, &value) == NULL && value == 0);
    CHECK(glXGetVisualFromFBConfig(display, (GLXFBConfig)0x12345) == NULL);
    CHECK(glXCreateContext(display, NULL, NULL, True) == NULL);
    CHECK(glXGetProcAddress((const GLubyte *)"glXNoSuchFunction") == NULL);
    CHECK(glXGetProcAddress(NULL) == NULL);
    glXUseXFont(12345678, 0, 10, 1);
    glXCopyContext(display, (GLXContext)16, (GLXContext)32, ~0ul);
    glXDestroyContext(display, (GLXContext)999);
    glXDestroyWindow(display, 12345678);
    glXWaitX();
    glXWaitGL();
    CHECK(strstr(glXQueryExtensionsString(display, 0), "GLX_ARB_create_context") != NULL);
}

int main(void)
{
    display = XOpenDisplay(NULL);
    if (display == NULL) {
        printf("there is no display\n");
        return 1;
    }
    double_buffered();
    single_buffered();
    framebuffer_configs();
    fonts();
    nonsense();
    XCloseDisplay(display);
    return wrong != 0;
}

/* Contexts: formats, sharing, several threads, moving between them. */
#include "check.h"
#include <pthread.h>

static void formats(void)
{
    const struct { GLenum format, type; int bytes; unsigned char expected[4]; } all[] = {
        {OSMESA_RGBA, GL_UNSIGNED_BYTE, 4, {255, 128, 64, 191}},
        {OSMESA_BGRA, GL_UNSIGNED_BYTE, 4, {64, 128, 255, 191}},
        {OSMESA_ARGB, GL_UNSIGNED_BYTE, 4, {191, 255, 128, 64}},
        {OSMESA_RGB, GL_UNSIGNED_BYTE, 3, {255, 128, 64}},
        {OSMESA_BGR, GL_UNSIGNED_BYTE, 3, {64, 128, 255}},
        {OSMESA_RGB_565, GL_UNSIGNED_SHORT_5_6_5, 2, {0x08, 0xfc}},
    };
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        unsigned char b[64] = {0};
        OSMesaContext c = OSMesaCreateContext(all[k].format, NULL);
        CHECK(OSMesaMakeCurrent(c, b, all[k].type, 2, 2));
        glClearColor(1, 0.5f, 0.25f, 0.75f);
        glClear(GL_COLOR_BUFFER_BIT);
        glFinish();
        for (int i = 0; i < (all[k].bytes == 2 ? 2 : all[k].bytes); i++)
            CHECK(abs(b[i] - all[k].expected[i]) <= 1);
        OSMesaDestroyContext(c);
    }
    float f[16] = {0};
    GLushort s[16] = {0};
    OSMesaContext c = OSMesaCreateContext(OSMESA_RGBA, NULL);
    CHECK(OSMesaMakeCurrent(c, f, GL_FLOAT, 2, 2));
    glClearColor(1, 0.5f, 0.25f, 0.75f);
    glClear(GL_COLOR_BUFFER_BIT);
    CHECK(OSMesaMakeCurrent(c, s, GL_UNSIGNED_SHORT, 2, 2));
    CHECK(f[0] == 1 && f[1] == 0.5f && f[15] == 0.75f);
    glClear(GL_COLOR_BUFFER_BIT);
    OSMesaDestroyContext(c);
    CHECK(s[0] == 65535 && s[1] == 32768);
}

static void rows(void)
{
    unsigned char b[4 * 8 * 4];
    GLint v = -1;
    OSMesaContext c = OSMesaCreateContext(OSMESA_RGBA, NULL);
    memset(b, 7, sizeof b);
    CHECK(OSMesaMakeCurrent(c, b, GL_UNSIGNED_BYTE, 4, 4));
    OSMesaPixelStore(OSMESA_ROW_LENGTH, 8);
    OSMesaPixelStore(OSMESA_Y_UP, 0);
    OSMesaGetIntegerv(OSMESA_ROW_LENGTH, &v);
    CHECK(v == 8);
    OSMesaGetIntegerv(OSMESA_MAX_WIDTH, &v);
    CHECK(v >= 4096);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, 4, 1);
    glClearColor(1, 1, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glFinish();
    CHECK(b[0] == 0 && b[16] == 7);
    CHECK(b[4 * 8 * 3] == 255 && b[4 * 8 * 3 + 16] == 7);
    /* Attached again, the same memory may be new: it gets all rows, but not before they are asked for. */
    glClear(GL_COLOR_BUFFER_BIT);
    memset(b, 7, sizeof b);
    CHECK(OSMesaMakeCurrent(c, b, GL_UNSIGNED_BYTE, 4, 4));
    CHECK(b[0] == 7 && b[4 * 8 * 3] == 7);
    glFinish();
    CHECK(b[0] == 0 && b[4 * 8 * 3] == 255);
    OSMesaDestroyContext(c);
}

static void buffers(void)
{
    unsigned char b[4 * 16];
    GLint w, h, n;
    void *p;
    OSMesaContext c = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 0, NULL);
    CHECK(!OSMesaGetDepthBuffer(c, &w, &h, &n, &p));
    CHECK(OSMesaMakeCurrent(c, b, GL_UNSIGNED_BYTE, 4, 4));
    glClearDepth(0.5);
    glClear(GL_DEPTH_BUFFER_BIT);
    CHECK(OSMesaGetDepthBuffer(c, &w, &h, &n, &p));
    CHECK(w == 4 && h == 4 && n == 4);
    CHECK((((unsigned *)p)[15] & 0xffffff) >> 12 == 0x800 || (((unsigned *)p)[15] & 0xffffff) >> 12 == 0x7ff);
    CHECK(OSMesaGetColorBuffer(c, &w, &h, &n, &p));
    CHECK(w == 4 && h == 4 && n == OSMESA_RGBA && p == b);
    OSMesaDestroyContext(c);
}

static void attributes(void)
{
    const int good[] = {OSMESA_FORMAT, OSMESA_RGBA, OSMESA_DEPTH_BITS, 24, OSMESA_PROFILE, OSMESA_COMPAT_PROFILE,
                        OSMESA_CONTEXT_MAJOR_VERSION, 1, OSMESA_CONTEXT_MINOR_VERSION, 5, 0};
    const int core[] = {OSMESA_PROFILE, OSMESA_CORE_PROFILE, 0};
    const int newer[] = {OSMESA_CONTEXT_MAJOR_VERSION, 3, 0};
    const int unknown[] = {12345, 1, 0};
    OSMesaContext c = OSMesaCreateContextAttribs(good, NULL);
    CHECK(c != NULL);
    OSMesaDestroyContext(c);
    CHECK(OSMesaCreateContextAttribs(core, NULL) == NULL);
    CHECK(OSMesaCreateContextAttribs(newer, NULL) == NULL);
    CHECK(OSMesaCreateContextAttribs(unknown, NULL) == NULL);
    CHECK(OSMesaCreateContext(OSMESA_COLOR_INDEX, NULL) == NULL);
}

static OSMesaContext shared;

static void *draw(void *color)
{
    unsigned char *picture = malloc(4 * SIZE * SIZE);
    int wanted = (int)(size_t)color;
    OSMesaContext c = start(picture);
    /* Current elsewhere: not to be had. */
    CHECK(!OSMesaMakeCurrent(shared, picture, GL_UNSIGNED_BYTE, SIZE, SIZE));
    CHECK(OSMesaGetCurrentContext() == c);
    for (int k = 0; k < 50; k++) {
        glClearColor((float)wanted / 255, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        glColor3f(0, (float)wanted / 255, 0);
        glRectf(-1, -1, 0, 1);
        glFinish();
        CHECK(is(picture, 5, 5, 0, wanted, 0) && is(picture, 60, 5, wanted, 0, 0));
    }
    stop(c);
    free(picture);
    return NULL;
}

static void *take(void *picture)
{
    CHECK(OSMesaMakeCurrent(shared, picture, GL_UNSIGNED_BYTE, SIZE, SIZE));
    CHECK(glIsList(1));
    glClearColor(0, 1, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glFinish();
    /* The thread ends with the context current: it is free again. */
    return NULL;
}

static void threads(void)
{
    static unsigned char picture[4 * SIZE * SIZE];
    pthread_t t[4];
    shared = start(picture);
    glNewList(1, GL_COMPILE);
    glEndList();
    for (size_t k = 0; k < 4; k++)
        CHECK(pthread_create(&t[k], NULL, draw, (void *)(60 * (k + 1))) == 0);
    for (int k = 0; k < 4; k++)
        pthread_join(t[k], NULL);
    CHECK(OSMesaMakeCurrent(NULL, NULL, 0, 0, 0));
    CHECK(pthread_create(&t[0], NULL, take, picture) == 0);
    pthread_join(t[0], NULL);
    CHECK(is(picture, 5, 5, 0, 255, 0));
    CHECK(OSMesaMakeCurrent(shared, picture, GL_UNSIGNED_BYTE, SIZE, SIZE));

    /* A context that shares its lists. */
    OSMesaContext other = OSMesaCreateContext(OSMESA_RGBA, shared);
    CHECK(OSMesaMakeCurrent(other, picture, GL_UNSIGNED_BYTE, SIZE, SIZE));
    CHECK(glIsList(1));
    stop(other);
    OSMesaDestroyContext(shared);
}

int main(void)
{
    formats();
    rows();
    buffers();
    attributes();
    threads();
    return failures != 0;
}

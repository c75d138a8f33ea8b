/* What the C tests share: a context with a picture, and facts about it. */
#ifndef CHECK_H
#define CHECK_H
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <GL/osmesa.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIZE 64

static int failures;

#define CHECK(fact)                                                        \
    do {                                                                   \
        if (!(fact)) {                                                     \
            printf("%s:%d: not so: %s\n", __FILE__, __LINE__, #fact);      \
            failures++;                                                    \
        }                                                                  \
    } while (0)

/* Makes a context current that draws into `picture`. */
static OSMesaContext start(unsigned char *picture)
{
    OSMesaContext c = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 16, NULL);
    CHECK(c != NULL);
    CHECK(OSMesaMakeCurrent(c, picture, GL_UNSIGNED_BYTE, SIZE, SIZE));
    return c;
}

static void stop(OSMesaContext c)
{
    CHECK(glGetError() == GL_NO_ERROR);
    OSMesaDestroyContext(c);
    CHECK(OSMesaGetCurrentContext() == NULL);
}

/* Whether a pixel of a picture of RGBA bytes is of a colour, within 1. */
static int is(const unsigned char *picture, int x, int y, int r, int g, int b)
{
    const unsigned char *p = picture + 4 * (y * SIZE + x);
    int good = abs(p[0] - r) <= 1 && abs(p[1] - g) <= 1 && abs(p[2] - b) <= 1;
    if (!good)
        printf("pixel %d,%d is %d %d %d instead of %d %d %d\n", x, y, p[0], p[1], p[2], r, g, b);
    return good;
}

#endif

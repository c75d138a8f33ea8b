/* No command touches a byte beyond what it is given: all memory ends where a page begins that may not be touched. */
#define _GNU_SOURCE
#include "check.h"
#include <sys/mman.h>
#include <unistd.h>

static unsigned char picture[4 * SIZE * SIZE];
static unsigned char *wall;

/* Memory of so many bytes before the wall. */
static void *edge(size_t bytes) { return wall - bytes; }

static void build_wall(void)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE), room = 256 * page;
    unsigned char *memory = mmap(NULL, room + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED || mprotect(memory + room, page, PROT_NONE)) exit(2);
    wall = memory + room;
}

/* Bytes of pixels in memory, by the specification's section 3.6.4; a type of several components is one element. */
static size_t bytes_of(int components, int element, int packed, int w, int h, int d, int row, int images, int alignment,
                       int skip_pixels, int skip_rows, int skip_images)
{
    int n = packed ? 1 : components, length = row ? row : w, height = images ? images : h;
    size_t line = (size_t)n * element * length;
    if (element < alignment) line = (line + alignment - 1) / alignment * alignment;
    size_t last = (size_t)(skip_images + d - 1) * height + (size_t)(skip_rows + h - 1);
    return last * line + (size_t)n * element * (skip_pixels + w);
}

static const struct {
    GLenum name;
    int components;
} formats[] = {{GL_RGBA, 4},      {GL_RGB, 3},       {GL_BGRA, 4},           {GL_BGR, 3},
               {GL_LUMINANCE, 1}, {GL_ALPHA, 1},     {GL_LUMINANCE_ALPHA, 2}, {GL_RED, 1},
               {GL_DEPTH_COMPONENT, 1}};
static const struct {
    GLenum name;
    int element, packs;
} types[] = {{GL_UNSIGNED_BYTE, 1, 0},           {GL_BYTE, 1, 0},
             {GL_SHORT, 2, 0},                   {GL_UNSIGNED_SHORT, 2, 0},
             {GL_INT, 4, 0},                     {GL_FLOAT, 4, 0},
             {GL_UNSIGNED_SHORT_5_6_5, 2, 3},    {GL_UNSIGNED_BYTE_3_3_2, 1, 3},
             {GL_UNSIGNED_SHORT_4_4_4_4, 2, 4},  {GL_UNSIGNED_SHORT_1_5_5_5_REV, 2, 4},
             {GL_UNSIGNED_INT_8_8_8_8_REV, 4, 4}, {GL_UNSIGNED_INT_10_10_10_2, 4, 4}};
#define COUNT(a) (int)(sizeof(a) / sizeof *(a))

static void store(GLenum row, GLenum height, GLenum alignment, GLenum pixels, GLenum rows, GLenum images, const int *s)
{
    glPixelStorei(row, s[0]);
    glPixelStorei(height, s[1]);
    glPixelStorei(alignment, s[2]);
    glPixelStorei(pixels, s[3]);
    glPixelStorei(rows, s[4]);
    glPixelStorei(images, s[5]);
}

static void pixels(int f, int t, const int *s)
{
    const int w = 5, h = 3, d = 2;
    int packed = types[t].packs != 0, n = formats[f].components, e = types[t].element;
    GLenum format = formats[f].name, type = types[t].name;
    if (packed && (types[t].packs != n || format == GL_BGR)) return;
    int depth = format == GL_DEPTH_COMPONENT, internal = depth ? GL_DEPTH_COMPONENT : GL_RGBA;
    store(GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_ALIGNMENT, GL_UNPACK_SKIP_PIXELS,
          GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES, s);
    store(GL_PACK_ROW_LENGTH, GL_PACK_IMAGE_HEIGHT, GL_PACK_ALIGNMENT, GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS,
          GL_PACK_SKIP_IMAGES, s);
    /* Two dimensions have no images to skip; one dimension no rows, but those that are skipped. */
    size_t flat = bytes_of(n, e, packed, w, h, 1, s[0], 0, s[2], s[3], s[4], 0);
    size_t line = bytes_of(n, e, packed, w, 1, 1, s[0], 0, s[2], s[3], s[4], 0);
    size_t solid = bytes_of(n, e, packed, w, h, d, s[0], s[1], s[2], s[3], s[4], s[5]);
    glTexImage1D(GL_TEXTURE_1D, 0, internal, w, 0, format, type, edge(line));
    glTexImage2D(GL_TEXTURE_2D, 0, internal, w, h, 0, format, type, edge(flat));
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, w, h, format, type, edge(flat));
    glGetTexImage(GL_TEXTURE_2D, 0, format, type, edge(flat));
    if (!depth) {
        glTexImage3D(GL_TEXTURE_3D, 0, internal, w, h, d, 0, format, type, edge(solid));
        glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, w, h, d, format, type, edge(solid));
        glGetTexImage(GL_TEXTURE_3D, 0, format, type, edge(solid));
    }
    glDrawPixels(w, h, format, type, edge(flat));
    glReadPixels(0, 0, w, h, format, type, edge(flat));
    /* Partly outside of the window, where nothing is written. */
    glReadPixels(SIZE - 2, SIZE - 1, w, h, format, type, edge(flat));
    glReadPixels(-3, -1, w, h, format, type, edge(flat));
    CHECK(glGetError() == GL_NO_ERROR);
}

static void bits(const int *s)
{
    store(GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_ALIGNMENT, GL_UNPACK_SKIP_PIXELS,
          GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES, s);
    int length = s[0] ? s[0] : 13;
    size_t line = (size_t)((length + 8 * s[2] - 1) / (8 * s[2]) * s[2]);
    size_t bytes = (size_t)(s[4] + 2) * line + (size_t)(s[3] + 13 + 7) / 8;
    glBitmap(13, 3, 0, 0, 1, 1, edge(bytes));
    CHECK(glGetError() == GL_NO_ERROR);
}

static void vectors(void)
{
    GLfloat *four = edge(4 * sizeof(GLfloat)), *one = edge(sizeof(GLfloat));
    GLdouble *sixteen = edge(16 * sizeof(GLdouble));
    for (int i = 0; i < 16; i++) sixteen[i] = 1;
    glLoadMatrixd(sixteen);
    glMultMatrixf(memset(edge(16 * sizeof(GLfloat)), 0, 16 * sizeof(GLfloat)));
    glLoadIdentity();
    four[0] = four[1] = four[2] = four[3] = 0.5f;
    glLightfv(GL_LIGHT0, GL_POSITION, four);
    glLightModelfv(GL_LIGHT_MODEL_AMBIENT, four);
    glMaterialfv(GL_FRONT, GL_DIFFUSE, four);
    glFogfv(GL_FOG_COLOR, four);
    glTexEnvfv(GL_TEXTURE_ENV, GL_TEXTURE_ENV_COLOR, four);
    glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, four);
    glTexGenfv(GL_S, GL_OBJECT_PLANE, four);
    one[0] = 1;
    glLightfv(GL_LIGHT0, GL_SPOT_CUTOFF, memcpy(edge(sizeof *one), &(GLfloat){90}, sizeof *one));
    glLightModelfv(GL_LIGHT_MODEL_TWO_SIDE, one);
    glMaterialfv(GL_FRONT, GL_SHININESS, one);
    glFogfv(GL_FOG_DENSITY, one);
    one[0] = GL_REPLACE;
    glTexEnvfv(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, one);
    one[0] = GL_NEAREST;
    glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, one);
    one[0] = GL_SPHERE_MAP;
    glTexGenfv(GL_S, GL_TEXTURE_GEN_MODE, one);
    glLightfv(GL_LIGHT0, GL_SPOT_DIRECTION, edge(3 * sizeof(GLfloat)));
    glGetLightfv(GL_LIGHT0, GL_SPOT_DIRECTION, edge(3 * sizeof(GLfloat)));
    glGetLightfv(GL_LIGHT0, GL_SPOT_CUTOFF, one);
    glGetMaterialfv(GL_FRONT, GL_SHININESS, one);
    glGetTexGenfv(GL_S, GL_TEXTURE_GEN_MODE, one);
    glGetFloatv(GL_CURRENT_COLOR, edge(4 * sizeof(GLfloat)));
    glGetIntegerv(GL_VIEWPORT, edge(4 * sizeof(GLint)));
    glGetBooleanv(GL_COLOR_WRITEMASK, edge(4));
    glGetBooleanv(GL_DEPTH_TEST, edge(1));
    glGetDoublev(GL_DEPTH_RANGE, edge(2 * sizeof(GLdouble)));
    glGetClipPlane(GL_CLIP_PLANE0, edge(4 * sizeof(GLdouble)));
    glPolygonStipple(edge(128));
    glGetPolygonStipple(edge(128));
    for (int size = 2; size <= 4; size++) {
        glBegin(GL_POINTS);
        GLshort *v = edge(size * sizeof *v);
        size == 2 ? glVertex2sv(v) : size == 3 ? glVertex3sv(v) : glVertex4sv(v);
        glTexCoord1sv(edge(sizeof(GLshort)));
        glColor3ubv(edge(3));
        glEnd();
    }
    CHECK(glGetError() == GL_NO_ERROR);
}

static void tables(void)
{
    GLfloat *map = memset(edge(8 * sizeof(GLfloat)), 0, 8 * sizeof(GLfloat));
    glPixelMapfv(GL_PIXEL_MAP_R_TO_R, 8, map);
    glGetPixelMapfv(GL_PIXEL_MAP_R_TO_R, edge(8 * sizeof(GLfloat)));
    glGetPixelMapusv(GL_PIXEL_MAP_R_TO_R, edge(8 * sizeof(GLushort)));
    /* Three points of three numbers, five apart; the last one has no gap behind it. */
    glMap1f(GL_MAP1_VERTEX_3, 0, 1, 5, 3, edge((2 * 5 + 3) * sizeof(GLfloat)));
    glMap2d(GL_MAP2_TEXTURE_COORD_2, 0, 1, 3, 4, 0, 1, 13, 2, edge((3 * 3 + 13 + 2) * sizeof(GLdouble)));
    glGetMapfv(GL_MAP1_VERTEX_3, GL_COEFF, edge(9 * sizeof(GLfloat)));
    glGetMapdv(GL_MAP2_TEXTURE_COORD_2, GL_COEFF, edge(16 * sizeof(GLdouble)));
    glGetMapiv(GL_MAP2_TEXTURE_COORD_2, GL_ORDER, edge(2 * sizeof(GLint)));
    glCallLists(7, GL_3_BYTES, edge(21));
    glCallLists(7, GL_FLOAT, edge(28));
    glDeleteTextures(3, memset(edge(12), 0, 12));
    glGenTextures(3, edge(12));
    CHECK(glGetError() == GL_NO_ERROR);
}

static void arrays(void)
{
    /* Vertices of three shorts, eight bytes apart, of which 4 to 9 are drawn. */
    unsigned char *vertices = memset(edge(9 * 8 + 6), 0, 9 * 8 + 6);
    GLushort indices[6] = {4, 9, 5, 8, 6, 7};
    GLubyte *bytes;
    glVertexPointer(3, GL_SHORT, 8, vertices);
    glEnableClientState(GL_VERTEX_ARRAY);
    glDrawArrays(GL_TRIANGLES, 4, 6);
    glArrayElement(9);
    glDrawElements(GL_TRIANGLES, 6, GL_UNSIGNED_SHORT, indices);
    glDrawRangeElements(GL_TRIANGLES, 4, 9, 6, GL_UNSIGNED_SHORT, indices);
    glFinish();
    /* Now the indices are at the edge. */
    static GLfloat corners[10][2];
    glVertexPointer(2, GL_FLOAT, 0, corners);
    bytes = memcpy(edge(3), "\1\2\3", 3);
    glDrawElements(GL_TRIANGLES, 3, GL_UNSIGNED_BYTE, bytes);
    glDrawElements(GL_TRIANGLES, 6, GL_UNSIGNED_SHORT, memcpy(edge(sizeof indices), indices, sizeof indices));
    glInterleavedArrays(GL_C4UB_V2F, 0, memset(edge(3 * 12), 0, 3 * 12));
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glInterleavedArrays(GL_T2F_C4UB_V3F, 0, memset(edge(3 * 24), 0, 3 * 24));
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glFinish();
    glDisableClientState(GL_VERTEX_ARRAY);
    glDisableClientState(GL_COLOR_ARRAY);
    glDisableClientState(GL_TEXTURE_COORD_ARRAY);
    GLuint buffer;
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferData(GL_ARRAY_BUFFER, 33, edge(33), GL_STATIC_DRAW);
    glBufferSubData(GL_ARRAY_BUFFER, 30, 3, edge(3));
    glGetBufferSubData(GL_ARRAY_BUFFER, 30, 3, edge(3));
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    CHECK(glGetError() == GL_NO_ERROR);
}

static void feedback(void)
{
    GLuint *names = edge(7 * sizeof *names);
    GLfloat *values = edge(5 * sizeof *values);
    glSelectBuffer(7, names);
    glRenderMode(GL_SELECT);
    glInitNames();
    for (GLuint i = 0; i < 9; i++) {
        glPushName(i);
        glRectf(0, 0, 1, 1);
    }
    CHECK(glRenderMode(GL_RENDER) == -1);
    glFeedbackBuffer(5, GL_3D, values);
    glRenderMode(GL_FEEDBACK);
    glRectf(0, 0, 1, 1);
    CHECK(glRenderMode(GL_RENDER) == -1);
    CHECK(glGetError() == GL_NO_ERROR);
}

int main(void)
{
    /* Row length, image height, alignment, then what is skipped: pixels, rows, images. */
    const int stores[][6] = {{0, 0, 4, 0, 0, 0}, {0, 0, 1, 0, 0, 0}, {7, 0, 8, 0, 0, 0}, {9, 4, 2, 2, 1, 1}};
    OSMesaContext context = start(picture);
    build_wall();
    for (int s = 0; s < COUNT(stores); s++) {
        bits(stores[s]);
        for (int f = 0; f < COUNT(formats); f++)
            for (int t = 0; t < COUNT(types); t++) pixels(f, t, stores[s]);
    }
    store(GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_ALIGNMENT, GL_UNPACK_SKIP_PIXELS,
          GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES, stores[0]);
    store(GL_PACK_ROW_LENGTH, GL_PACK_IMAGE_HEIGHT, GL_PACK_ALIGNMENT, GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS,
          GL_PACK_SKIP_IMAGES, stores[0]);
    vectors();
    tables();
    arrays();
    feedback();
    glClear(GL_COLOR_BUFFER_BIT);
    glFinish();
    CHECK(is(picture, 0, 0, 0, 0, 0));
    stop(context);
    /* The picture itself, and depths, end at the wall too. */
    context = OSMesaCreateContextExt(OSMESA_BGR, 16, 0, 0, NULL);
    CHECK(OSMesaMakeCurrent(context, edge(3 * 5 * 7), GL_UNSIGNED_BYTE, 5, 7));
    glClear(GL_COLOR_BUFFER_BIT);
    glRectf(-1, -1, 1, 1);
    glFinish();
    stop(context);
    return failures != 0;
}

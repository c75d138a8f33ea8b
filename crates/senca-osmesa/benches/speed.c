/* Two libraries of OpenGL off screen, side by side.
 *
 *     cc -O2 -o speed crates/senca-osmesa/benches/speed.c -ldl -lm
 *     ./speed target/release/libOSMesa.so [libOSMesa.so.8] [SECONDS [ROUNDS [WORKLOAD]]]
 *
 * Each workload draws the same picture again and again into 1024 x 1024 pixels. In every round both libraries take
 * their turn, each in a process of its own, for SECONDS (0.3). A line tells the pictures a second of both (the median
 * of ROUNDS, 5), the ratio of the first library to the second with its lowest and highest, and the same for the first
 * picture of a process, which has to be prepared. With one library only its own numbers are told.
 */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <GL/osmesa.h>

enum { SIDE = 1024, MAX_ROUNDS = 99 };

/* Every function is taken from the library that is being measured. */
#define FUNCTIONS(F)                                                                                                   \
    F(void, Begin, (GLenum))                                                                                           \
    F(void, End, (void))                                                                                               \
    F(void, Vertex2f, (GLfloat, GLfloat))                                                                              \
    F(void, Vertex3f, (GLfloat, GLfloat, GLfloat))                                                                     \
    F(void, Normal3f, (GLfloat, GLfloat, GLfloat))                                                                     \
    F(void, Color3f, (GLfloat, GLfloat, GLfloat))                                                                      \
    F(void, Color4f, (GLfloat, GLfloat, GLfloat, GLfloat))                                                             \
    F(void, TexCoord2f, (GLfloat, GLfloat))                                                                            \
    F(void, Rectf, (GLfloat, GLfloat, GLfloat, GLfloat))                                                               \
    F(void, Enable, (GLenum))                                                                                          \
    F(void, Disable, (GLenum))                                                                                         \
    F(void, Clear, (GLbitfield))                                                                                       \
    F(void, Finish, (void))                                                                                            \
    F(void, MatrixMode, (GLenum))                                                                                      \
    F(void, LoadIdentity, (void))                                                                                      \
    F(void, Frustum, (GLdouble, GLdouble, GLdouble, GLdouble, GLdouble, GLdouble))                                     \
    F(void, Translatef, (GLfloat, GLfloat, GLfloat))                                                                   \
    F(void, Rotatef, (GLfloat, GLfloat, GLfloat, GLfloat))                                                             \
    F(void, Scalef, (GLfloat, GLfloat, GLfloat))                                                                       \
    F(void, PushMatrix, (void))                                                                                        \
    F(void, PopMatrix, (void))                                                                                         \
    F(void, NewList, (GLuint, GLenum))                                                                                 \
    F(void, EndList, (void))                                                                                           \
    F(void, CallList, (GLuint))                                                                                        \
    F(void, ShadeModel, (GLenum))                                                                                      \
    F(void, Materialfv, (GLenum, GLenum, const GLfloat *))                                                             \
    F(void, BlendFunc, (GLenum, GLenum))                                                                               \
    F(void, DepthMask, (GLboolean))                                                                                    \
    F(void, ColorMask, (GLboolean, GLboolean, GLboolean, GLboolean))                                                   \
    F(void, StencilFunc, (GLenum, GLint, GLuint))                                                                      \
    F(void, StencilOp, (GLenum, GLenum, GLenum))                                                                       \
    F(void, CullFace, (GLenum))                                                                                        \
    F(void, TexParameteri, (GLenum, GLenum, GLint))                                                                    \
    F(void, TexEnvi, (GLenum, GLenum, GLint))                                                                          \
    F(void, TexImage2D,                                                                                                \
      (GLenum, GLint, GLint, GLsizei, GLsizei, GLint, GLenum, GLenum, const GLvoid *))                                 \
    F(void, TexSubImage2D,                                                                                             \
      (GLenum, GLint, GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, const GLvoid *))                                 \
    F(void, ReadPixels, (GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, GLvoid *))                                    \
    F(void, DrawPixels, (GLsizei, GLsizei, GLenum, GLenum, const GLvoid *))                                            \
    F(void, RasterPos2f, (GLfloat, GLfloat))                                                                           \
    F(void, Map2f,                                                                                                     \
      (GLenum, GLfloat, GLfloat, GLint, GLint, GLfloat, GLfloat, GLint, GLint, const GLfloat *))                       \
    F(void, MapGrid2f, (GLint, GLfloat, GLfloat, GLint, GLfloat, GLfloat))                                             \
    F(void, EvalMesh2, (GLenum, GLint, GLint, GLint, GLint))                                                           \
    F(GLenum, GetError, (void))

#define DECLARE(type, name, parameters) type(*name) parameters;
#define LOAD(type, name, parameters) gl.name = (type(*) parameters)need(library, "gl" #name);
static struct {
    FUNCTIONS(DECLARE)
} gl;

static void *need(void *library, const char *name) {
    void *found = dlsym(library, name);
    if (!found) {
        fprintf(stderr, "no %s in this library\n", name);
        _exit(2);
    }
    return found;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

/* Numbers that look random and are the same everywhere. */
static unsigned seed;
static float chance(void) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) / 16777216.0f;
}

static unsigned char pixels[SIDE * SIDE * 4];

static void perspective(void) {
    gl.MatrixMode(GL_PROJECTION);
    gl.LoadIdentity();
    gl.Frustum(-0.5, 0.5, -0.5, 0.5, 1, 20);
    gl.MatrixMode(GL_MODELVIEW);
    gl.LoadIdentity();
    gl.Translatef(0, 0, -4);
}

static void torus_corner(float u, float v, float radius) {
    const float turn = 6.2831853f;
    float cu = cosf(turn * u), su = sinf(turn * u), cv = cosf(turn * v), sv = sinf(turn * v);
    gl.Normal3f(cu * cv, su * cv, sv);
    gl.Vertex3f(cu * (1 + radius * cv), su * (1 + radius * cv), radius * sv);
}

static void torus(int around, int across, float radius) {
    for (int i = 0; i < around; i++) {
        gl.Begin(GL_TRIANGLE_STRIP);
        for (int k = 0; k <= across; k++) {
            torus_corner((float)i / around, (float)k / across, radius);
            torus_corner((float)(i + 1) / around, (float)k / across, radius);
        }
        gl.End();
    }
}

static void lit(void) {
    perspective();
    gl.Enable(GL_DEPTH_TEST);
    gl.Enable(GL_LIGHTING);
    gl.Enable(GL_LIGHT0);
    gl.Enable(GL_NORMALIZE);
}

static void clear_frame(void) { gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT); }

static void mesh_setup(void) {
    lit();
    gl.NewList(1, GL_COMPILE);
    torus(400, 125, 0.4f);
    gl.EndList();
}
static void mesh_frame(void) {
    clear_frame();
    gl.Rotatef(1, 0.3f, 1, 0);
    gl.CallList(1);
}

static void wheels_setup(void) {
    lit();
    gl.ShadeModel(GL_FLAT);
    gl.NewList(1, GL_COMPILE);
    torus(24, 8, 0.3f);
    gl.EndList();
}
static void wheels_frame(void) {
    const float colors[3][4] = {{0.8f, 0.1f, 0, 1}, {0, 0.8f, 0.2f, 1}, {0.2f, 0.2f, 1, 1}};
    clear_frame();
    gl.Rotatef(1, 0, 0, 1);
    for (int i = 0; i < 30; i++) {
        gl.Materialfv(GL_FRONT, GL_AMBIENT_AND_DIFFUSE, colors[i % 3]);
        gl.PushMatrix();
        gl.Translatef(i % 6 * 0.6f - 1.5f, i / 6 * 0.6f - 1.2f, 0);
        gl.Scalef(0.2f, 0.2f, 0.2f);
        gl.CallList(1);
        gl.PopMatrix();
    }
}

static void quad(float z) {
    gl.Begin(GL_QUADS);
    gl.Color3f(1, 0, 0), gl.TexCoord2f(0, 0), gl.Vertex3f(-1, -1, z);
    gl.Color3f(0, 1, 0), gl.TexCoord2f(3, 0), gl.Vertex3f(1, -1, z);
    gl.Color3f(0, 0, 1), gl.TexCoord2f(3, 3), gl.Vertex3f(1, 1, z);
    gl.Color3f(1, 1, 1), gl.TexCoord2f(0, 3), gl.Vertex3f(-1, 1, z);
    gl.End();
}
static void gouraud_frame(void) {
    clear_frame();
    for (int i = 0; i < 8; i++) quad(0.9f - 0.2f * i);
}
static void depth_setup(void) { gl.Enable(GL_DEPTH_TEST); }

static void texture(int min, int mag) {
    for (int level = 0, side = 512; side > 0; level++, side /= 2) {
        for (int i = 0; i < side * side * 4; i++) pixels[i] = (unsigned char)(255 * chance());
        gl.TexImage2D(GL_TEXTURE_2D, level, GL_RGBA, side, side, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    }
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, min);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, mag);
    gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
    gl.Enable(GL_TEXTURE_2D);
}
static void nearest_setup(void) { texture(GL_NEAREST, GL_NEAREST); }
static void bilinear_setup(void) { texture(GL_LINEAR, GL_LINEAR); }
static void trilinear_setup(void) {
    texture(GL_LINEAR_MIPMAP_LINEAR, GL_LINEAR);
    perspective();
    gl.Rotatef(70, 1, 0, 0);
    gl.Scalef(2, 2, 1);
}
static void quads_frame(void) {
    clear_frame();
    for (int i = 0; i < 4; i++) quad(0);
}

static void blend_setup(void) {
    gl.Enable(GL_BLEND);
    gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
}
static void blend_frame(void) {
    clear_frame();
    for (int i = 0; i < 8; i++) {
        gl.Color4f(i / 8.0f, 1 - i / 8.0f, 0.5f, 0.3f);
        gl.Rectf(-1, -1, 1, 1);
    }
}

static void immediate_frame(void) {
    clear_frame();
    seed = 7;
    gl.Begin(GL_TRIANGLES);
    for (int i = 0; i < 100000; i++) {
        if (i % 3 == 0) gl.Color3f(chance(), chance(), chance());
        gl.Vertex2f(chance() * 0.02f + i % 97 / 50.0f - 1, chance() * 0.02f + i % 89 / 46.0f - 1);
    }
    gl.End();
}

static void strokes(GLenum kind) {
    clear_frame();
    seed = 9;
    gl.Begin(kind);
    for (int i = 0; i < 40000; i++) {
        gl.Color3f(chance(), chance(), 1);
        float x = chance() * 2 - 1, y = chance() * 2 - 1;
        gl.Vertex2f(x, y);
        if (kind == GL_LINES) gl.Vertex2f(x + chance() * 0.1f, y + chance() * 0.1f);
    }
    gl.End();
}
static void lines_frame(void) { strokes(GL_LINES); }
static void points_frame(void) { strokes(GL_POINTS); }

static void read_frame(void) { gl.ReadPixels(0, 0, SIDE, SIDE, GL_RGBA, GL_UNSIGNED_BYTE, pixels); }
static void write_frame(void) {
    gl.RasterPos2f(-1, -1);
    gl.DrawPixels(SIDE, SIDE, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
}
static void upload_frame(void) {
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 512, 512, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    gl.Rectf(-0.1f, -0.1f, 0.1f, 0.1f);
}

static void shadow_map_setup(void) {
    mesh_setup();
    gl.Disable(GL_LIGHTING);
    gl.ColorMask(0, 0, 0, 0);
}

static void volumes_setup(void) {
    mesh_setup();
    gl.NewList(2, GL_COMPILE);
    torus(64, 32, 0.5f);
    gl.EndList();
}
static void volumes_frame(void) {
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
    gl.CallList(2);
    gl.Enable(GL_STENCIL_TEST);
    gl.Enable(GL_CULL_FACE);
    gl.DepthMask(0);
    gl.ColorMask(0, 0, 0, 0);
    for (int back = 0; back < 2; back++) {
        gl.CullFace(back ? GL_FRONT : GL_BACK);
        gl.StencilFunc(GL_ALWAYS, 0, 255);
        gl.StencilOp(GL_KEEP, GL_KEEP, back ? GL_DECR : GL_INCR);
        for (int i = 0; i < 4; i++) {
            gl.PushMatrix();
            gl.Rotatef(20 * i, 1, 1, 0);
            gl.Scalef(1.2f, 1.2f, 3);
            gl.CallList(2);
            gl.PopMatrix();
        }
    }
    gl.DepthMask(1);
    gl.ColorMask(1, 1, 1, 1);
    gl.Disable(GL_CULL_FACE);
    gl.StencilFunc(GL_NOTEQUAL, 0, 255);
    gl.StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    gl.Disable(GL_LIGHTING);
    gl.Color3f(0, 0, 0);
    gl.Rectf(-3, -3, 3, 3);
    gl.Enable(GL_LIGHTING);
    gl.Disable(GL_STENCIL_TEST);
}

static void patch_setup(void) {
    GLfloat points[4][4][3];
    lit();
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            points[i][k][0] = k - 1.5f, points[i][k][1] = i - 1.5f;
            points[i][k][2] = (i % 3 == 0) == (k % 3 == 0) ? 0.5f : -0.5f;
        }
    gl.Map2f(GL_MAP2_VERTEX_3, 0, 1, 3, 4, 0, 1, 12, 4, &points[0][0][0]);
    gl.Enable(GL_MAP2_VERTEX_3);
    gl.Enable(GL_AUTO_NORMAL);
    gl.MapGrid2f(100, 0, 1, 100, 0, 1);
}
static void patch_frame(void) {
    clear_frame();
    gl.Rotatef(1, 1, 0.2f, 0);
    for (int i = 0; i < 4; i++) gl.EvalMesh2(GL_FILL, 0, 100, 0, 100);
}

static void nothing(void) {}

static const struct {
    const char *name;
    void (*setup)(void);
    void (*frame)(void);
} workloads[] = {
    {"clear", nothing, clear_frame},
    {"mesh of 100 000 triangles, lit", mesh_setup, mesh_frame},
    {"30 small wheels, a matrix and material each", wheels_setup, wheels_frame},
    {"8 shaded layers, back to front, with depth", depth_setup, gouraud_frame},
    {"4 layers of texture, nearest", nearest_setup, quads_frame},
    {"4 layers of texture, linear", bilinear_setup, quads_frame},
    {"4 layers of texture, mipmaps in perspective", trilinear_setup, quads_frame},
    {"8 blended layers", blend_setup, blend_frame},
    {"100 000 vertices one by one", nothing, immediate_frame},
    {"40 000 lines", nothing, lines_frame},
    {"40 000 points", nothing, points_frame},
    {"depth of 100 000 triangles", shadow_map_setup, mesh_frame},
    {"shadow volumes in the stencil buffer", volumes_setup, volumes_frame},
    {"evaluated surface of 40 000 quads", patch_setup, patch_frame},
    {"read 1024 x 1024 pixels", nothing, read_frame},
    {"draw 1024 x 1024 pixels", nothing, write_frame},
    {"upload 512 x 512 texels", bilinear_setup, upload_frame},
};
enum { WORKLOADS = sizeof workloads / sizeof workloads[0] };

typedef struct {
    double per_second, first;
} Speed;

/* In a process of its own: what a library makes of a workload. */
static Speed measured_here(const char *path, int workload, double seconds) {
    static unsigned char picture[SIDE * SIDE * 4];
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        _exit(2);
    }
    FUNCTIONS(LOAD)
    OSMesaContext (*create)(GLenum, GLint, GLint, GLint, OSMesaContext) =
        (OSMesaContext(*)(GLenum, GLint, GLint, GLint, OSMesaContext))need(library, "OSMesaCreateContextExt");
    GLboolean (*make_current)(OSMesaContext, void *, GLenum, GLsizei, GLsizei) =
        (GLboolean(*)(OSMesaContext, void *, GLenum, GLsizei, GLsizei))need(library, "OSMesaMakeCurrent");
    double start = now();
    OSMesaContext context = create(OSMESA_RGBA, 24, 8, 0, NULL);
    if (!context || !make_current(context, picture, GL_UNSIGNED_BYTE, SIDE, SIDE)) _exit(2);
    seed = 1;
    workloads[workload].setup();
    workloads[workload].frame();
    gl.Finish();
    Speed speed = {0, now() - start};
    int frames = 0;
    start = now();
    do {
        workloads[workload].frame();
        gl.Finish();
        frames++;
    } while (now() - start < seconds);
    speed.per_second = frames / (now() - start);
    if (gl.GetError() != GL_NO_ERROR) {
        fprintf(stderr, "%s: an error of OpenGL\n", workloads[workload].name);
        _exit(2);
    }
    return speed;
}

static Speed measured(const char *path, int workload, double seconds) {
    Speed speed = {0, 0};
    int ends[2];
    if (pipe(ends) != 0) exit(2);
    pid_t child = fork();
    if (child == 0) {
        speed = measured_here(path, workload, seconds);
        _exit(write(ends[1], &speed, sizeof speed) == sizeof speed ? 0 : 2);
    }
    close(ends[1]);
    if (child < 0 || read(ends[0], &speed, sizeof speed) != sizeof speed) {
        fprintf(stderr, "%s: no result\n", path);
        exit(2);
    }
    close(ends[0]);
    waitpid(child, NULL, 0);
    return speed;
}

static int rising(const void *a, const void *b) {
    double difference = *(const double *)a - *(const double *)b;
    return (difference > 0) - (difference < 0);
}

static double median(double *values, int count) {
    qsort(values, count, sizeof *values, rising);
    return values[count / 2];
}

int main(int count, char **words) {
    if (count < 2) {
        fprintf(stderr, "usage: speed LIBRARY [LIBRARY2] [SECONDS [ROUNDS [WORKLOAD]]]\n");
        return 2;
    }
    int libraries = count > 2 && atof(words[2]) == 0 && words[2][0] != '0' ? 2 : 1;
    int numbers = libraries + 1;
    double seconds = count > numbers ? atof(words[numbers]) : 0.3;
    int rounds = count > numbers + 1 ? atoi(words[numbers + 1]) : 5;
    const char *wanted = count > numbers + 2 ? words[numbers + 2] : "";
    if (rounds < 1 || rounds > MAX_ROUNDS) rounds = 5;
    double log_ratio = 0, log_first = 0;
    int measured_workloads = 0;
    for (int w = 0; w < WORKLOADS; w++) {
        if (!strstr(workloads[w].name, wanted)) continue;
        double rate[2][MAX_ROUNDS], first[2][MAX_ROUNDS], ratio[MAX_ROUNDS], first_ratio[MAX_ROUNDS];
        for (int r = 0; r < rounds; r++) {
            for (int l = 0; l < libraries; l++) {
                Speed speed = measured(words[1 + l], w, seconds);
                rate[l][r] = speed.per_second, first[l][r] = speed.first;
            }
            ratio[r] = libraries > 1 ? rate[0][r] / rate[1][r] : 1;
            first_ratio[r] = libraries > 1 ? first[1][r] / first[0][r] : 1;
        }
        printf("%-46s %8.1f/s  first %6.1f ms", workloads[w].name, median(rate[0], rounds),
               1e3 * median(first[0], rounds));
        if (libraries > 1) {
            double middle = median(ratio, rounds), early = median(first_ratio, rounds);
            printf("  | %8.1f/s %6.1f ms | %5.2f (%.2f to %.2f), first %5.2f (%.2f to %.2f)", median(rate[1], rounds),
                   1e3 * median(first[1], rounds), middle, ratio[0], ratio[rounds - 1], early, first_ratio[0],
                   first_ratio[rounds - 1]);
            log_ratio += log(middle), log_first += log(early);
        }
        printf("\n");
        fflush(stdout);
        measured_workloads++;
    }
    if (libraries > 1 && measured_workloads)
        printf("geometric mean: %.2f, first picture %.2f\n", exp(log_ratio / measured_workloads),
               exp(log_first / measured_workloads));
    return 0;
}

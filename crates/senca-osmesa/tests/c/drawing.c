/* Drawing: one by one, by lists, by arrays, with textures; reading back. */
#include "check.h"

static unsigned char picture[4 * SIZE * SIZE];

/* A triangle that covers the lower left half. */
static void triangle(void)
{
    glBegin(GL_TRIANGLES);
    glVertex2f(-1, -1);
    glVertex2f(1, -1);
    glVertex2f(-1, 1);
    glEnd();
}

static void clear(void)
{
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

static void one_by_one(void)
{
    const GLubyte yellow[] = {255, 255, 0};
    clear();
    glColor3ubv(yellow);
    triangle();
    glFinish();
    CHECK(is(picture, 10, 10, 255, 255, 0));
    CHECK(is(picture, 60, 60, 0, 0, 0));
}

static void lists(void)
{
    const GLubyte names[] = {0, 1};
    GLuint first = glGenLists(2);
    CHECK(first != 0 && glIsList(first + 1));
    glNewList(first, GL_COMPILE);
    glColor3d(0, 0, 1);
    glEndList();
    glNewList(first + 1, GL_COMPILE);
    triangle();
    glEndList();
    clear();
    glListBase(first);
    glCallLists(2, GL_UNSIGNED_BYTE, names);
    glFlush();
    CHECK(is(picture, 10, 10, 0, 0, 255));
    glDeleteLists(first, 2);
    glListBase(0);
}

static void arrays(void)
{
    const GLshort corners[] = {-1, -1, 1, -1, 1, 1, -1, 1};
    const GLubyte order[] = {0, 1, 2, 0, 2, 3};
    const GLfloat shift[] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    GLuint buffer;
    clear();
    glColor4f(0, 1, 0, 1);
    glLoadMatrixf(shift);
    glEnableClientState(GL_VERTEX_ARRAY);
    glVertexPointer(2, GL_SHORT, 0, corners);
    glDrawElements(GL_TRIANGLES, 6, GL_UNSIGNED_BYTE, order);
    glFinish();
    CHECK(is(picture, 60, 60, 0, 255, 0));

    /* The same from a buffer, with offsets in place of addresses. */
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferData(GL_ARRAY_BUFFER, sizeof corners, NULL, GL_STATIC_DRAW);
    memcpy(glMapBuffer(GL_ARRAY_BUFFER, GL_WRITE_ONLY), corners, sizeof corners);
    CHECK(glUnmapBuffer(GL_ARRAY_BUFFER));
    glVertexPointer(2, GL_SHORT, 0, (void *)0);
    glColor3f(1, 0, 0);
    glDrawArrays(GL_QUADS, 0, 4);
    glFinish();
    CHECK(is(picture, 60, 60, 255, 0, 0));
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    glDeleteBuffers(1, &buffer);
    glDisableClientState(GL_VERTEX_ARRAY);
}

static void textures(void)
{
    const GLubyte texels[] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};
    GLuint name;
    GLubyte back[16];
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_2D, name);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, 2, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels);
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, back);
    CHECK(memcmp(texels, back, sizeof back) == 0);
    glEnable(GL_TEXTURE_2D);
    glColor3f(1, 1, 1);
    clear();
    glBegin(GL_QUADS);
    glTexCoord2f(0, 0); glVertex2f(-1, -1);
    glTexCoord2f(1, 0); glVertex2f(1, -1);
    glTexCoord2f(1, 1); glVertex2f(1, 1);
    glTexCoord2f(0, 1); glVertex2f(-1, 1);
    glEnd();
    glFinish();
    CHECK(is(picture, 10, 10, 255, 0, 0));
    CHECK(is(picture, 50, 10, 0, 255, 0));
    CHECK(is(picture, 10, 50, 0, 0, 255));
    CHECK(is(picture, 50, 50, 255, 255, 255));
    glDisable(GL_TEXTURE_2D);
    glDeleteTextures(1, &name);
}

static void reading(void)
{
    GLushort red[4];
    GLfloat depth;
    glClearColor(1, 0.5, 0, 1);
    glClearDepth(0.25);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glReadPixels(3, 3, 2, 2, GL_RED, GL_UNSIGNED_SHORT, red);
    CHECK(red[0] == 65535 && red[3] == 65535);
    glReadPixels(0, 0, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    CHECK(depth > 0.2499f && depth < 0.2501f);
    glClearDepth(1);
}

static void selecting(void)
{
    GLuint hits[8] = {0};
    glSelectBuffer(8, hits);
    CHECK(glRenderMode(GL_SELECT) == 0);
    glInitNames();
    glPushName(42);
    triangle();
    CHECK(glRenderMode(GL_RENDER) == 1);
    CHECK(hits[0] == 1 && hits[3] == 42);
}

int main(void)
{
    OSMesaContext c = start(picture);
    CHECK(strncmp((const char *)glGetString(GL_VERSION), "1.5", 3) == 0);
    one_by_one();
    lists();
    arrays();
    textures();
    reading();
    selecting();
    stop(c);
    return failures != 0;
}

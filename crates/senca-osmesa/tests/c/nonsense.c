/* Nothing crashes: no context, NULL, names that are none, sizes out of all measure. */
#include "check.h"
#include <limits.h>

static unsigned char picture[4 * SIZE * SIZE];

/* Calls of all kinds, which may be wrong in any way but for memory they are promised. */
static void calls(void)
{
    static GLdouble d[64];
    static GLfloat f[64];
    static GLint i[64];
    const GLenum names[] = {0, 1, GL_RGBA, GL_TEXTURE_2D, GL_AMBIENT, GL_LIGHT0, 0xffffffffu, 0x7fffffff, GL_FRONT};
    const GLint numbers[] = {0, 1, -1, INT_MAX, INT_MIN, 31, 4096};
    for (size_t a = 0; a < sizeof names / sizeof *names; a++) {
        for (size_t b = 0; b < sizeof numbers / sizeof *numbers; b++) {
            GLenum e = names[a];
            GLint n = numbers[b];
            glEnable(e);
            glDisable(e);
            glIsEnabled(e);
            glMatrixMode(e);
            glLightfv(e, (GLenum)n, f);
            glMaterialiv(e, (GLenum)n, i);
            glTexEnvfv(e, e, f);
            glTexGendv(e, (GLenum)n, d);
            glTexParameteriv(e, (GLenum)n, i);
            glFogfv(e, f);
            glHint(e, (GLenum)n);
            glViewport(n, n, n, n);
            glScissor(n, n, n, n);
            glClipPlane(e, d);
            glGetIntegerv(e, i);
            glGetDoublev((GLenum)n, d);
            glPixelStorei(e, n);
            glPixelTransferi(e, n);
            glTexImage2D(e, n, n, n, n, n, e, e, NULL);
            glTexSubImage2D(e, n, n, n, n, n, e, e, NULL);
            glCopyTexImage2D(e, n, e, n, n, n, n, n);
            glCopyPixels(n, n, n, n, e);
            glDrawPixels(n, n, e, e, NULL);
            glReadPixels(n, n, n, n, e, e, NULL);
            glBitmap(n, n, 0, 0, 1, 1, NULL);
            glDrawArrays(e, n, n);
            glDrawElements(e, n, e, NULL);
            glVertexPointer(n, e, n, NULL);
            glMap1f(e, 0, 1, n, n, f);
            glMap2d(e, 0, 1, n, n, 0, 1, n, n, NULL);
            glMapGrid1f(n, 0, 1);
            glEvalMesh1(e, n, n);
            glEvalPoint2(n, n);
            glCallList((GLuint)n);
            glDeleteLists((GLuint)n, n);
            glNewList((GLuint)n, e);
            glEndList();
            glPushAttrib(e);
            glPopAttrib();
            glPopAttrib();
            glBindTexture(e, (GLuint)n);
            glBindBuffer(e, (GLuint)n);
            glBufferData(e, n, NULL, e);
            glRenderMode(e);
            glBegin(e);
            glVertex3f(0, 0, 0);
            glMatrixMode(GL_MODELVIEW);
            glEnd();
            glAccum(e, 1);
            glBindFramebuffer(e, (GLuint)n);
            glRenderbufferStorage(e, e, n, n);
            glCheckFramebufferStatus(e);
            glBlitFramebuffer(n, n, n, n, n, n, n, n, e, e);
            glBindFramebuffer(GL_FRAMEBUFFER, 0);
            glActiveTexture(GL_TEXTURE0 + (GLenum)n);
            glActiveTexture(GL_TEXTURE0);
            glRenderMode(GL_RENDER);
            glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
            while (glGetError() != GL_NO_ERROR)
                ;
        }
    }
}

/* NULL wherever there is a pointer. */
static void nulls(void)
{
    glColor3fv(NULL);
    glVertex4dv(NULL);
    glRectiv(NULL, NULL);
    glLoadMatrixf(NULL);
    glLightfv(GL_LIGHT0, GL_AMBIENT, NULL);
    glMaterialfv(GL_FRONT, GL_DIFFUSE, NULL);
    glCallLists(5, GL_UNSIGNED_BYTE, NULL);
    glGetFloatv(GL_MODELVIEW_MATRIX, NULL);
    glGetLightfv(GL_LIGHT0, GL_AMBIENT, NULL);
    glGetPointerv(GL_VERTEX_ARRAY_POINTER, NULL);
    glGenTextures(3, NULL);
    glDeleteTextures(3, NULL);
    glGenLists(INT_MAX);
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
    glPixelMapfv(GL_PIXEL_MAP_R_TO_R, 16, NULL);
    glPolygonStipple(NULL);
    glGetPolygonStipple(NULL);
    glSelectBuffer(10, NULL);
    glRenderMode(GL_SELECT);
    glPushName(1);
    glRenderMode(GL_RENDER);
    glEnableClientState(GL_VERTEX_ARRAY);
    glVertexPointer(3, GL_FLOAT, 0, NULL);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glArrayElement(7);
    glDisableClientState(GL_VERTEX_ARRAY);
    glMultiDrawArrays(GL_TRIANGLES, NULL, NULL, 3);
    glDebugMessageInsert(GL_DEBUG_SOURCE_APPLICATION, GL_DEBUG_TYPE_OTHER, 1, GL_DEBUG_SEVERITY_HIGH, -1, NULL);
    OSMesaGetIntegerv(OSMESA_WIDTH, NULL);
    OSMesaGetDepthBuffer(NULL, NULL, NULL, NULL, NULL);
    OSMesaGetColorBuffer(NULL, NULL, NULL, NULL, NULL);
    CHECK(OSMesaGetProcAddress(NULL) == NULL);
    CHECK(OSMesaGetProcAddress("glNoSuchThing") == NULL);
    CHECK(OSMesaGetProcAddress("glClear") == (OSMESAproc)glClear);
    OSMesaCreateContextAttribs(NULL, NULL);
    OSMesaDestroyContext(NULL);
    OSMesaPostprocess(NULL, NULL, 0);
}

int main(void)
{
    OSMesaContext c;
    /* Without a context. */
    calls();
    nulls();
    CHECK(glGetString(GL_VERSION) == NULL);
    CHECK(glGetError() == GL_NO_ERROR);
    CHECK(!OSMesaMakeCurrent(NULL, picture, GL_UNSIGNED_BYTE, SIZE, SIZE));

    c = start(picture);
    CHECK(!OSMesaMakeCurrent(c, NULL, GL_UNSIGNED_BYTE, SIZE, SIZE));
    CHECK(!OSMesaMakeCurrent(c, picture, GL_UNSIGNED_BYTE, 0, SIZE));
    CHECK(!OSMesaMakeCurrent(c, picture, GL_UNSIGNED_BYTE, INT_MAX, INT_MAX));
    CHECK(!OSMesaMakeCurrent(c, picture, 12345, SIZE, SIZE));
    CHECK(OSMesaGetCurrentContext() == c);
    calls();
    nulls();
    while (glGetError() != GL_NO_ERROR)
        ;
    /* It still draws. */
    glPopAttrib();
    OSMesaDestroyContext(c);
    OSMesaDestroyContext(c);
    CHECK(!OSMesaMakeCurrent(c, picture, GL_UNSIGNED_BYTE, SIZE, SIZE));
    c = start(picture);
    glClearColor(1, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glFinish();
    CHECK(is(picture, 1, 1, 255, 0, 0));
    stop(c);
    return failures != 0;
}

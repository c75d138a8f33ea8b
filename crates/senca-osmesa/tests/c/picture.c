/* Draws a lit, turned cube and writes the picture as a PPM. */
#include <GL/gl.h>
#include <GL/osmesa.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 320, HEIGHT = 240 };

static void cube(void)
{
    for (int axis = 0; axis < 3; axis++) {
        for (int side = -1; side <= 1; side += 2) {
            GLfloat corners[4][3], normal[3] = {0, 0, 0};
            normal[axis] = (GLfloat)side;
            for (int k = 0; k < 4; k++) {
                int u = (k == 1 || k == 2) ? 1 : -1, v = k >= 2 ? 1 : -1;
                corners[k][axis] = (GLfloat)side;
                corners[k][(axis + 1) % 3] = (GLfloat)(u * side);
                corners[k][(axis + 2) % 3] = (GLfloat)v;
            }
            glBegin(GL_QUADS);
            glNormal3fv(normal);
            for (int k = 0; k < 4; k++)
                glVertex3fv(corners[k]);
            glEnd();
        }
    }
}

int main(int count, char **arguments)
{
    unsigned char *picture = malloc(WIDTH * HEIGHT * 3);
    OSMesaContext context = OSMesaCreateContext(OSMESA_RGB, NULL);
    if (!picture || !context || !OSMesaMakeCurrent(context, picture, GL_UNSIGNED_BYTE, WIDTH, HEIGHT))
        return 1;
    /* Rows from top to bottom, as the file has them. */
    OSMesaPixelStore(OSMESA_Y_UP, 0);

    glEnable(GL_DEPTH_TEST);
    glEnable(GL_LIGHTING);
    glEnable(GL_LIGHT0);
    glMatrixMode(GL_PROJECTION);
    glFrustum(-0.4, 0.4, -0.3, 0.3, 1, 20);
    glMatrixMode(GL_MODELVIEW);
    glTranslatef(0, 0, -7);
    glRotatef(30, 1, 0, 0);
    glRotatef(35, 0, 1, 0);
    glClearColor(0.1f, 0.15f, 0.2f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    cube();
    glFinish();

    FILE *file = fopen(count > 1 ? arguments[1] : "picture.ppm", "wb");
    if (!file)
        return 1;
    fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
    fwrite(picture, 3, WIDTH * HEIGHT, file);
    fclose(file);
    OSMesaDestroyContext(context);
    free(picture);
    return 0;
}

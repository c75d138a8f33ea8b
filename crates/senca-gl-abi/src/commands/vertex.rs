//! Vertices one by one and what is said about them; raster positions.

use crate::memory::In;

components! { COMPONENTS:
    vertex(x y) x 2 {
        i16: glVertex2s, glVertex2sv;
        i32: glVertex2i, glVertex2iv;
        f32: glVertex2f, glVertex2fv;
        f64: glVertex2d, glVertex2dv;
    }
    vertex(x y z) x 3 {
        i16: glVertex3s, glVertex3sv;
        i32: glVertex3i, glVertex3iv;
        f32: glVertex3f, glVertex3fv;
        f64: glVertex3d, glVertex3dv;
    }
    vertex(x y z w) x 4 {
        i16: glVertex4s, glVertex4sv;
        i32: glVertex4i, glVertex4iv;
        f32: glVertex4f, glVertex4fv;
        f64: glVertex4d, glVertex4dv;
    }
    color(red green blue) x 3 {
        i8: glColor3b, glColor3bv;
        i16: glColor3s, glColor3sv;
        i32: glColor3i, glColor3iv;
        f32: glColor3f, glColor3fv;
        f64: glColor3d, glColor3dv;
        u8: glColor3ub, glColor3ubv;
        u16: glColor3us, glColor3usv;
        u32: glColor3ui, glColor3uiv;
    }
    color(red green blue alpha) x 4 {
        i8: glColor4b, glColor4bv;
        i16: glColor4s, glColor4sv;
        i32: glColor4i, glColor4iv;
        f32: glColor4f, glColor4fv;
        f64: glColor4d, glColor4dv;
        u8: glColor4ub, glColor4ubv;
        u16: glColor4us, glColor4usv;
        u32: glColor4ui, glColor4uiv;
    }
    secondary_color(red green blue) x 3 {
        i8: glSecondaryColor3b | glSecondaryColor3bEXT, glSecondaryColor3bv | glSecondaryColor3bvEXT;
        i16: glSecondaryColor3s | glSecondaryColor3sEXT, glSecondaryColor3sv | glSecondaryColor3svEXT;
        i32: glSecondaryColor3i | glSecondaryColor3iEXT, glSecondaryColor3iv | glSecondaryColor3ivEXT;
        f32: glSecondaryColor3f | glSecondaryColor3fEXT, glSecondaryColor3fv | glSecondaryColor3fvEXT;
        f64: glSecondaryColor3d | glSecondaryColor3dEXT, glSecondaryColor3dv | glSecondaryColor3dvEXT;
        u8: glSecondaryColor3ub | glSecondaryColor3ubEXT, glSecondaryColor3ubv | glSecondaryColor3ubvEXT;
        u16: glSecondaryColor3us | glSecondaryColor3usEXT, glSecondaryColor3usv | glSecondaryColor3usvEXT;
        u32: glSecondaryColor3ui | glSecondaryColor3uiEXT, glSecondaryColor3uiv | glSecondaryColor3uivEXT;
    }
    normal(x y z) x 3 {
        i8: glNormal3b, glNormal3bv;
        i16: glNormal3s, glNormal3sv;
        i32: glNormal3i, glNormal3iv;
        f32: glNormal3f, glNormal3fv;
        f64: glNormal3d, glNormal3dv;
    }
    tex_coord(s) x 1 {
        i16: glTexCoord1s, glTexCoord1sv;
        i32: glTexCoord1i, glTexCoord1iv;
        f32: glTexCoord1f, glTexCoord1fv;
        f64: glTexCoord1d, glTexCoord1dv;
    }
    tex_coord(s t) x 2 {
        i16: glTexCoord2s, glTexCoord2sv;
        i32: glTexCoord2i, glTexCoord2iv;
        f32: glTexCoord2f, glTexCoord2fv;
        f64: glTexCoord2d, glTexCoord2dv;
    }
    tex_coord(s t r) x 3 {
        i16: glTexCoord3s, glTexCoord3sv;
        i32: glTexCoord3i, glTexCoord3iv;
        f32: glTexCoord3f, glTexCoord3fv;
        f64: glTexCoord3d, glTexCoord3dv;
    }
    tex_coord(s t r q) x 4 {
        i16: glTexCoord4s, glTexCoord4sv;
        i32: glTexCoord4i, glTexCoord4iv;
        f32: glTexCoord4f, glTexCoord4fv;
        f64: glTexCoord4d, glTexCoord4dv;
    }
    multi_tex_coord[unit](s) x 1 {
        i16: glMultiTexCoord1s | glMultiTexCoord1sARB, glMultiTexCoord1sv | glMultiTexCoord1svARB;
        i32: glMultiTexCoord1i | glMultiTexCoord1iARB, glMultiTexCoord1iv | glMultiTexCoord1ivARB;
        f32: glMultiTexCoord1f | glMultiTexCoord1fARB, glMultiTexCoord1fv | glMultiTexCoord1fvARB;
        f64: glMultiTexCoord1d | glMultiTexCoord1dARB, glMultiTexCoord1dv | glMultiTexCoord1dvARB;
    }
    multi_tex_coord[unit](s t) x 2 {
        i16: glMultiTexCoord2s | glMultiTexCoord2sARB, glMultiTexCoord2sv | glMultiTexCoord2svARB;
        i32: glMultiTexCoord2i | glMultiTexCoord2iARB, glMultiTexCoord2iv | glMultiTexCoord2ivARB;
        f32: glMultiTexCoord2f | glMultiTexCoord2fARB, glMultiTexCoord2fv | glMultiTexCoord2fvARB;
        f64: glMultiTexCoord2d | glMultiTexCoord2dARB, glMultiTexCoord2dv | glMultiTexCoord2dvARB;
    }
    multi_tex_coord[unit](s t r) x 3 {
        i16: glMultiTexCoord3s | glMultiTexCoord3sARB, glMultiTexCoord3sv | glMultiTexCoord3svARB;
        i32: glMultiTexCoord3i | glMultiTexCoord3iARB, glMultiTexCoord3iv | glMultiTexCoord3ivARB;
        f32: glMultiTexCoord3f | glMultiTexCoord3fARB, glMultiTexCoord3fv | glMultiTexCoord3fvARB;
        f64: glMultiTexCoord3d | glMultiTexCoord3dARB, glMultiTexCoord3dv | glMultiTexCoord3dvARB;
    }
    multi_tex_coord[unit](s t r q) x 4 {
        i16: glMultiTexCoord4s | glMultiTexCoord4sARB, glMultiTexCoord4sv | glMultiTexCoord4svARB;
        i32: glMultiTexCoord4i | glMultiTexCoord4iARB, glMultiTexCoord4iv | glMultiTexCoord4ivARB;
        f32: glMultiTexCoord4f | glMultiTexCoord4fARB, glMultiTexCoord4fv | glMultiTexCoord4fvARB;
        f64: glMultiTexCoord4d | glMultiTexCoord4dARB, glMultiTexCoord4dv | glMultiTexCoord4dvARB;
    }
    raster_pos(x y) x 2 {
        i16: glRasterPos2s, glRasterPos2sv;
        i32: glRasterPos2i, glRasterPos2iv;
        f32: glRasterPos2f, glRasterPos2fv;
        f64: glRasterPos2d, glRasterPos2dv;
    }
    raster_pos(x y z) x 3 {
        i16: glRasterPos3s, glRasterPos3sv;
        i32: glRasterPos3i, glRasterPos3iv;
        f32: glRasterPos3f, glRasterPos3fv;
        f64: glRasterPos3d, glRasterPos3dv;
    }
    raster_pos(x y z w) x 4 {
        i16: glRasterPos4s, glRasterPos4sv;
        i32: glRasterPos4i, glRasterPos4iv;
        f32: glRasterPos4f, glRasterPos4fv;
        f64: glRasterPos4d, glRasterPos4dv;
    }
    window_pos(x y) x 2 {
        i16: glWindowPos2s | glWindowPos2sARB | glWindowPos2sMESA, glWindowPos2sv | glWindowPos2svARB | glWindowPos2svMESA;
        i32: glWindowPos2i | glWindowPos2iARB | glWindowPos2iMESA, glWindowPos2iv | glWindowPos2ivARB | glWindowPos2ivMESA;
        f32: glWindowPos2f | glWindowPos2fARB | glWindowPos2fMESA, glWindowPos2fv | glWindowPos2fvARB | glWindowPos2fvMESA;
        f64: glWindowPos2d | glWindowPos2dARB | glWindowPos2dMESA, glWindowPos2dv | glWindowPos2dvARB | glWindowPos2dvMESA;
    }
    window_pos(x y z) x 3 {
        i16: glWindowPos3s | glWindowPos3sARB | glWindowPos3sMESA, glWindowPos3sv | glWindowPos3svARB | glWindowPos3svMESA;
        i32: glWindowPos3i | glWindowPos3iARB | glWindowPos3iMESA, glWindowPos3iv | glWindowPos3ivARB | glWindowPos3ivMESA;
        f32: glWindowPos3f | glWindowPos3fARB | glWindowPos3fMESA, glWindowPos3fv | glWindowPos3fvARB | glWindowPos3fvMESA;
        f64: glWindowPos3d | glWindowPos3dARB | glWindowPos3dMESA, glWindowPos3dv | glWindowPos3dvARB | glWindowPos3dvMESA;
    }
}

commands! { SINGLE, c:
    glIndexub(index: u8) { c.index(index) }
    glIndexubv(v: In<u8>) { if let Some([v]) = v.array() { c.index(v) } }
    glIndexs(index: i16) { c.index(index) }
    glIndexsv(v: In<i16>) { if let Some([v]) = v.array() { c.index(v) } }
    glIndexi(index: i32) { c.index(index) }
    glIndexiv(v: In<i32>) { if let Some([v]) = v.array() { c.index(v) } }
    glIndexf(index: f32) { c.index(index) }
    glIndexfv(v: In<f32>) { if let Some([v]) = v.array() { c.index(v) } }
    glIndexd(index: f64) { c.index(index) }
    glIndexdv(v: In<f64>) { if let Some([v]) = v.array() { c.index(v) } }
    glFogCoordf | glFogCoordfEXT(coord: f32) { c.fog_coord(coord) }
    glFogCoordfv | glFogCoordfvEXT(v: In<f32>) { if let Some([v]) = v.array() { c.fog_coord(v) } }
    glFogCoordd | glFogCoorddEXT(coord: f64) { c.fog_coord(coord) }
    glFogCoorddv | glFogCoorddvEXT(v: In<f64>) { if let Some([v]) = v.array() { c.fog_coord(v) } }
    glEdgeFlag(flag: u8) { c.edge_flag(flag != 0) }
    glEdgeFlagv(v: In<u8>) { if let Some([v]) = v.array() { c.edge_flag(v != 0) } }
    glBegin(mode: u32) { c.begin(mode) }
    glEnd() { c.end() }
    glRects(x1: i16, y1: i16, x2: i16, y2: i16) { c.rect([x1, y1], [x2, y2]) }
    glRectsv(a: In<i16>, b: In<i16>) {
        if let (Some(a), Some(b)) = (a.array(), b.array()) { c.rect(a, b) }
    }
    glRecti(x1: i32, y1: i32, x2: i32, y2: i32) { c.rect([x1, y1], [x2, y2]) }
    glRectiv(a: In<i32>, b: In<i32>) {
        if let (Some(a), Some(b)) = (a.array(), b.array()) { c.rect(a, b) }
    }
    glRectf(x1: f32, y1: f32, x2: f32, y2: f32) { c.rect([x1, y1], [x2, y2]) }
    glRectfv(a: In<f32>, b: In<f32>) {
        if let (Some(a), Some(b)) = (a.array(), b.array()) { c.rect(a, b) }
    }
    glRectd(x1: f64, y1: f64, x2: f64, y2: f64) { c.rect([x1, y1], [x2, y2]) }
    glRectdv(a: In<f64>, b: In<f64>) {
        if let (Some(a), Some(b)) = (a.array(), b.array()) { c.rect(a, b) }
    }
}

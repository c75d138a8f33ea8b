//! Parameters of lights, materials, fog, points, environments and generated coordinates: a name with one
//! value or with several.

use crate::memory::{Few, In};
use senca_gl::{Component, gl};

/// How many values a parameter has.
pub(crate) fn count(name: u32) -> i32 {
    match name {
        gl::SPOT_DIRECTION | gl::COLOR_INDEXES | gl::POINT_DISTANCE_ATTENUATION => 3,
        gl::POSITION | gl::OBJECT_PLANE | gl::EYE_PLANE => 4,
        _ if is_color(name) => 4,
        _ => 1,
    }
}

/// Whether a parameter is a colour: then integers are spread over -1 to 1.
pub(crate) fn is_color(name: u32) -> bool {
    matches!(
        name,
        gl::AMBIENT
            | gl::DIFFUSE
            | gl::SPECULAR
            | gl::EMISSION
            | gl::AMBIENT_AND_DIFFUSE
            | gl::LIGHT_MODEL_AMBIENT
            | gl::FOG_COLOR
            | gl::TEXTURE_ENV_COLOR
            | gl::TEXTURE_BORDER_COLOR
    )
}

/// Values of a parameter as floating point; none for NULL.
pub(crate) fn values<T: Component + crate::memory::Plain>(name: u32, v: In<T>) -> Few<f32> {
    let number = |v: T| if is_color(name) { v.normalized() } else { v.value() };
    v.values(count(name)).unwrap_or_default().into_iter().map(number).collect()
}

/// A parameter given as a number. Of several values, as programs may rely on, the others are 0.
pub(crate) fn one<T: Component>(name: u32, v: T) -> Few<f32> {
    let mut values = smallvec::smallvec![0.0; count(name) as usize];
    values[0] = if is_color(name) { v.normalized() } else { v.value() };
    values
}

commands! { COMMANDS, c:
    glLightf(light: u32, name: u32, v: f32) { c.light(light, name, &one(name, v)) }
    glLighti(light: u32, name: u32, v: i32) { c.light(light, name, &one(name, v)) }
    glLightfv(light: u32, name: u32, v: In<f32>) { c.light(light, name, &values(name, v)) }
    glLightiv(light: u32, name: u32, v: In<i32>) { c.light(light, name, &values(name, v)) }

    glLightModelf(name: u32, v: f32) { c.light_model(name, &one(name, v)) }
    glLightModeli(name: u32, v: i32) { c.light_model(name, &one(name, v)) }
    glLightModelfv(name: u32, v: In<f32>) { c.light_model(name, &values(name, v)) }
    glLightModeliv(name: u32, v: In<i32>) { c.light_model(name, &values(name, v)) }

    glMaterialf(face: u32, name: u32, v: f32) { c.material(face, name, &one(name, v)) }
    glMateriali(face: u32, name: u32, v: i32) { c.material(face, name, &one(name, v)) }
    glMaterialfv(face: u32, name: u32, v: In<f32>) { c.material(face, name, &values(name, v)) }
    glMaterialiv(face: u32, name: u32, v: In<i32>) { c.material(face, name, &values(name, v)) }

    glFogf(name: u32, v: f32) { c.fog(name, &one(name, v)) }
    glFogi(name: u32, v: i32) { c.fog(name, &one(name, v)) }
    glFogfv(name: u32, v: In<f32>) { c.fog(name, &values(name, v)) }
    glFogiv(name: u32, v: In<i32>) { c.fog(name, &values(name, v)) }

    glPointParameterf | glPointParameterfARB | glPointParameterfEXT(name: u32, v: f32) {
        c.point_parameter(name, &one(name, v))
    }
    glPointParameteri(name: u32, v: i32) { c.point_parameter(name, &one(name, v)) }
    glPointParameterfv | glPointParameterfvARB | glPointParameterfvEXT(name: u32, v: In<f32>) {
        c.point_parameter(name, &values(name, v))
    }
    glPointParameteriv(name: u32, v: In<i32>) { c.point_parameter(name, &values(name, v)) }

    glTexEnvf(target: u32, name: u32, v: f32) { c.tex_env(target, name, &one(name, v)) }
    glTexEnvi(target: u32, name: u32, v: i32) { c.tex_env(target, name, &one(name, v)) }
    glTexEnvfv(target: u32, name: u32, v: In<f32>) { c.tex_env(target, name, &values(name, v)) }
    glTexEnviv(target: u32, name: u32, v: In<i32>) { c.tex_env(target, name, &values(name, v)) }

    glTexGenf(coordinate: u32, name: u32, v: f32) { c.tex_gen(coordinate, name, &one(name, v)) }
    glTexGend(coordinate: u32, name: u32, v: f64) { c.tex_gen(coordinate, name, &one(name, v)) }
    glTexGeni(coordinate: u32, name: u32, v: i32) { c.tex_gen(coordinate, name, &one(name, v)) }
    glTexGenfv(coordinate: u32, name: u32, v: In<f32>) { c.tex_gen(coordinate, name, &values(name, v)) }
    glTexGendv(coordinate: u32, name: u32, v: In<f64>) { c.tex_gen(coordinate, name, &values(name, v)) }
    glTexGeniv(coordinate: u32, name: u32, v: In<i32>) { c.tex_gen(coordinate, name, &values(name, v)) }
}

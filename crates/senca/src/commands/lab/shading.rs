//! `senca lab 7`: wireframe, constant and Gouraud shading.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use senca::math::glam::DVec3;
use senca_classic::lab::programs::ShadingProgram;
use senca_classic::lab::shading::{
    Camera, Light, Mode, average_normals, vertex_normals, view_angles, view_values,
};
use serde_json::json;

use super::{CameraArguments, Failure, Shown, read_solid, row};
use crate::cli::values::{not_negative, share, triple};

/// Faces and vertices that are printed.
const PRINTED: usize = 100;

/// The solid, the eye and the light.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// OBJ file, or another model; scaled to [-1, 1]; - is standard input
    #[arg(value_name = "MODEL", value_hint = ValueHint::FilePath)]
    model: PathBuf,

    /// How it is drawn: all edges, edges of front faces, an intensity for each face or each vertex
    #[arg(long, value_name = "NAME", value_parser = ["wire", "wire-front", "constant", "gouraud"], default_value = "gouraud")]
    shading: String,

    /// Where the light is
    #[arg(long, value_name = "X,Y,Z", default_value = "2,4,6", allow_hyphen_values = true, value_parser = triple)]
    light: DVec3,

    /// Ia, intensity from all around
    #[arg(long, value_name = "N", default_value = "100", value_parser = not_negative)]
    ia: f64,

    /// ka, share of it that is sent on
    #[arg(long, value_name = "N", default_value = "0.5", value_parser = share)]
    ka: f64,

    /// Ii, intensity of the light
    #[arg(long, value_name = "N", default_value = "200", value_parser = not_negative)]
    ii: f64,

    /// kd, share of it that is scattered
    #[arg(long, value_name = "N", default_value = "0.8", value_parser = share)]
    kd: f64,

    #[command(flatten)]
    camera: CameraArguments,

    #[command(flatten)]
    shown: Shown,
}

impl Arguments {
    fn light(&self) -> Light {
        Light {
            position: self.light.to_array(),
            ambient: self.ia,
            ambient_share: self.ka,
            intensity: self.ii,
            diffuse_share: self.kd,
        }
    }

    fn mode(&self) -> Mode {
        match self.shading.as_str() {
            "wire" => Mode::Wire,
            "wire-front" => Mode::WireFront,
            "constant" => Mode::Constant,
            _ => Mode::Gouraud,
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let solid = read_solid(&arguments.model)?.normalized()?;
    let camera = arguments.camera.camera(Camera::default());
    camera.transform()?;
    let light = arguments.light();
    let values = view_values(&solid, camera.eye);
    let angles = view_angles(&solid, camera.eye);
    let faces = light.face_intensities(&solid);
    let (averages, normals) = (average_normals(&solid), vertex_normals(&solid));
    let vertices = light.vertex_intensities(&solid);

    let visible: Vec<usize> = (0..values.len()).filter(|&i| values[i] > 0.0).map(|i| i + 1).collect();
    let mut text = format!("{} of {} faces are seen from the eye\n", visible.len(), values.len());
    text += "face: value at the eye, angle in degrees, intensity\n";
    for i in 0..values.len().min(PRINTED) {
        text += &format!("  {:>4}  {}\n", i + 1, row(&[values[i], angles[i], faces[i]]));
    }
    text += "vertex: unit normal, intensity\n";
    for i in 0..vertices.len().min(PRINTED) {
        let [x, y, z] = normals[i];
        text += &format!("  {:>4}  {}\n", i + 1, row(&[x, y, z, vertices[i]]));
    }
    if values.len().max(vertices.len()) > PRINTED {
        text += "and more; --json has all\n";
    }
    let json = json!({
        "visible": visible, "values": values, "angles": angles, "face_intensities": faces,
        "average_normals": averages, "normals": normals, "vertex_intensities": vertices,
    });
    arguments.shown.print(&text, &json)?;
    arguments.shown.present(&mut ShadingProgram::new(&solid, camera, light, arguments.mode())?, "lab-7")
}

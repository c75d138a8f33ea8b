//! Whether a scene holds together, and mending what readers must live with.

use senca_math::LinearRgb;
use senca_math::glam::{DMat4, DQuat, DVec3};

use crate::{
    Animation, Attenuation, Background, Camera, Channel, ChannelValues, FogFalloff, ImageData, Interpolation,
    Light, LightKind, Material, Node, NodeId, Projection, Reflection, Scene, SceneError, Shape, SpotFalloff,
    TextureRef, Transform, Warning,
};

type Check = Result<(), SceneError>;

fn index(what: impl Fn() -> String, kind: &'static str, index: u32, count: usize) -> Check {
    if (index as usize) < count {
        return Ok(());
    }
    Err(SceneError::IndexOutOfRange { what: what(), kind, index, count })
}

fn number(what: impl Fn() -> String, value: f64, ok: bool, expected: &'static str) -> Check {
    if ok && value.is_finite() {
        return Ok(());
    }
    Err(SceneError::Number { what: what(), value, expected })
}

fn invalid(what: String, reason: impl Into<String>) -> Check {
    Err(SceneError::Invalid { what, reason: reason.into() })
}

/// Name of an entry for messages: its kind, number and, where it has one, name.
fn named(kind: &str, i: usize, name: &str) -> String {
    if name.is_empty() { format!("{kind} {i}") } else { format!("{kind} {i} (\"{name}\")") }
}

impl Scene {
    /// Checks everything that renderers rely on: indices name entries, nodes form trees, transforms
    /// and colours are finite, meshes hold together (see [`crate::Mesh::check`]), numbers are in the
    /// ranges that their fields document, keys of animations fit their values.
    ///
    /// Parameters of shapes are checked where shapes are used, by [`crate::tessellate`].
    ///
    /// # Errors
    /// [`SceneError`] for the first thing found wrong.
    pub fn validate(&self) -> Check {
        self.nodes.iter().enumerate().try_for_each(|(i, node)| self.check_node(i, node))?;
        self.roots
            .iter()
            .try_for_each(|r| index(|| "the list of roots".to_owned(), "node", r.0, self.nodes.len()))?;
        self.check_trees()?;
        for (i, geometry) in self.geometries.iter().enumerate() {
            self.check_geometry(&named("geometry", i, &geometry.name), geometry)?;
        }
        for (i, material) in self.materials.iter().enumerate() {
            self.check_material(&named("material", i, &material.name), material)?;
        }
        for (i, texture) in self.textures.iter().enumerate() {
            index(|| named("texture", i, &texture.name), "image", texture.image.0, self.images.len())?;
        }
        self.images
            .iter()
            .enumerate()
            .try_for_each(|(i, image)| check_image(&named("image", i, &image.name), &image.data))?;
        self.lights
            .iter()
            .enumerate()
            .try_for_each(|(i, light)| check_light(&named("light", i, &light.name), light))?;
        self.cameras
            .iter()
            .enumerate()
            .try_for_each(|(i, camera)| check_camera(&named("camera", i, &camera.name), camera))?;
        self.check_skins()?;
        self.animations
            .iter()
            .enumerate()
            .try_for_each(|(i, a)| self.check_animation(&named("animation", i, &a.name), a))?;
        self.check_surroundings()
    }

    fn check_node(&self, i: usize, node: &Node) -> Check {
        let what = || named("node", i, &node.name);
        node.children.iter().try_for_each(|child| index(what, "node", child.0, self.nodes.len()))?;
        node.geometry.map_or(Ok(()), |id| index(what, "geometry", id.0, self.geometries.len()))?;
        node.material.map_or(Ok(()), |id| index(what, "material", id.0, self.materials.len()))?;
        node.light.map_or(Ok(()), |id| index(what, "light", id.0, self.lights.len()))?;
        node.camera.map_or(Ok(()), |id| index(what, "camera", id.0, self.cameras.len()))?;
        node.skin.map_or(Ok(()), |id| index(what, "skin", id.0, self.skins.len()))?;
        if !is_finite(&node.transform) {
            return invalid(what(), "its transform has numbers that are not finite");
        }
        if !node.morph_weights.iter().all(|w| w.is_finite()) {
            return invalid(what(), "its morph weights are not all finite");
        }
        Ok(())
    }

    /// Every node has at most one parent, roots have none, and nothing is its own ancestor.
    fn check_trees(&self) -> Check {
        let mut reached = vec![false; self.nodes.len()];
        let links = self.nodes.iter().flat_map(|node| &node.children).chain(&self.roots);
        for id in links {
            if std::mem::replace(&mut reached[id.index()], true) {
                return Err(SceneError::NotATree { node: id.0 });
            }
        }
        // With one parent each, what is left unreached from parentless nodes runs in circles.
        let mut seen = vec![false; self.nodes.len()];
        let parentless = (0..self.nodes.len()).filter(|&i| !reached[i]).map(|i| NodeId(i as u32));
        let mut open: Vec<NodeId> = self.roots.iter().copied().chain(parentless).collect();
        while let Some(id) = open.pop() {
            seen[id.index()] = true;
            open.extend(&self.nodes[id.index()].children);
        }
        let circling = seen.iter().position(|seen| !seen);
        circling.map_or(Ok(()), |node| Err(SceneError::NotATree { node: node as u32 }))
    }

    fn check_geometry(&self, what: &str, geometry: &crate::Geometry) -> Check {
        let material =
            |id: crate::MaterialId| index(|| what.to_owned(), "material", id.0, self.materials.len());
        geometry.material.map_or(Ok(()), material)?;
        self.check_shape(what, &geometry.shape)
    }

    /// What of a shape is checked before it is used: meshes, trees of bodies, materials.
    fn check_shape(&self, what: &str, shape: &Shape) -> Check {
        let material =
            |id: crate::MaterialId| index(|| what.to_owned(), "material", id.0, self.materials.len());
        match shape {
            Shape::Mesh(mesh) => {
                mesh.check()
                    .and_then(|()| mesh.check_finite())
                    .map_err(|error| SceneError::Mesh { what: what.to_owned(), error })?;
                mesh.surfaces.iter().filter_map(|s| s.material).try_for_each(material)
            }
            Shape::Csg(csg) => {
                csg.check().map_err(|error| SceneError::Invalid {
                    what: what.to_owned(),
                    reason: error.to_string(),
                })?;
                let leaves = csg.leaves();
                leaves.iter().filter_map(|leaf| leaf.material).try_for_each(material)?;
                leaves.iter().try_for_each(|leaf| self.check_shape(what, &leaf.shape))
            }
            _ => Ok(()),
        }
    }

    fn check_material(&self, what: &str, material: &Material) -> Check {
        for texture in texture_refs(material) {
            index(|| what.to_owned(), "texture", texture.texture.0, self.textures.len())?;
            if texture.texcoord > 1 {
                return invalid(
                    what.to_owned(),
                    format!("a texture uses coordinate set {}; there are 0 and 1", texture.texcoord),
                );
            }
            if !texture.uv_transform.is_finite() || !texture.strength.is_finite() {
                return invalid(what.to_owned(), "a texture's transform or strength is not finite");
            }
        }
        let colors = material_colors(material);
        if !colors.iter().all(|c| c.is_finite() && c.r >= 0.0 && c.g >= 0.0 && c.b >= 0.0) {
            return invalid(what.to_owned(), "a colour is negative or not finite");
        }
        number(
            || format!("{what}: index of refraction"),
            f64::from(material.ior),
            material.ior > 0.0,
            "above 0",
        )?;
        match &material.reflection {
            Reflection::Phong(p) => {
                number(|| format!("{what}: exponent"), f64::from(p.exponent), p.exponent >= 0.0, "0 or more")
            }
            Reflection::MetallicRoughness(m) => {
                let unit = |name: &'static str, x: f32| {
                    number(|| format!("{what}: {name}"), f64::from(x), (0.0..=1.0).contains(&x), "in 0 to 1")
                };
                unit("metallic", m.metallic).and_then(|()| unit("roughness", m.roughness))
            }
        }
    }

    fn check_skins(&self) -> Check {
        for (i, skin) in self.skins.iter().enumerate() {
            let what = || named("skin", i, &skin.name);
            skin.joints.iter().try_for_each(|joint| index(what, "node", joint.0, self.nodes.len()))?;
            let matrices = skin.inverse_bind_matrices.len();
            if matrices != 0 && matrices != skin.joints.len() {
                return invalid(
                    what(),
                    format!("it has {matrices} inverse bind matrices for {} joints", skin.joints.len()),
                );
            }
            if !skin.inverse_bind_matrices.iter().all(DMat4::is_finite) {
                return invalid(what(), "an inverse bind matrix is not finite");
            }
        }
        Ok(())
    }

    fn check_animation(&self, what: &str, animation: &Animation) -> Check {
        for (i, channel) in animation.channels.iter().enumerate() {
            let what = || format!("{what}, channel {i}");
            index(what, "node", channel.target.node.0, self.nodes.len())?;
            check_channel(&what(), channel)?;
        }
        Ok(())
    }

    fn check_surroundings(&self) -> Check {
        let colors = match self.background {
            Background::None => [LinearRgb::BLACK; 2],
            Background::Color(color) => [color; 2],
            Background::Gradient { bottom, top } => [bottom, top],
            Background::Environment { image, strength, rotation } => {
                let what = || "the background".to_owned();
                index(what, "image", image.0, self.images.len())?;
                number(what, f64::from(strength), strength >= 0.0, "a strength of 0 or more")?;
                number(what, f64::from(rotation), true, "a finite rotation")?;
                [LinearRgb::BLACK; 2]
            }
        };
        if !colors.iter().chain([&self.ambient]).all(|c| c.is_finite()) {
            return invalid("the scene".to_owned(), "background or ambient light is not finite");
        }
        let Some(fog) = &self.fog else { return Ok(()) };
        let what = || "fog".to_owned();
        if !fog.color.is_finite() {
            return invalid(what(), "its colour is not finite");
        }
        match fog.falloff {
            FogFalloff::Linear { start, end, min_share } => {
                number(what, start, start >= 0.0, "a start of 0 or more")?;
                number(what, end, end > start, "an end beyond the start")?;
                number(what, min_share, (0.0..=1.0).contains(&min_share), "a share in 0 to 1")
            }
            FogFalloff::Exponential { density } | FogFalloff::ExponentialSquared { density } => {
                number(what, density, density >= 0.0, "a density of 0 or more")
            }
        }
    }

    /// Mends what a reader should live with, and says so: transforms, weights and colours that are not
    /// finite are replaced by neutral ones; indices that name nothing, second parents, and circles are
    /// cut; channels and skins that do not hold together are dropped or cleared; meshes with broken
    /// lists are emptied. Afterwards [`Scene::validate`] finds no fault with nodes, meshes, skins and
    /// animations. Returns the warnings, which are also added to [`Scene::warnings`].
    pub fn sanitize(&mut self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        self.mend_nodes(&mut warnings);
        self.cut_to_trees(&mut warnings);
        self.mend_meshes(&mut warnings);
        self.mend_skins(&mut warnings);
        self.drop_channels(&mut warnings);
        self.warnings.extend(warnings.iter().cloned());
        warnings
    }

    fn mend_nodes(&mut self, warnings: &mut Vec<Warning>) {
        let counts = [
            self.geometries.len(),
            self.materials.len(),
            self.lights.len(),
            self.cameras.len(),
            self.skins.len(),
        ];
        for (i, node) in self.nodes.iter_mut().enumerate() {
            let mut dropped: Vec<&str> = Vec::new();
            if node.geometry.take_if(|id| id.index() >= counts[0]).is_some() {
                dropped.push("geometry");
            }
            if node.material.take_if(|id| id.index() >= counts[1]).is_some() {
                dropped.push("material");
            }
            if node.light.take_if(|id| id.index() >= counts[2]).is_some() {
                dropped.push("light");
            }
            if node.camera.take_if(|id| id.index() >= counts[3]).is_some() {
                dropped.push("camera");
            }
            if node.skin.take_if(|id| id.index() >= counts[4]).is_some() {
                dropped.push("skin");
            }
            if !is_finite(&node.transform) {
                node.transform = Transform::default();
                dropped.push("transform");
            }
            if node.morph_weights.iter().any(|w| !w.is_finite()) {
                node.morph_weights.iter_mut().filter(|w| !w.is_finite()).for_each(|w| *w = 0.0);
                dropped.push("morph weight");
            }
            if !dropped.is_empty() {
                warnings.push(Warning(format!(
                    "{}: unusable {} dropped",
                    named("node", i, &node.name),
                    dropped.join(", ")
                )));
            }
        }
    }

    /// Keeps the link to every node by which [`Scene::world_from_nodes`] reaches it, and drops others.
    fn cut_to_trees(&mut self, warnings: &mut Vec<Warning>) {
        let mut parents = Parents(vec![None; self.nodes.len()]);
        parents.walk(self, self.roots.iter().rev().map(|&root| (Parent::Root, root)).collect());
        // Trees that no root reaches stay trees; what is left after them runs in circles.
        let mut has_parent = vec![false; self.nodes.len()];
        let children = self.nodes.iter().flat_map(|node| &node.children);
        children.for_each(|child| has_parent.get_mut(child.index()).into_iter().for_each(|has| *has = true));
        for parentless in [true, false] {
            for i in (0..self.nodes.len()).filter(|&i| has_parent[i] != parentless) {
                parents.walk(self, vec![(Parent::Loose, NodeId(i as u32))]);
            }
        }
        let before = self.roots.len() + self.nodes.iter().map(|node| node.children.len()).sum::<usize>();
        self.roots.retain(|&root| parents.takes(Parent::Root, root));
        for (i, node) in self.nodes.iter_mut().enumerate() {
            node.children.retain(|&child| parents.takes(Parent::Node(i), child));
        }
        let after = self.roots.len() + self.nodes.iter().map(|node| node.children.len()).sum::<usize>();
        if before > after {
            warnings.push(Warning(format!(
                "{} links between nodes dropped: nodes must form trees",
                before - after
            )));
        }
    }

    fn mend_meshes(&mut self, warnings: &mut Vec<Warning>) {
        let materials = self.materials.len();
        for (i, geometry) in self.geometries.iter_mut().enumerate() {
            let what = named("geometry", i, &geometry.name);
            if geometry.material.take_if(|id| id.index() >= materials).is_some() {
                warnings.push(Warning(format!("{what}: unusable material dropped")));
            }
            if let Shape::Csg(csg) = &mut geometry.shape {
                for leaf in csg.leaves_mut() {
                    leaf.material.take_if(|id| id.index() >= materials);
                }
            }
            let Shape::Mesh(mesh) = &mut geometry.shape else { continue };
            for surface in &mut mesh.surfaces {
                surface.material.take_if(|id| id.index() >= materials);
            }
            if let Err(error) = mesh.check() {
                warnings.push(Warning(format!("{what}: mesh left out: {error}")));
                *mesh = crate::Mesh::default();
            }
            if let Err(error) = mesh.check_finite() {
                warnings.push(Warning(format!("{what}: numbers replaced: {error}")));
                mend_numbers(mesh);
            }
        }
    }

    fn mend_skins(&mut self, warnings: &mut Vec<Warning>) {
        let nodes = self.nodes.len();
        for (i, skin) in self.skins.iter_mut().enumerate() {
            let matrices = skin.inverse_bind_matrices.len();
            let whole = skin.joints.iter().all(|joint| joint.index() < nodes)
                && (matrices == 0 || matrices == skin.joints.len())
                && skin.inverse_bind_matrices.iter().all(DMat4::is_finite);
            if !whole {
                warnings.push(Warning(format!("{}: skin left out", named("skin", i, &skin.name))));
                skin.joints.clear();
                skin.inverse_bind_matrices.clear();
            }
        }
    }

    fn drop_channels(&mut self, warnings: &mut Vec<Warning>) {
        let nodes = self.nodes.len();
        for (i, animation) in self.animations.iter_mut().enumerate() {
            let before = animation.channels.len();
            animation.channels.retain(|c| c.target.node.index() < nodes && check_channel("", c).is_ok());
            let dropped = before - animation.channels.len();
            if dropped > 0 {
                warnings.push(Warning(format!(
                    "{}: {dropped} unusable channels dropped",
                    named("animation", i, &animation.name)
                )));
            }
        }
    }
}

/// Where a node hangs.
#[derive(Clone, Copy, PartialEq)]
enum Parent {
    Root,
    Loose,
    Node(usize),
    /// The link has been kept once; a repetition is not.
    Taken,
}

/// Where every node hangs, as far as it has been walked to.
struct Parents(Vec<Option<Parent>>);

impl Parents {
    /// Walks down from `open`, its last entry first; a node keeps its first parent.
    fn walk(&mut self, scene: &Scene, mut open: Vec<(Parent, NodeId)>) {
        while let Some((parent, id)) = open.pop() {
            if let Some(unseen @ None) = self.0.get_mut(id.index()) {
                *unseen = Some(parent);
                let this = Parent::Node(id.index());
                open.extend(scene.nodes[id.index()].children.iter().rev().map(|&child| (this, child)));
            }
        }
    }

    /// Whether the link from `parent` to `id` is the one to keep; true once.
    fn takes(&mut self, parent: Parent, id: NodeId) -> bool {
        match self.0.get_mut(id.index()) {
            Some(kept) if *kept == Some(parent) => {
                *kept = Some(Parent::Taken);
                true
            }
            _ => false,
        }
    }
}

fn is_finite(transform: &Transform) -> bool {
    match transform {
        Transform::Parts { translation, rotation, scale } => {
            translation.is_finite() && rotation.is_finite() && scale.is_finite()
        }
        Transform::Matrix(matrix) => matrix.is_finite(),
    }
}

/// Replaces numbers of a mesh that are not finite: places by the origin, normals by +z, others by 0.
fn mend_numbers(mesh: &mut crate::Mesh) {
    use senca_math::glam::{Vec2, Vec3, Vec4};
    fn mend<T: Copy>(values: &mut [T], neutral: T, is_finite: impl Fn(&T) -> bool) {
        values.iter_mut().filter(|v| !is_finite(v)).for_each(|v| *v = neutral);
    }
    mend(&mut mesh.points, Vec3::ZERO, |p| p.is_finite());
    mend(&mut mesh.vertices.normal, Vec3::Z, |n| n.is_finite());
    mend(&mut mesh.vertices.texcoord0, Vec2::ZERO, |t| t.is_finite());
    mend(&mut mesh.vertices.texcoord1, Vec2::ZERO, |t| t.is_finite());
    mend(&mut mesh.vertices.color, Vec4::ONE, |c| c.is_finite());
    mend(&mut mesh.vertices.tangent, Vec4::new(1.0, 0.0, 0.0, 1.0), |t| t.is_finite());
    mend(&mut mesh.joints, crate::JointInfluence::default(), |j| j.weights.iter().all(|w| w.is_finite()));
    for target in &mut mesh.morph_targets {
        mend(&mut target.points, Vec3::ZERO, |p| p.is_finite());
        mend(&mut target.normals, Vec3::ZERO, |n| n.is_finite());
        mend(&mut target.tangents, Vec3::ZERO, |t| t.is_finite());
    }
}

/// All uses of textures by a material.
fn texture_refs(material: &Material) -> impl Iterator<Item = TextureRef> {
    let own = match &material.reflection {
        Reflection::Phong(p) => [p.texture, p.specular_texture],
        Reflection::MetallicRoughness(m) => [m.base_color_texture, m.metallic_roughness_texture],
    };
    let common = [material.emission_texture, material.normal_texture, material.occlusion_texture];
    own.into_iter().chain(common).flatten()
}

fn material_colors(material: &Material) -> Vec<LinearRgb> {
    let mut colors = vec![material.emission, material.mirror, material.transmission, material.absorption];
    match &material.reflection {
        Reflection::Phong(p) => colors.extend([p.ambient, p.diffuse, p.specular, LinearRgb::splat(p.alpha)]),
        Reflection::MetallicRoughness(m) => colors.extend([m.base_color, LinearRgb::splat(m.alpha)]),
    }
    colors
}

fn check_image(what: &str, image: &ImageData) -> Check {
    let (width, height) = image.size();
    let texels = match image {
        ImageData::Rgba8 { texels, .. } => texels.len(),
        ImageData::RgbaF32 { texels, .. } => texels.len(),
    };
    if width == 0 || height == 0 || u64::from(width) * u64::from(height) != texels as u64 {
        return invalid(what.to_owned(), format!("{texels} texels for {width} by {height}"));
    }
    Ok(())
}

fn check_light(what: &str, light: &Light) -> Check {
    let value = |name: &'static str, x: f64, ok: bool, expected| {
        number(|| format!("{what}: {name}"), x, ok, expected)
    };
    if !light.color.is_finite() {
        return invalid(what.to_owned(), "its colour is not finite");
    }
    match light.attenuation {
        Attenuation::None => {}
        Attenuation::Polynomial { constant, linear, quadratic } => {
            for c in [constant, linear, quadratic] {
                value("attenuation", c, c >= 0.0, "0 or more")?;
            }
        }
        Attenuation::InverseSquare { range } => {
            range.map_or(Ok(()), |r| value("range", r, r > 0.0, "above 0"))?
        }
    }
    match light.kind {
        LightKind::Ambient | LightKind::Point | LightKind::Parallel => Ok(()),
        LightKind::Spot(SpotFalloff::Sharp { angle }) => value(
            "angle",
            angle,
            angle > 0.0 && angle <= std::f64::consts::PI,
            "above 0 and at most 180 degrees",
        ),
        LightKind::Spot(SpotFalloff::Cosine { exponent }) => {
            value("exponent", exponent, exponent >= 0.0, "0 or more")
        }
        LightKind::Spot(SpotFalloff::Smooth { inner, outer }) => {
            value(
                "inner angle",
                inner,
                inner >= 0.0 && inner < outer,
                "0 or more and below the outer angle",
            )?;
            let quarter = std::f64::consts::FRAC_PI_2 * (1.0 + 1e-6);
            value("outer angle", outer, outer <= quarter, "at most 90 degrees")
        }
        LightKind::BoxSpot { min, max, depth } => {
            value("depth", depth, depth > 0.0, "above 0")?;
            (0..2).try_for_each(|i| {
                value("upper limit", max[i], min[i].is_finite() && max[i] > min[i], "above the lower limit")
            })
        }
        LightKind::Area { size, .. } => size.iter().try_for_each(|&s| value("size", s, s > 0.0, "above 0")),
    }
}

fn check_camera(what: &str, camera: &Camera) -> Check {
    let value = |name: &'static str, x: f64, ok: bool, expected| {
        number(|| format!("{what}: {name}"), x, ok, expected)
    };
    if let Some(lens) = camera.lens {
        value("radius of the lens", lens.radius, lens.radius > 0.0, "above 0")?;
        value("focus distance", lens.focus_distance, lens.focus_distance > 0.0, "above 0")?;
    }
    if let Some([open, close]) = camera.shutter {
        value("opening of the shutter", open, true, "finite")?;
        value("closing of the shutter", close, close >= open, "at the opening or later")?;
    }
    let optional = |name, x: Option<f64>, ok: fn(f64) -> bool, expected| {
        x.map_or(Ok(()), |x| value(name, x, ok(x), expected))
    };
    let positive = |x: f64| x > 0.0;
    let (near, far) = match camera.projection {
        Projection::Perspective { yfov, aspect, near, far } => {
            value(
                "angle of view",
                yfov,
                yfov > 0.0 && yfov < std::f64::consts::PI,
                "above 0 and below 180 degrees",
            )?;
            optional("aspect", aspect, positive, "above 0")?;
            optional("near", near, positive, "above 0")?;
            (near, far)
        }
        Projection::Orthographic { height, aspect, near, far } => {
            value("height", height, height > 0.0, "above 0")?;
            optional("aspect", aspect, positive, "above 0")?;
            optional("near", near, |_| true, "finite")?;
            (near, far)
        }
        Projection::Operation(operation) => {
            return operation
                .steps()
                .map(|_| ())
                .map_err(|e| SceneError::Invalid { what: what.to_owned(), reason: e.to_string() });
        }
    };
    far.map_or(Ok(()), |far| value("far", far, near.is_none_or(|near| far > near), "beyond near"))
}

fn check_channel(what: &str, channel: &Channel) -> Check {
    if channel.times.is_empty() {
        return invalid(what.to_owned(), "it has no keys");
    }
    if !channel.times.iter().all(|t| t.is_finite()) || channel.times.windows(2).any(|t| t[0] >= t[1]) {
        return invalid(what.to_owned(), "its times must be finite and strictly increasing");
    }
    let per_key = if channel.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let (length, count, finite) = match &channel.values {
        ChannelValues::Translation(v) | ChannelValues::Scale(v) => {
            (v.len(), 1, v.iter().all(|v: &DVec3| v.is_finite()))
        }
        ChannelValues::Rotation(v) => (v.len(), 1, v.iter().all(|q: &DQuat| q.is_finite())),
        ChannelValues::Weights { count, values } => {
            (values.len(), *count, values.iter().all(|w| w.is_finite()))
        }
        ChannelValues::Path { points, parameters, .. } => {
            if points.len() < 4 || points.len() % 3 != 1 {
                return invalid(what.to_owned(), format!("a path has 3 n + 1 points, not {}", points.len()));
            }
            let finite = parameters.iter().all(|p| p.is_finite()) && points.iter().all(|p| p.is_finite());
            (parameters.len(), 1, finite)
        }
    };
    let expected = channel.times.len().saturating_mul(per_key).saturating_mul(count);
    if length != expected {
        return invalid(what.to_owned(), format!("it has {length} values, but its keys need {expected}"));
    }
    if !finite {
        return invalid(what.to_owned(), "a value is not finite");
    }
    Ok(())
}

#[cfg(test)]
mod tests;

//! Commands that copy from the framebuffer into textures.

use super::upload::{Definition, Region};
use super::{TexImage, Texels};
use crate::framebuffer::{Area, Aspect, Plane};
use crate::{Context, Enum, Error};

/// Pixels copied at a time.
const BATCH: usize = 256;

impl Context {
    /// `glCopyTexImage1D`: a row of `width` pixels from (`x`, `y`) on.
    pub fn copy_tex_image_1d(
        &mut self,
        target: Enum,
        level: i32,
        internal: Enum,
        [x, y]: [i32; 2],
        width: i32,
        border: i32,
    ) {
        let (size, internal) = ([width, 1, 1], internal as i32);
        let definition = Definition { dimensions: 1, target, level, internal, size, border };
        self.copy_tex_image(definition, [x, y]);
    }

    /// `glCopyTexImage2D`: a rectangle of pixels from (`x`, `y`) on.
    pub fn copy_tex_image_2d(
        &mut self,
        target: Enum,
        level: i32,
        internal: Enum,
        [x, y]: [i32; 2],
        [width, height]: [i32; 2],
        border: i32,
    ) {
        let (size, internal) = ([width, height, 1], internal as i32);
        let definition = Definition { dimensions: 2, target, level, internal, size, border };
        self.copy_tex_image(definition, [x, y]);
    }

    fn copy_tex_image(&mut self, definition: Definition, from: [i32; 2]) {
        self.submit(move |c| {
            let result = c.define_from_framebuffer(&definition, from);
            c.check(result);
        });
    }

    fn define_from_framebuffer(&mut self, definition: &Definition, from: [i32; 2]) -> Result<(), Error> {
        if (1..=4).contains(&definition.internal) {
            return Err(Error::InvalidEnum);
        }
        let checked = definition.check_image()?;
        self.release_textures();
        let planes =
            self.planes_to_copy(checked.format.base().has_depth(), checked.format.base().has_stencil())?;
        let texture = self.bound_texture(checked.target);
        if checked.size.contains(&0) {
            texture.lock().set_image(checked.face, checked.level, None);
            return Ok(());
        }
        let mut image = TexImage::new(checked.format, checked.size, checked.border)?;
        self.copy_pixels_into(&mut image, [0; 3], &planes, from, [checked.size[0], checked.size[1]]);
        let mut texture = texture.lock();
        texture.set_image(checked.face, checked.level, Some(image));
        texture.follow(checked.face, checked.level)
    }

    /// `glCopyTexSubImage1D`.
    pub fn copy_tex_sub_image_1d(
        &mut self,
        target: Enum,
        level: i32,
        offset: i32,
        from: [i32; 2],
        width: i32,
    ) {
        let (offset, size) = ([offset, 0, 0], [width, 1, 1]);
        self.copy_tex_sub_image(Region { dimensions: 1, target, level, offset, size }, from);
    }

    /// `glCopyTexSubImage2D`.
    pub fn copy_tex_sub_image_2d(
        &mut self,
        target: Enum,
        level: i32,
        offset: [i32; 2],
        from: [i32; 2],
        size: [i32; 2],
    ) {
        let (offset, size) = ([offset[0], offset[1], 0], [size[0], size[1], 1]);
        self.copy_tex_sub_image(Region { dimensions: 2, target, level, offset, size }, from);
    }

    /// `glCopyTexSubImage3D`: into one slice.
    pub fn copy_tex_sub_image_3d(
        &mut self,
        target: Enum,
        level: i32,
        offset: [i32; 3],
        from: [i32; 2],
        size: [i32; 2],
    ) {
        let size = [size[0], size[1], 1];
        self.copy_tex_sub_image(Region { dimensions: 3, target, level, offset, size }, from);
    }

    fn copy_tex_sub_image(&mut self, region: Region, from: [i32; 2]) {
        self.submit(move |c| {
            let result = c.change_from_framebuffer(&region, from);
            c.check(result);
        });
    }

    fn change_from_framebuffer(&mut self, region: &Region, from: [i32; 2]) -> Result<(), Error> {
        let (texture, face, level, corner) = region.locate(self)?;
        let base = texture.lock().image(face, level).map(|image| image.format.base());
        let base = base.ok_or(Error::InvalidOperation)?;
        self.release_textures();
        let planes = self.planes_to_copy(base.has_depth(), base.has_stencil())?;
        let mut texture = texture.lock();
        if let Some(image) = texture.image_mut(face, level) {
            let size = [region.size[0] as u32, region.size[1] as u32];
            self.copy_pixels_into(image, corner, &planes, from, size);
        }
        texture.follow(face, level)
    }

    /// What is read of the framebuffer: its colours, or its depths, perhaps with stencil values.
    fn planes_to_copy(&mut self, depth: bool, stencil: bool) -> Result<Vec<(Aspect, Plane)>, Error> {
        let aspects = [
            (!depth).then_some(Aspect::Color),
            depth.then_some(Aspect::Depth),
            (depth && stencil).then_some(Aspect::Stencil),
        ];
        aspects.into_iter().flatten().map(|aspect| Ok((aspect, self.read_plane(aspect)?))).collect()
    }

    /// Copies a rectangle of pixels through the pixel transfer. What lies outside the framebuffer stays as it was.
    fn copy_pixels_into(
        &self,
        image: &mut TexImage,
        corner: [u32; 3],
        planes: &[(Aspect, Plane)],
        [x, y]: [i32; 2],
        [width, height]: [u32; 2],
    ) {
        for (aspect, plane) in planes {
            let area = Area::of([x, y, width as i32, height as i32]).intersect(plane.area());
            if area.is_empty() {
                continue;
            }
            for row in area.y0..area.y1 {
                let to_y = corner[1] + (i64::from(row) - i64::from(y)) as u32;
                let mut column = area.x0;
                while column < area.x1 {
                    let count = ((area.x1 - column) as usize).min(BATCH);
                    let to_x = corner[0] + (i64::from(column) - i64::from(x)) as u32;
                    let at = plane.at(column as usize, row as usize);
                    self.copy_run(image, [to_x, to_y, corner[2]], *aspect, &plane.texels, at, count);
                    column += count as i32;
                }
            }
        }
    }

    fn copy_run(
        &self,
        image: &mut TexImage,
        to: [u32; 3],
        aspect: Aspect,
        texels: &Texels,
        at: usize,
        count: usize,
    ) {
        let transfer = self.transfer();
        match aspect {
            Aspect::Color => {
                let mut colors = [[0.0; 4]; BATCH];
                let colors = &mut colors[..count];
                (at..).zip(colors.iter_mut()).for_each(|(at, color)| *color = texels.color(at));
                transfer.colors(colors);
                image.write_colors(to, colors);
            }
            Aspect::Depth => {
                let mut depths = [0.0; BATCH];
                let depths = &mut depths[..count];
                if let Some(from) = texels.depths() {
                    depths.copy_from_slice(&from[at..at + count]);
                }
                transfer.depths(depths);
                image.write_depths(to, depths);
            }
            Aspect::Stencil => {
                if let Some(from) = texels.stencils() {
                    let mut values: Vec<u32> = from[at..at + count].iter().map(|&s| u32::from(s)).collect();
                    transfer.stencils(&mut values);
                    let values: Vec<u8> = values.into_iter().map(|s| s as u8).collect();
                    image.write_stencils(to, &values);
                }
            }
        }
    }
}

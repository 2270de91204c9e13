//! Paints a frame's triangles without a graphics card: slow, and the same everywhere.

use std::collections::HashMap;
use std::time::Duration;

use counterpoise_studio::offscreen::{OffscreenStudio, TessellatedFrame};
use egui::epaint::{ImageData, Mesh, Primitive, Vertex};
use egui::{Color32, ColorImage, Rect, TextureId, TexturesDelta};
use image::{Rgba, RgbaImage};

/// A painter with its textures.
#[derive(Default)]
pub struct Painter {
    textures: HashMap<TextureId, ColorImage>,
}

impl Painter {
    /// Takes changes of textures.
    pub fn take(&mut self, textures: &TexturesDelta) {
        let each = textures.set.iter().flat_map(|(id, deltas)| deltas.iter().map(move |delta| (id, delta)));
        for (id, delta) in each {
            let ImageData::Color(new) = &delta.image;
            let Some([x, y]) = delta.pos else {
                self.textures.insert(*id, (**new).clone());
                continue;
            };
            let whole = self.textures.get_mut(id).unwrap();
            for row in 0..new.size[1] {
                let (to, from) = ((y + row) * whole.size[0] + x, row * new.size[0]);
                whole.pixels[to..to + new.size[0]].copy_from_slice(&new.pixels[from..from + new.size[0]]);
            }
        }
    }

    /// Returns the picture of a window after a few frames, `pause` apart, in which what fades in can do so.
    pub fn paint_window(&mut self, seat: &mut OffscreenStudio, size: [u32; 2], pause: Duration) -> RgbaImage {
        for _ in 0..3 {
            let drawn = seat.draw_frame(Vec::new());
            seat.textures.append(drawn.textures);
            std::thread::sleep(pause);
        }
        self.take(&std::mem::take(&mut seat.textures));
        let drawn = seat.draw_frame(Vec::new());
        self.paint(&drawn, size)
    }

    /// Returns the picture of a frame.
    pub fn paint(&mut self, drawn: &TessellatedFrame, size: [u32; 2]) -> RgbaImage {
        self.take(&drawn.textures);
        let mut out = RgbaImage::from_pixel(size[0], size[1], Rgba([0, 0, 0, 255]));
        for one in &drawn.primitives {
            if let Primitive::Mesh(mesh) = &one.primitive {
                self.mesh(&mut out, mesh, one.clip_rect);
            }
        }
        out
    }

    fn mesh(&self, out: &mut RgbaImage, mesh: &Mesh, clip: Rect) {
        let texture = &self.textures[&mesh.texture_id];
        for corner in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[corner[k] as usize]);
            let area = edge(a.pos, b.pos, c.pos);
            if area > 0.0 {
                triangle(out, texture, [a, b, c], clip);
            } else if area < 0.0 {
                triangle(out, texture, [a, c, b], clip);
            }
        }
    }
}

fn edge(a: egui::Pos2, b: egui::Pos2, p: egui::Pos2) -> f32 {
    (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
}

/// Returns whether a pixel belongs to a triangle by one of its edges: of two triangles that share an edge, one has its pixels.
fn is_inside(a: egui::Pos2, b: egui::Pos2, w: f32) -> bool {
    let top_left = (a.y == b.y && b.x > a.x) || b.y < a.y;
    w > 0.0 || (w == 0.0 && top_left)
}

fn triangle(out: &mut RgbaImage, texture: &ColorImage, v: [Vertex; 3], clip: Rect) {
    let [a, b, c] = v.map(|v| v.pos);
    let bounds = Rect::from_points(&[a, b, c]).intersect(clip);
    let limit = |value: f32, most: u32| value.clamp(0.0, most as f32) as u32;
    let (left, right) = (limit(bounds.min.x.floor(), out.width()), limit(bounds.max.x.ceil(), out.width()));
    let (top, bottom) = (limit(bounds.min.y.floor(), out.height()), limit(bounds.max.y.ceil(), out.height()));
    let area = edge(a, b, c);
    for y in top..bottom {
        for x in left..right {
            let p = egui::pos2(x as f32 + 0.5, y as f32 + 0.5);
            let w = [edge(b, c, p), edge(c, a, p), edge(a, b, p)];
            let inside = is_inside(b, c, w[0]) && is_inside(c, a, w[1]) && is_inside(a, b, w[2]);
            if inside && clip.contains(p) {
                let w = w.map(|w| w / area);
                let mix = |of: fn(&Vertex) -> f32| w[0] * of(&v[0]) + w[1] * of(&v[1]) + w[2] * of(&v[2]);
                let texel = sample(texture, mix(|v| v.uv.x), mix(|v| v.uv.y));
                let tint = [
                    mix(|v| f32::from(v.color.r())),
                    mix(|v| f32::from(v.color.g())),
                    mix(|v| f32::from(v.color.b())),
                    mix(|v| f32::from(v.color.a())),
                ];
                blend(out.get_pixel_mut(x, y), std::array::from_fn(|k| texel[k] * tint[k] / 255.0));
            }
        }
    }
}

/// Returns the texture between its four nearest texels.
fn sample(texture: &ColorImage, u: f32, v: f32) -> [f32; 4] {
    let [width, height] = texture.size;
    let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let at = |dx: i32, dy: i32| -> [f32; 4] {
        let column = (x.floor() as i32 + dx).clamp(0, width as i32 - 1) as usize;
        let row = (y.floor() as i32 + dy).clamp(0, height as i32 - 1) as usize;
        let c: Color32 = texture.pixels[row * width + column];
        c.to_array().map(f32::from)
    };
    let [a, b, c, d] = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
    std::array::from_fn(|k| {
        (a[k] * (1.0 - fx) + b[k] * fx) * (1.0 - fy) + (c[k] * (1.0 - fx) + d[k] * fx) * fy
    })
}

/// Premultiplied, as the window blends.
fn blend(under: &mut Rgba<u8>, over: [f32; 4]) {
    let keep = 1.0 - over[3] / 255.0;
    for (k, value) in over.iter().enumerate() {
        under.0[k] = (value + keep * f32::from(under.0[k])).round().clamp(0.0, 255.0) as u8;
    }
}

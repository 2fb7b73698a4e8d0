//! Where the picture is: its texture, and its place in the window.

use eframe::egui::{self, Color32, ColorImage, Pos2, Rect, TextureHandle, TextureId, TextureOptions, Vec2};
use eframe::egui_wgpu::RenderState;
use eframe::wgpu::{FilterMode, Texture};
use eyerays::render::Display;

/// The picture that is shown.
pub(crate) struct Canvas {
    state: RenderState,
    /// One that has not been drawn yet.
    next: Option<Display>,
    shown: Shown,
    /// Columns and rows of the picture.
    size: (u32, u32),
    /// A texture for pictures that do not leave the device, once there was one.
    registered: Option<TextureId>,
}

enum Shown {
    Nothing,
    /// On the device that has rendered it.
    Shared(Texture, FilterMode),
    /// Sent there.
    Uploaded(TextureHandle),
}

impl Canvas {
    /// Without a picture.
    pub fn new(state: RenderState) -> Canvas {
        Canvas { state, next: None, shown: Shown::Nothing, size: (0, 0), registered: None }
    }

    /// Takes a new picture.
    pub fn take(&mut self, display: Display, size: (u32, u32)) {
        (self.size, self.next) = (size, Some(display));
    }

    /// Columns and rows of the picture.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Draws it over a rectangle of the window, pixel by pixel where it has as many as that.
    pub fn draw(&mut self, ui: &egui::Ui, place: Rect) {
        let pixels = Vec2::new(self.size.0 as f32, self.size.1 as f32);
        let is_exact = (place.size() * ui.ctx().pixels_per_point() - pixels).abs().max_elem() < 0.5;
        if let Some(display) = self.next.take() {
            self.show(ui.ctx(), display, is_exact);
        }
        let id = match &self.shown {
            Shown::Nothing => return,
            Shown::Shared(texture, filter) => {
                if *filter != filter_of(is_exact) {
                    self.share(texture.clone(), filter_of(is_exact));
                }
                self.registered.expect("a texture is registered when it is shared")
            }
            Shown::Uploaded(texture) => texture.id(),
        };
        let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        ui.painter().image(id, place, all, Color32::WHITE);
    }

    fn show(&mut self, context: &egui::Context, display: Display, is_exact: bool) {
        match display {
            Display::Texture(texture) => {
                if !matches!(&self.shown, Shown::Shared(before, _) if *before == texture) {
                    self.share(texture, filter_of(is_exact));
                }
            }
            Display::Pixels { size: (width, height), bytes } => {
                let bytes = bytes.as_flattened();
                let image = ColorImage::from_rgba_unmultiplied([width as usize, height as usize], bytes);
                let options = if is_exact { TextureOptions::NEAREST } else { TextureOptions::LINEAR };
                match &mut self.shown {
                    Shown::Uploaded(texture) => texture.set(image, options),
                    other => *other = Shown::Uploaded(context.load_texture("picture", image, options)),
                }
            }
        }
    }

    fn share(&mut self, texture: Texture, filter: FilterMode) {
        let (mut renderer, view) = (self.state.renderer.write(), texture.create_view(&Default::default()));
        let device = &self.state.device;
        match self.registered {
            Some(id) => renderer.update_egui_texture_from_wgpu_texture(device, &view, filter, id),
            None => self.registered = Some(renderer.register_native_texture(device, &view, filter)),
        }
        drop(renderer);
        self.shown = Shown::Shared(texture, filter);
    }
}

impl Drop for Canvas {
    fn drop(&mut self) {
        if let Some(id) = self.registered {
            self.state.renderer.write().free_texture(&id);
        }
    }
}

/// Pixels as they are, or the means of those beside each other.
fn filter_of(is_exact: bool) -> FilterMode {
    if is_exact { FilterMode::Nearest } else { FilterMode::Linear }
}

/// The largest place for a picture of this aspect in the middle of a rectangle, from whole pixel to whole pixel; one of as many pixels as
/// the picture where that fits.
pub(crate) fn place(within: Rect, size: (u32, u32), scale: f32) -> Rect {
    let picture = Vec2::new(size.0 as f32, size.1 as f32) / scale;
    let factor = (within.size() / picture).min_elem().min(1.0);
    let shown = picture * factor;
    let corner = within.center() - shown / 2.0;
    let whole = |pos: Pos2| Pos2::new((pos.x * scale).round() / scale, (pos.y * scale).round() / scale);
    Rect::from_min_size(
        whole(corner),
        if factor < 1.0 { (whole(corner + shown) - whole(corner)).max(Vec2::splat(1.0 / scale)) } else { picture },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_fits_has_its_own_pixels_and_a_larger_one_is_made_smaller() {
        let within = Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::new(301.0, 200.0));
        for scale in [1.0, 1.5, 2.0] {
            let small = place(within, (200, 100), scale);
            assert_eq!(small.size() * scale, Vec2::new(200.0, 100.0));
            assert_eq!((small.min.x * scale).fract(), 0.0);
            assert!(within.contains_rect(small));
            let large = place(within, (4000, 1000), scale);
            assert!((large.aspect_ratio() - 4.0).abs() < 0.1 && within.expand(1.0).contains_rect(large), "{large}");
            assert!(large.width() > 299.0);
        }
    }
}

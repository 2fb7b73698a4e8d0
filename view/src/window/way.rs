//! The way of a ray, step by step, in a window of its own.

use eframe::egui::{self, RichText, ScrollArea, TextStyle};

use super::Window;

impl Window {
    /// Shows the way of the ray that is followed, until it is closed.
    pub(super) fn way(&mut self, context: &egui::Context) {
        let told = self.news.lesson.clone();
        let Some(way) = told.way.as_ref().filter(|_| self.wish.lesson.pixel.is_some()) else { return };
        let (mut is_open, (x, y)) = (true, way.pixel);
        let window =
            egui::Window::new(format!("The ray of pixel {x}, {y}")).id(egui::Id::unique("way")).open(&mut is_open);
        window.default_size([680.0, 400.0]).vscroll(false).show(context, |ui| {
            let lines: Vec<&str> = way.text.lines().collect();
            let height = ui.text_style_height(&TextStyle::Monospace);
            ScrollArea::both().auto_shrink(false).show_rows(ui, height, lines.len(), |ui, rows| {
                for line in &lines[rows] {
                    ui.add(egui::Label::new(RichText::new(*line).monospace()).extend());
                }
            });
        });
        if !is_open {
            self.wish.lesson.pixel = None;
        }
    }
}

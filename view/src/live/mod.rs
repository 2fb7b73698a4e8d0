//! A window on pictures that others send while they render them.

mod desk;
mod packet;

use std::net::TcpListener;
use std::sync::Arc;

use eframe::egui::{self, CentralPanel, Color32, Frame, Label, Panel, RichText, Ui};
use eyerays::error::{Error, Result};
use eyerays::gpu::Around;
use eyerays::image::Encoding;
use eyerays::line::one_line;
use eyerays::render::Display;

use self::desk::Desk;
use crate::window::{self, STATUS_HEIGHT, canvas, canvas::Canvas};
use crate::worker::repaint;

/// What a window on pictures of others is opened with.
pub struct Listening {
    /// Where they are sent to, by tev's protocol.
    pub listener: TcpListener,
    /// Columns and rows that there is room for at first.
    pub size: Option<(u32, u32)>,
    /// How light is shown.
    pub look: Encoding,
    /// What is held while a driver opens a device.
    pub around: Option<Around>,
    /// Hears that the window is open.
    pub opened: Box<dyn FnOnce()>,
}

/// Opens a window on what is sent, and returns when it is closed.
///
/// # Errors
/// There is no screen, or nothing that draws on it.
pub fn listen(listening: Listening) -> Result<()> {
    let Listening { listener, size, look, around, opened } = listening;
    let desk = Arc::new(Desk::default());
    crate::run("Eyerays", size.unwrap_or(crate::SIZE), around, move |context, state| {
        desk.receive(listener, repaint(context));
        opened();
        Box::new(Viewer { desk, canvas: Canvas::new(state), look, shown: None, has_panel: false })
    })
}

/// The window.
struct Viewer {
    desk: Arc<Desk>,
    canvas: Canvas,
    look: Encoding,
    /// What is on the canvas: of when, and how.
    shown: Option<(u64, Encoding)>,
    has_panel: bool,
}

impl Viewer {
    /// Puts what has come on the canvas, and tells what it is.
    fn take(&mut self) -> Result<String> {
        let desk = self.desk.clone();
        let pictures = desk.look();
        if let Some(fault) = &pictures.fault {
            return Err(Error::new(fault));
        }
        let Some((name, picture)) = pictures.shown() else { return Ok("nothing was sent yet".to_owned()) };
        let (size, now) = ((picture.width, picture.height), (pictures.version, self.look));
        if self.shown != Some(now) {
            self.shown = Some(now);
            self.canvas.take(Display::of(picture, &self.look)?, size);
        }
        Ok(format!("{} | {}x{} | N: exposure and tone map", one_line(name), size.0, size.1))
    }

    /// The line below the picture.
    fn status(&mut self, ui: &mut Ui) {
        let text = match self.take() {
            Ok(told) => RichText::new(told),
            Err(error) => RichText::new(format!("error: {}", one_line(&error.to_string()))).color(Color32::LIGHT_RED),
        };
        Panel::bottom("status").exact_size(STATUS_HEIGHT).show_separator_line(false).show(ui, |ui| {
            ui.horizontal_centered(|ui| ui.add(Label::new(text).truncate()));
        });
    }
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.status(ui);
        if self.has_panel {
            Panel::right("panel").default_size(300.0).show(ui, |ui| window::look(ui, &mut self.look));
        }
        CentralPanel::default().frame(Frame::NONE.fill(window::DARK)).show(ui, |ui| {
            let within = ui.available_rect_before_wrap();
            let place = canvas::place(within, self.canvas.size(), context.pixels_per_point());
            self.canvas.draw(ui, place);
        });
        let pressed = |held: egui::Modifiers, key| context.input_mut(|input| input.consume_key(held, key));
        if pressed(egui::Modifiers::COMMAND, egui::Key::Q) {
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        if pressed(egui::Modifiers::NONE, egui::Key::N) {
            self.has_panel = !self.has_panel;
        }
    }
}

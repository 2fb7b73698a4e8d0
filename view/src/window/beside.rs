//! The same picture by other settings, beside it, and how they differ.

use eframe::egui::{self, CursorIcon, Pos2, Rect, RichText, Sense, Slider, Stroke, Ui};
use eframe::egui_wgpu::RenderState;
use eyerays::compare::{self, Comparison};
use eyerays::error::Result;
use eyerays::image::Encoding;
use eyerays::line::one_line;
use eyerays::render::Display;
use eyerays::scene::Settings;

use super::canvas::Canvas;
use super::panel;
use super::{DARK, Window};
use crate::news::{Answer, Ask, Doing, Light, News};
use crate::studio::Studio;
use crate::wish::{Device, Lesson, Wish};
use crate::worker::{Worker, repaint};

/// Both pictures get so many samples, unless another number is chosen: then they can be compared.
const SAMPLES: u32 = 16;
/// The line between them can be taken so far from it, in points.
const GRIP: f32 = 4.0;

/// Another picture, at the right of the first.
pub(super) struct Beside {
    worker: Worker,
    canvas: Canvas,
    news: News,
    /// What it is rendered by.
    device: Device,
    /// And how; as the first without any.
    settings: Option<Settings>,
    /// What was said to the worker last.
    sent: Option<Wish>,
    /// Samples of both pictures.
    samples: u32,
    /// Where the first ends, as a share of the width.
    divider: f32,
    comparing: Comparing,
}

/// What is known of how the pictures differ.
struct Comparing {
    canvas: Canvas,
    /// Is that shown in their place?
    is_shown: bool,
    /// The wishes whose pictures were asked for, and how many samples they had.
    asked: Option<([Wish; 2], u32)>,
    /// Those that have come.
    lights: [Option<Box<Light>>; 2],
    found: Option<std::result::Result<Comparison, String>>,
}

impl Beside {
    /// Of a studio of its own, rendering as the first picture is.
    pub fn new(context: &egui::Context, state: RenderState, studio: Studio, first: &Wish) -> Beside {
        let canvas = Canvas::new(state.clone());
        let (asked, lights, found) = Default::default();
        let comparing = Comparing { canvas: Canvas::new(state), is_shown: false, asked, lights, found };
        Beside {
            worker: Worker::new(studio, repaint(context)),
            canvas,
            news: News::default(),
            device: first.device.clone(),
            settings: first.settings,
            sent: None,
            samples: SAMPLES,
            divider: 0.5,
            comparing,
        }
    }

    /// Samples that both pictures get: no fewer than one of them has.
    pub fn samples(&self, first: &News) -> u32 {
        self.samples.max(first.samples).max(self.news.samples)
    }

    /// Takes what has come.
    pub fn receive(&mut self) {
        while let Some(answer) = self.worker.answer() {
            if let Answer::Light(light) = answer {
                self.comparing.take(1, light);
            }
        }
        let (news, picture) = self.worker.take();
        self.news = news;
        if let Some(picture) = picture {
            self.canvas.take(picture.display, picture.size);
        }
    }

    /// What the first picture has come to.
    pub fn light(&mut self, light: Box<Light>) {
        self.comparing.take(0, light);
    }

    /// Says what is wished for beside the first, and compares what is done.
    pub fn send(&mut self, first: (&Wish, &Worker, &News)) {
        let (wish, worker, news) = first;
        let other = Wish {
            device: self.device.clone(),
            settings: self.settings.or(wish.settings),
            lesson: Lesson::default(),
            ..wish.clone()
        };
        if self.sent.as_ref() != Some(&other) {
            self.worker.wish(&other);
            self.sent = Some(other.clone());
        }
        self.comparing.forget_unless(wish, &other);
        let is_done = |news: &News| news.doing == Doing::Done && news.samples > 0;
        let both = Some(([wish.clone(), other], news.samples));
        if is_done(news) && is_done(&self.news) && news.samples == self.news.samples && self.comparing.asked != both {
            (self.comparing.asked, self.comparing.lights, self.comparing.found) = (both, [None, None], None);
            worker.ask(Ask::Light);
            self.worker.ask(Ask::Light);
        }
    }

    /// Draws it over the right of the first picture, or how they differ over all of it.
    pub fn draw(&mut self, ui: &mut Ui, place: Rect) {
        if self.comparing.is_shown && self.comparing.found.as_ref().is_some_and(std::result::Result::is_ok) {
            self.comparing.canvas.draw(ui, place);
            return;
        }
        let x = place.left() + self.divider * place.width();
        let right = Rect::from_min_max(Pos2::new(x, place.top()), place.max);
        ui.scope(|ui| {
            ui.set_clip_rect(right.intersect(ui.clip_rect()));
            ui.painter().rect_filled(right, 0.0, DARK);
            self.canvas.draw(ui, place);
        });
        ui.painter().vline(x, place.y_range(), Stroke::new(1.0, egui::Color32::WHITE));
    }

    /// Lets the line between them be taken: it lies over the picture, which does not move then.
    pub fn divide(&mut self, ui: &mut Ui, place: Rect) {
        let x = place.left() + self.divider * place.width();
        let grip = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, place.y_range());
        let response =
            ui.interact(grip, egui::Id::unique("divider"), Sense::drag()).on_hover_cursor(CursorIcon::ResizeHorizontal);
        if let Some(at) = response.interact_pointer_pos() {
            self.divider = ((at.x - place.left()) / place.width()).clamp(0.0, 1.0);
        }
    }

    /// How many samples it has, and how it differs from the first.
    pub fn line(&self) -> String {
        format!("at the right {} samples, {}", self.news.samples, self.comparing.line())
    }

    /// What may be changed of it, and what is different.
    pub fn panel(&mut self, ui: &mut Ui, first: Settings) {
        panel::device(ui, &mut self.device);
        let mut settings = self.settings.unwrap_or(first);
        panel::transport(ui, &mut settings);
        self.settings = (settings != first).then_some(settings);
        ui.add(Slider::new(&mut self.samples, 1..=4096).logarithmic(true).text("samples of both"));
        ui.checkbox(&mut self.comparing.is_shown, "show where they differ");
        ui.label(self.comparing.told());
        ui.weak(format!("{} samples | {}", self.news.samples, self.news.device));
        if let Some(fault) = &self.news.fault {
            ui.label(RichText::new(one_line(fault)).color(egui::Color32::LIGHT_RED));
        }
    }
}

impl Comparing {
    /// What was found of other wishes says nothing of these.
    fn forget_unless(&mut self, first: &Wish, other: &Wish) {
        if self.asked.as_ref().is_some_and(|([a, b], _)| (a, b) != (first, other)) {
            (self.asked, self.lights, self.found) = Default::default();
        }
    }

    fn line(&self) -> String {
        match &self.found {
            None => "compared once both are done".to_owned(),
            Some(Err(why)) => one_line(why),
            Some(Ok(found)) if found.bit_equal => "all bits are equal".to_owned(),
            Some(Ok(found)) => {
                let Comparison { differing_pixels, largest_difference, width, height, .. } = found;
                let of = u64::from(*width) * u64::from(*height);
                format!("{differing_pixels} of {of} pixels differ, by {largest_difference:.3e} at most")
            }
        }
    }

    fn take(&mut self, number: usize, light: Box<Light>) {
        let is_asked = |(wishes, samples): &([Wish; 2], u32)| wishes[number] == light.wish && *samples == light.samples;
        if !self.asked.as_ref().is_some_and(is_asked) {
            // Of a wish before, or not done yet: it is asked for again.
            self.asked = None;
            return;
        }
        self.lights[number] = Some(light);
        if let [Some(first), Some(other)] = &self.lights {
            let found = compared(first, other).map(|(comparison, display)| {
                self.canvas.take(display, (first.picture.width, first.picture.height));
                comparison
            });
            self.found = Some(found.map_err(|error| error.to_string()));
            self.lights = [None, None];
        }
    }

    fn told(&self) -> RichText {
        let line = RichText::new(self.line());
        match &self.found {
            None => line.weak(),
            Some(Err(_)) => line.color(egui::Color32::LIGHT_RED),
            Some(Ok(found)) if found.bit_equal => line.color(egui::Color32::LIGHT_GREEN),
            Some(Ok(_)) => line.strong(),
        }
    }
}

fn compared(first: &Light, other: &Light) -> Result<(Comparison, Display)> {
    let comparison = compare::compare(&first.picture, &other.picture)?;
    let heat = compare::heat_map(&first.picture, &other.picture)?;
    Ok((comparison, Display::of(&heat, &Encoding::default())?))
}

impl Window {
    /// Another setting beside the picture, or none.
    pub(super) fn beside_panel(&mut self, ui: &mut Ui, settings: Settings) {
        let mut has_other = self.beside.is_some();
        ui.checkbox(&mut has_other, "another setting at the right");
        match (&mut self.beside, has_other) {
            (None, true) => self.beside = Some(Beside::new(ui.ctx(), self.state.clone(), (self.another)(), &self.wish)),
            (Some(_), false) => self.beside = None,
            (Some(beside), true) => beside.panel(ui, settings),
            (None, false) => {}
        }
    }
}

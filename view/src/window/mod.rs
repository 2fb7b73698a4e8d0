//! The window: a picture, what is told of it, and what may be changed.

mod beside;
pub(crate) mod canvas;
mod hand;
mod keys;
mod overlay;
mod panel;
mod status;
mod way;

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, CentralPanel, Color32, Frame, Rect, Sense, Ui};
use eframe::egui_wgpu::RenderState;
use eyerays::error::Error;
use eyerays::gpu::Gpu;
use eyerays::scene::{Camera, Focus, Lens};

use self::beside::Beside;
use self::canvas::Canvas;
pub(crate) use self::panel::look;
use crate::files::Files;
use crate::news::{Answer, Ask, News};
use crate::studio::Studio;
use crate::wish::Wish;
use crate::worker::{Worker, repaint};

/// So long after a camera was moved it is taken for moving.
const SETTLING: Duration = Duration::from_millis(200);

/// The height of the line below the picture, in points.
pub(crate) const STATUS_HEIGHT: f32 = 24.0;

/// What is beside the picture.
pub(crate) const DARK: Color32 = Color32::from_gray(24);

/// What is shown in the window beside the picture.
struct Show {
    panel: bool,
    /// Seconds of the animation go by.
    playing: bool,
    /// Is the ray of a click followed?
    follows: bool,
    /// Said for a while: when, and what.
    said: Option<(Instant, String)>,
}

/// Why a window was closed by itself.
pub(crate) type Ended = Rc<RefCell<Option<Error>>>;

/// What a window is asked for.
pub(crate) struct Asked {
    /// The device that draws it, where that renders, too.
    pub shared: Option<Gpu>,
    pub ended: Ended,
    pub wish: Wish,
    /// A size that pictures have whatever the window's is.
    pub size: Option<(u32, u32)>,
    /// Hears of what is picked and copied.
    pub told: Box<dyn Fn(&str)>,
}

/// The window.
pub(crate) struct Window {
    worker: Worker,
    canvas: Canvas,
    /// Another setting at the right.
    beside: Option<Beside>,
    /// Makes a studio for that.
    another: Box<dyn Fn() -> Studio>,
    state: RenderState,
    /// The device that draws it, where that renders, too.
    shared: Option<Gpu>,
    /// Why it was closed, where nobody wished that.
    ended: Ended,
    files: Files,
    wish: Wish,
    /// What was said to the worker last.
    sent: Option<Wish>,
    /// A size that pictures have whatever the window's is.
    fixed: Option<(u32, u32)>,
    told: Box<dyn Fn(&str)>,
    news: News,
    moved: Option<Instant>,
    show: Show,
}

impl Window {
    /// Over the device that a window draws with.
    pub fn new(
        context: &egui::Context,
        state: RenderState,
        studio: impl Fn() -> Studio + 'static,
        asked: Asked,
    ) -> Window {
        let Asked { shared, ended, wish, size: fixed, told } = asked;
        // Where frames take long, a click seems to: its press and its release are two frames.
        context.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
        let repaint = repaint(context);
        let show = Show { panel: false, playing: false, follows: false, said: None };
        Window {
            worker: Worker::new(studio(), repaint.clone()),
            canvas: Canvas::new(state.clone()),
            beside: None,
            another: Box::new(studio),
            state,
            shared,
            ended,
            files: Files::new(repaint),
            wish,
            sent: None,
            fixed,
            told,
            news: News::default(),
            moved: None,
            show,
        }
    }

    /// Opens another file.
    fn open(&mut self, path: PathBuf) {
        let Wish { device, size, look, .. } = self.wish.clone();
        self.wish = Wish { look, ..Wish::new(path, device, size) };
        self.show.playing = false;
    }

    /// The camera that is wished for, once a scene tells one.
    fn camera(&self) -> Option<Camera> {
        self.wish.camera.clone().or_else(|| Some(self.news.facts.as_ref()?.camera.clone()))
    }

    fn move_camera(&mut self, camera: Camera) {
        self.wish.camera = Some(camera);
        self.moved = Some(Instant::now());
    }

    fn say(&mut self, what: impl Into<String>) {
        self.show.said = Some((Instant::now(), what.into()));
    }

    /// Takes what has come, before it is drawn: nothing may call for another frame.
    fn receive(&mut self) {
        while let Some(answer) = self.worker.answer() {
            self.answer(answer);
        }
        let (news, picture) = self.worker.take();
        let is_known = |facts| self.news.facts.as_ref().is_some_and(|before| Arc::ptr_eq(before, facts));
        if let Some(facts) = news.facts.as_ref().filter(|&facts| !is_known(facts)) {
            self.files.watch(&facts.files);
        }
        self.news = news;
        if let Some(picture) = picture {
            self.canvas.take(picture.display, picture.size);
        }
        if let Some(beside) = &mut self.beside {
            beside.receive();
        }
    }

    /// Says what is wished for now.
    fn send(&mut self, context: &egui::Context) {
        match self.files.due() {
            Some(Duration::ZERO) => self.wish.source.version += 1,
            Some(left) => context.request_repaint_after(left),
            None => {}
        }
        let since = self.moved.map(|moved| moved.elapsed());
        self.wish.is_moving = since.is_some_and(|since| since < SETTLING);
        if let Some(left) = since.and_then(|since| SETTLING.checked_sub(since)) {
            context.request_repaint_after(left);
        }
        // As many samples as that beside it.
        let most = self.beside.as_ref().map_or(self.wish.most, |beside| beside.samples(&self.news).min(self.wish.most));
        let wish = Wish { most, ..self.wish.clone() };
        if let Some(beside) = &mut self.beside {
            beside.send((&wish, &self.worker, &self.news));
        }
        if self.sent.as_ref() != Some(&wish) {
            self.worker.wish(&wish);
            self.sent = Some(wish);
            // It may be there before this frame ends.
            context.request_repaint();
        }
    }

    /// The picture, and the hand on it.
    fn picture(&mut self, ui: &mut Ui) {
        let (within, scale) = (ui.available_rect_before_wrap(), ui.ctx().pixels_per_point());
        let pixels = |points: f32| ((points * scale).round() as u32).clamp(1, 16_384);
        self.wish.size = self.fixed.unwrap_or((pixels(within.width()), pixels(within.height())));
        let place = canvas::place(within, self.wish.size, scale);
        self.canvas.draw(ui, place);
        if let Some(beside) = &mut self.beside {
            beside.draw(ui, place);
        }
        if let Some(camera) = self.camera() {
            overlay::draw(ui.painter(), (place, self.wish.size), &camera, &self.news.lesson);
        }
        let response = ui.allocate_rect(within, Sense::click_and_drag());
        if let Some(beside) = &mut self.beside {
            beside.divide(ui, place);
        }
        if let Some(mut camera) = self.camera()
            && hand::moved(&mut camera, &response, place.height())
        {
            self.move_camera(camera);
        }
        self.ask(ui, &response, place);
        self.drop_files(ui, within);
        self.way(ui.ctx());
    }

    /// Asks what is clicked on, or for the camera to be sharp there.
    fn ask(&mut self, ui: &Ui, response: &egui::Response, place: Rect) {
        let at = response.interact_pointer_pos().filter(|at| response.clicked() && place.contains(*at));
        let Some(at) = at else { return };
        let share = (at - place.min) / place.size();
        let (width, height) = self.wish.size;
        let pixel = |share: f32, count: u32| ((share * count as f32) as u32).min(count - 1);
        let (x, y) = (pixel(share.x, width), pixel(share.y, height));
        // As it was held then: keys may have changed since, in the same frame.
        let has_ctrl = ui.input(|input| {
            let held = |event: &egui::Event| matches!(event, egui::Event::PointerButton { pressed: false, modifiers, .. } if modifiers.command);
            input.events.iter().any(held)
        });
        if self.show.follows && !has_ctrl {
            self.wish.lesson.pixel = Some((x, y));
        }
        self.worker.ask(if has_ctrl { Ask::Focus(x, y) } else { Ask::What(x, y) });
    }

    /// Does what a question was for.
    fn answer(&mut self, answer: Answer) {
        match answer {
            Answer::What(line) => {
                (self.told)(&line);
                self.say(line);
            }
            Answer::Light(light) => {
                if let Some(beside) = &mut self.beside {
                    beside.light(light);
                }
            }
            Answer::Nothing(why) => self.say(why),
            Answer::Focus(distance) => {
                let Some(mut camera) = self.camera() else { return };
                let lens = camera.lens.unwrap_or_else(|| panel::lens(&camera));
                camera.lens = Some(Lens { focus: Focus::Distance(distance), ..lens });
                self.move_camera(camera);
                self.say(format!("sharp at a distance of {distance}"));
            }
        }
    }

    /// Opens what is dropped.
    fn drop_files(&mut self, ui: &Ui, within: Rect) {
        let (is_over, dropped) = ui.input(|input| {
            let dropped = input.raw.dropped_files.first().map(|file| file.path().to_owned());
            (!input.raw.hovered_files.is_empty(), dropped)
        });
        if is_over {
            ui.painter().rect_filled(within, 0.0, Color32::from_black_alpha(128));
        }
        if let Some(path) = dropped {
            self.open(path);
        }
    }

    /// Lets the seconds of the animation go by.
    fn play(&mut self, context: &egui::Context) {
        let Some(facts) = &self.news.facts else { return };
        let length = facts.animations.first().map_or(0.0, |animation| animation.seconds);
        if self.show.playing && length > 0.0 {
            let step = f64::from(context.input(|input| input.stable_dt)).min(0.1);
            let now = self.wish.source.seconds.unwrap_or(0.0) + step;
            self.wish.source.seconds = Some(now % length);
            context.request_repaint();
        }
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        if self.shared.as_ref().is_some_and(Gpu::is_lost) {
            let why =
                "the device that draws the window was lost: open it again, with --device cpu if that happens again";
            *self.ended.borrow_mut() = Some(Error::new(why));
            context.send_viewport_cmd(egui::ViewportCommand::Close);
            return;
        }
        self.receive();
        self.play(&context);
        self.status(ui);
        if self.show.panel {
            self.panel(ui);
        }
        CentralPanel::default().frame(Frame::NONE.fill(DARK)).show(ui, |ui| self.picture(ui));
        // After the mouse: who drags and then presses a key, perhaps in one frame, means the key.
        self.keys(&context);
        self.send(&context);
    }

    fn clear_color(&self, _: &egui::Visuals) -> [f32; 4] {
        [0.1, 0.1, 0.1, 1.0]
    }
}

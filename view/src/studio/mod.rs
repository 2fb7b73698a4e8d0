//! Where pictures are made for a window: what is wished for becomes a picture by steps of some hundredths of a second, so that another
//! wish is soon heard.

mod answer;
mod colours;
mod growth;
mod inspector;
mod light;
mod pace;
mod polisher;
mod rate;
mod seat;
mod set;
mod teacher;

use std::time::{Duration, Instant};

use eyerays::device_scene::DeviceScene;
use eyerays::error::{Error, Result};
use eyerays::gpu::{Around, Gpu};
use eyerays::job::Job;
use eyerays::layers;
use eyerays::render::{DeviceWish, Display, Session};
use eyerays::scene::Settings;
use eyerays::view::View;

use self::growth::{Growth, Subject};
use self::inspector::Inspector;
use self::pace::Pace;
use self::polisher::Polisher;
use self::rate::Meter;
use self::seat::Seat;
use self::set::Set;
use self::teacher::Teacher;
use crate::news::{Doing, News, Picture};
use crate::reader::Reader;
use crate::shows::Shows;
use crate::wish::{Device, Source, Wish};

/// Makes the pictures of a window.
pub struct Studio {
    reader: Box<dyn Reader>,
    /// The window's own GPU.
    shared: Option<Gpu>,
    around: Option<Around>,
    /// The scene that was read last, or could not be.
    source: Option<Source>,
    set: Option<Set>,
    seat: Seat,
    /// What the session is for.
    seated: Option<Seated>,
    /// What the GPU of the last wish failed by while it was left to us: the CPU goes on.
    gpu_fault: Option<String>,
    growth: Option<Growth>,
    polisher: Polisher,
    /// What a preview was last drawn of.
    previewed: Option<Subject>,
    inspector: Option<Inspector>,
    teacher: Teacher,
    /// What was last shown in the place of light.
    inspected: Option<(Subject, Shows)>,
    pace: Pace,
    meter: Meter,
    noise_told: Option<Instant>,
    /// Why the scene of the last wish could not be read: what is shown is the one before.
    unread: Option<String>,
    /// The wish that can't be had.
    refused: Option<Wish>,
    news: News,
}

/// What a session is for.
struct Seated {
    device: Device,
    settings: Settings,
    /// The scene that it is of.
    job: Job,
}

/// What a step has come to.
pub struct Step {
    /// A picture to be shown.
    pub picture: Option<Picture>,
    /// Is there more to do without another wish?
    pub goes_on: bool,
}

const NOTHING: Step = Step { picture: None, goes_on: false };

impl Studio {
    /// Without a scene. Pictures of `shared`, the window's own GPU, stay there; `around` is held around the work of other GPUs' drivers.
    pub fn new(reader: Box<dyn Reader>, shared: Option<Gpu>, around: Option<Around>) -> Studio {
        Studio {
            reader,
            shared,
            around,
            source: None,
            set: None,
            seat: Seat::Empty,
            seated: None,
            gpu_fault: None,
            growth: None,
            polisher: Polisher::default(),
            previewed: None,
            inspector: None,
            teacher: Teacher::default(),
            inspected: None,
            pace: Pace::new(),
            meter: Meter::new(),
            noise_told: None,
            unread: None,
            refused: None,
            news: News::default(),
        }
    }

    /// Where it stands.
    pub fn news(&self) -> &News {
        &self.news
    }

    /// Does a part of what a wish takes, some hundredths of a second at most unless it reads and packs a scene. `told` hears before
    /// that which of them it is.
    pub fn step(&mut self, wish: &Wish, told: &dyn Fn(&News)) -> Step {
        if self.refused.as_ref() == Some(wish) {
            return NOTHING;
        }
        self.refused = None;
        match self.go(wish, told) {
            Ok(step) => {
                self.news.fault.clone_from(&self.unread);
                step
            }
            Err(error) => {
                self.news.fault = Some(error.to_string());
                self.growth = None;
                // Left to us, what a GPU can't do is a CPU's.
                let falls_back =
                    wish.device.wish == DeviceWish::Auto && wish.device.several.is_none() && self.is_on_gpu();
                if falls_back {
                    (self.gpu_fault, self.seat, self.seated) = (self.news.fault.clone(), Seat::Empty, None);
                } else {
                    self.refused = Some(wish.clone());
                    self.news.doing = Doing::Nothing;
                }
                Step { picture: None, goes_on: falls_back }
            }
        }
    }

    fn go(&mut self, wish: &Wish, told: &dyn Fn(&News)) -> Result<Step> {
        self.read(wish, told)?;
        let Some(set) = &mut self.set else { return Ok(NOTHING) };
        set.change(wish)?;
        let job = set.job(wish)?;
        self.news.lesson = self.teacher.tell(wish, &job, (set.scene(), set.camera(wish)));
        if !wish.shows.is_of_film() {
            return self.inspect(wish, &job);
        }
        self.inspected = None;
        self.seat(wish, &job, told)?;
        match &self.seat {
            Seat::Ready(..) => self.grow(wish, &job),
            Seat::Opening(_, since) => {
                self.news.doing = Doing::Opening(since.elapsed());
                self.preview(wish, &job)
            }
            Seat::Empty => Ok(NOTHING),
        }
    }

    /// Reads and packs the scene of a wish, unless it is there or can't be had.
    fn read(&mut self, wish: &Wish, told: &dyn Fn(&News)) -> Result<()> {
        if self.source.as_ref() == Some(&wish.source) || wish.source.path.as_os_str().is_empty() {
            return Ok(());
        }
        let before = self.source.replace(wish.source.clone());
        let is_same = before.is_some_and(|before| before.path == wish.source.path);
        self.tell(Doing::Reading, told);
        let set = self.packed(wish, is_same, told);
        self.unread = set.as_ref().err().map(ToString::to_string);
        let set = set?;
        self.news.facts = Some(set.facts.clone());
        (self.set, self.growth) = (Some(set), None);
        self.polisher.forget();
        Ok(())
    }

    fn packed(&mut self, wish: &Wish, is_same: bool, told: &dyn Fn(&News)) -> Result<Set> {
        let read = self.reader.read(&wish.source).map_err(Error::new)?;
        self.tell(Doing::Building, told);
        Set::new(read, &wish.source, wish, self.set.as_ref().filter(|_| is_same))
    }

    fn tell(&mut self, doing: Doing, told: &dyn Fn(&News)) {
        self.news.doing = doing;
        told(&self.news);
    }

    /// Has a session for the job, or one on its way.
    fn seat(&mut self, wish: &Wish, job: &Job, told: &dyn Fn(&News)) -> Result<()> {
        let device = match self.gpu_fault {
            Some(_) if wish.device.wish == DeviceWish::Auto => Device { wish: DeviceWish::Cpu, ..wish.device.clone() },
            _ => wish.device.clone(),
        };
        self.seat.look()?;
        if matches!(self.seat, Seat::Opening(..)) {
            return Ok(());
        }
        let settings = *job.settings();
        let is_same = |seated: &Seated| {
            seated.device == device && seated.settings == settings && std::ptr::eq::<DeviceScene>(&*seated.job, &**job)
        };
        if self.seated.as_ref().is_some_and(is_same) {
            return Ok(());
        }
        self.tell(Doing::Opening(Duration::ZERO), told);
        match &self.seated {
            Some(seated) if seated.device == device && matches!(self.seat, Seat::Ready(..)) => self.seat.turn(job),
            _ => self.seat.open((&device, self.around), self.shared.as_ref(), job),
        }
        self.seated = Some(Seated { device, settings, job: job.clone() });
        (self.growth, self.previewed) = (None, None);
        self.polisher.forget();
        self.pace.forget();
        Ok(())
    }

    /// A layer of the picture, by the CPU.
    fn inspect(&mut self, wish: &Wish, job: &Job) -> Result<Step> {
        let set = self.set.as_ref().expect("there is a job");
        let divisor = if wish.is_moving { 4 } else { 1 };
        let subject = Subject { camera: set.camera(wish).clone(), size: divided(wish.size, divisor) };
        let now = (subject, wish.shows);
        let inspector = match self.inspector.take() {
            Some(inspector) if inspector.is_of(job, &wish.device) => inspector,
            _ => {
                self.inspected = None;
                Inspector::new(job, &wish.device)?
            }
        };
        let inspector = self.inspector.insert(inspector);
        if self.inspected.as_ref() == Some(&now) {
            return Ok(NOTHING);
        }
        let (subject, shows) = &now;
        let shown = inspector.look((job, set.scene()), subject, *shows)?;
        let display = Display::Pixels { size: subject.size, bytes: shown.bytes };
        let picture = Picture { display, size: subject.size, samples: 0, camera: subject.camera.clone() };
        (self.news.scale, self.news.doing, self.inspected) = (shown.scale, Doing::Done, Some(now));
        Ok(Step { picture: Some(picture), goes_on: false })
    }

    fn is_on_gpu(&self) -> bool {
        self.seated.as_ref().is_some_and(|seated| seated.device.wish != DeviceWish::Cpu) && self.gpu_fault.is_none()
    }

    /// What is there by a CPU until kernels are: the colours of surfaces, of a quarter of the columns and rows.
    fn preview(&mut self, wish: &Wish, job: &Job) -> Result<Step> {
        let size = divided(wish.size, 2);
        let camera = self.set.as_ref().expect("there is a job").camera(wish).clone();
        let subject = Subject { camera, size };
        if self.previewed.as_ref() == Some(&subject) {
            std::thread::sleep(Duration::from_millis(5));
            return Ok(Step { picture: None, goes_on: true });
        }
        let job = job.with(Settings { size, ..*job.settings() })?;
        let view = View::new(&job, &subject.camera)?;
        let picture = layers::preview(&job, &subject.camera, view.region(), 0)?;
        let display = Display::of(&picture, &wish.look)?;
        let picture = Picture { display, size, samples: 0, camera: subject.camera.clone() };
        self.previewed = Some(subject);
        Ok(Step { picture: Some(picture), goes_on: true })
    }

    /// What renders, if it is ready.
    pub fn session(&mut self) -> Option<&mut Session> {
        match &mut self.seat {
            Seat::Ready(session, _) => Some(session),
            Seat::Empty | Seat::Opening(..) => None,
        }
    }
}

/// Columns and rows of a picture that is so many times smaller.
fn divided((width, height): (u32, u32), divisor: u32) -> (u32, u32) {
    (width.div_ceil(divisor).max(1), height.div_ceil(divisor).max(1))
}

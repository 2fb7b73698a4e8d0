//! The picture itself: its light, which grows by samples, and what of it is known.

use std::time::{Duration, Instant};

use eyerays::error::{Error, Result};
use eyerays::job::Job;
use eyerays::line::one_line;
use eyerays::render::{DeviceWish, Display};
use eyerays::scene::Settings;
use eyerays::view::View;

use super::growth::{Growth, Subject};
use super::seat::Seat;
use super::{Step, Studio, divided};
use crate::news::{Doing, Light, Picture};
use crate::shows::Shows;
use crate::wish::Wish;

/// Noise of a film on a GPU is told that often: the film has to be read for it.
const TELL_NOISE: Duration = Duration::from_secs(1);

impl Studio {
    /// Adds samples, of another film where something else is to be seen.
    pub(super) fn grow(&mut self, wish: &Wish, job: &Job) -> Result<Step> {
        let Seat::Ready(session, is_shared) = &mut self.seat else { unreachable!("it was just ready") };
        let camera = self.set.as_ref().expect("there is a job").camera(wish);
        let divisor = match wish.is_moving {
            true => self.pace.divisor(u64::from(wish.size.0) * u64::from(wish.size.1)),
            false => 1,
        };
        let subject = Subject { camera: camera.clone(), size: divided(wish.size, divisor) };
        if self.growth.as_ref().is_none_or(|growth| growth.subject != subject) {
            let job = job.with(Settings { size: subject.size, ..*job.settings() })?;
            let view = View::new(&job, &subject.camera)?;
            self.growth = Some(Growth::new(session, view, subject, &self.pace)?);
            (self.news.noise, self.noise_told) = (None, None);
        }
        let growth = self.growth.as_mut().expect("it was just made");
        let most = if wish.is_moving || (wish.is_paused && growth.samples() == 0) { 1 } else { wish.most };
        let before = growth.samples();
        let rays = if wish.is_paused && before > 0 { 0 } else { growth.add(session, most, &mut self.pace)? };
        let (samples, added) = (growth.samples(), rays > 0);
        self.meter.count(samples - before, rays);
        let (size, camera) = (growth.subject.size, growth.subject.camera.clone());
        let light = growth.display((session, *is_shared), (wish.look, wish.shows), !added)?;
        self.news.scale = growth.scale();
        let name = session.device_name();
        self.news.device = match &self.gpu_fault {
            Some(fault) if wish.device.wish == DeviceWish::Auto => {
                format!("{name}, since a GPU failed: {}", one_line(fault))
            }
            _ => name.to_owned(),
        };
        if let Some(rates) = self.meter.rates(session.device_time()) {
            self.news.rates = rates;
        }
        self.news.samples = samples;
        self.news.doing = if added { Doing::Rendering } else { Doing::Done };
        self.tell_noise(!added)?;
        let display = self.polish(wish, job, light, !added)?;
        let picture = display.map(|display| Picture { display, size, samples, camera });
        if !added && self.polisher.is_busy() {
            std::thread::sleep(Duration::from_millis(5));
        }
        Ok(Step { picture, goes_on: added || self.polisher.is_busy() })
    }

    /// The picture without its noise in the place of its light, where that is wished for and there is one.
    fn polish(&mut self, wish: &Wish, job: &Job, light: Option<Display>, is_done: bool) -> Result<Option<Display>> {
        self.polisher.look()?;
        self.news.denoised = None;
        let (Seat::Ready(session, _), Some(growth)) = (&mut self.seat, &self.growth) else { return Ok(light) };
        let (subject, samples) = (&growth.subject, growth.samples());
        let is_wished = wish.shows == Shows::Denoised && !wish.is_moving;
        if is_wished && job.settings().transport.integrator.samples() {
            if growth.is_even() && self.polisher.is_due(subject, samples, is_done) {
                self.polisher.start(session.film()?, (job, wish.device.threads), (subject.clone(), samples));
            }
            if let Some(polished) = self.polisher.polished(subject) {
                self.news.denoised = Some(polished.samples);
                return self.polisher.display(subject, wish.look);
            }
        }
        if light.is_some() {
            self.polisher.cover();
        }
        Ok(light)
    }

    /// Finds out how noisy the picture is, now and then.
    fn tell_noise(&mut self, is_done: bool) -> Result<()> {
        let Seat::Ready(session, _) = &mut self.seat else { return Ok(()) };
        let has_any = session.job().settings().transport.integrator.samples() && self.news.samples > 1;
        let is_due = self.noise_told.is_none_or(|told| told.elapsed() >= TELL_NOISE) || is_done;
        if has_any && is_due && self.growth.as_ref().is_some_and(Growth::is_even) {
            let film = session.film()?;
            self.news.noise = session.develop(&film)?.noise();
            self.noise_told = Some(Instant::now());
        }
        Ok(())
    }

    /// What the samples have come to.
    pub(super) fn light(&mut self, wish: &Wish) -> Result<Light> {
        let not_yet = || Error::new("there is no picture yet");
        let growth = self.growth.as_ref().filter(|growth| growth.is_even() && growth.samples() > 0);
        let samples = growth.ok_or_else(not_yet)?.samples();
        let session = self.session().ok_or_else(not_yet)?;
        let film = session.film()?;
        Ok(Light { wish: wish.clone(), samples, picture: session.develop(&film)? })
    }
}

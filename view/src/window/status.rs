//! The line below the picture.

use eframe::egui::{Color32, Label, Panel, RichText, Ui};

use super::{STATUS_HEIGHT, Window};
use crate::news::{Doing, News};

/// So long it is told what was done, in seconds.
const TOLD: f32 = 4.0;

impl Window {
    /// Samples, noise and speed, and what went wrong.
    pub(super) fn status(&mut self, ui: &mut Ui) {
        if self.show.said.as_ref().is_some_and(|(at, _)| at.elapsed().as_secs_f32() > TOLD) {
            self.show.said = None;
        }
        Panel::bottom("status").exact_size(STATUS_HEIGHT).show_separator_line(false).show(ui, |ui| {
            // One line, whatever there is to say: the picture above must not move.
            ui.horizontal_centered(|ui| {
                let text = match (&self.news.fault, &self.show.said) {
                    (Some(fault), _) => RichText::new(format!("error: {fault}")).color(Color32::LIGHT_RED),
                    (None, Some((_, said))) => RichText::new(said).strong(),
                    (None, None) => {
                        let beside =
                            self.beside.as_ref().map_or(String::new(), |beside| format!(" | {}", beside.line()));
                        RichText::new(line(&self.news, self.wish.is_paused) + &beside)
                    }
                };
                ui.add(Label::new(text.clone()).truncate()).on_hover_text(text);
            });
        });
    }
}

/// What a studio has told, in a line.
fn line(news: &News, is_paused: bool) -> String {
    let doing = match &news.doing {
        Doing::Nothing if news.facts.is_none() => {
            return "drop a scene here: .toml, .gltf, .glb, .obj, .ply, .eyerays".to_owned();
        }
        Doing::Nothing => "nothing to do".to_owned(),
        Doing::Reading => "reading".to_owned(),
        Doing::Building => "building the hierarchy".to_owned(),
        Doing::Opening(since) => format!("compiling kernels, {:.1} s", since.as_secs_f64()),
        Doing::Rendering | Doing::Done => samples(news),
    };
    let paused = if is_paused { "paused, " } else { "" };
    let device = if news.device.is_empty() { "" } else { " | " };
    format!("{paused}{doing}{device}{} | N: settings and keys", news.device)
}

fn samples(news: &News) -> String {
    let News { samples, denoised, noise, rates, .. } = news;
    let mut parts = vec![format!("{samples} sample{}", if *samples == 1 { "" } else { "s" })];
    parts.extend(denoised.map(|samples| format!("denoised at {samples}")));
    parts.extend(noise.map(|noise| format!("noise {:.2} %", 100.0 * noise)));
    if news.doing == Doing::Rendering {
        let digits = if rates.frames < 10.0 { 1 } else { 0 };
        parts.push(format!("{:.digits$} frames/s", rates.frames));
        parts.push(format!("{:.1} Mrays/s from the camera", rates.rays / 1e6));
        parts.extend(rates.device.map(|share| format!("device {:.0} % busy", 100.0 * share)));
    }
    let number = |of: f64| if of.fract() == 0.0 { format!("{of}") } else { format!("{of:.4}") };
    parts.extend(
        news.scale.map(|[dark, bright]| format!("black is {}, the brightest {}", number(dark), number(bright))),
    );
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::news::Rates;

    #[test]
    fn what_is_told_of_a_picture_that_grows() {
        let rates = Rates { frames: 59.7, rays: 12.34e6, device: Some(0.875) };
        let news = News {
            doing: Doing::Rendering,
            device: "CPU (2 threads)".to_owned(),
            samples: 16,
            noise: Some(0.0123),
            rates,
            ..News::default()
        };
        let told = "16 samples, noise 1.23 %, 60 frames/s, 12.3 Mrays/s from the camera, device 88 % busy | CPU (2 threads) | N: settings and keys";
        assert_eq!(line(&news, false), told);
        assert_eq!(
            line(&News { doing: Doing::Done, ..news }, true),
            "paused, 16 samples, noise 1.23 % | CPU (2 threads) | N: settings and keys"
        );
        assert!(line(&News::default(), false).starts_with("drop a scene here"));
    }
}

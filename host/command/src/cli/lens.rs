//! The lens of a camera, and how it maps what it sees, from the command line.

use clap::{Args, ValueEnum};
use eyerays::scene::{Camera, Focus, Lens, Mapping, Projection, Stereo, StereoLayout};

use super::choice::choice;
use crate::error::{Error, Result};

/// What an image holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// What is seen through a pinhole or a lens
    Perspective,
    /// All around, by longitude and latitude, for an image twice as wide as high
    Equirectangular,
    /// A circle of --fov degrees, 180 if it is not said
    Fisheye,
}

/// The lens, and the projection.
#[derive(Args, Clone, Default)]
#[command(next_help_heading = "View")]
pub(super) struct LensArgs {
    /// Vertical field of view in degrees [default: the camera's, 60 with --eye and no --camera]
    #[arg(long, value_name = "D")]
    fov: Option<f32>,
    /// What the image holds [default: the camera's]
    #[arg(long, value_name = "KIND")]
    projection: Option<Kind>,
    /// See along parallel rays instead, an image so high in the scene's units
    #[arg(long, value_name = "HEIGHT", conflicts_with_all = ["fov", "projection", "f_stop"])]
    orthographic: Option<f32>,
    /// A lens of this radius, in the scene's units; 0 for a pinhole [default: the camera's]
    #[arg(long, value_name = "RADIUS", conflicts_with = "f_stop")]
    aperture: Option<f32>,
    /// The same by its f-number, for a scene in metres and a sensor 24 mm high
    #[arg(long, value_name = "N")]
    f_stop: Option<f32>,
    /// Sharp at this distance in front of the eye [default: the camera's, or where it looks]
    #[arg(long, value_name = "DISTANCE", conflicts_with = "focus_on")]
    focus: Option<f32>,
    /// Sharp where this pixel of the picture shows something, by its column and row from 0
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    focus_on: Option<(u32, u32)>,
    /// Blades of the lens' diaphragm, 3 to 32; 0 for a round one
    #[arg(long, value_name = "N")]
    blades: Option<u32>,
    /// See nothing nearer than this, along the view, in the scene's units: to look into closed rooms [default: the camera's]
    #[arg(long, value_name = "DISTANCE")]
    clip_near: Option<f32>,
    /// And nothing farther [default: the camera's]
    #[arg(long, value_name = "DISTANCE")]
    clip_far: Option<f32>,
    /// Images of two eyes in one, each of half the size
    #[arg(long, value_name = "LAYOUT", value_parser = choice::<StereoLayout>())]
    stereo: Option<StereoLayout>,
    /// How far the eyes are apart, in the scene's units [default: the camera's, or 0.063]
    #[arg(long, value_name = "DISTANCE")]
    eye_distance: Option<f32>,
    /// How far away both eyes look at one place [default: the camera's, or parallel]
    #[arg(long, value_name = "DISTANCE")]
    convergence: Option<f32>,
}

impl LensArgs {
    /// The pixel that the picture is to be sharp at.
    pub fn focus_on(&self) -> Option<(u32, u32)> {
        self.focus_on
    }

    /// A camera with these options over its own.
    ///
    /// # Errors
    /// A number out of range, or what the projection has not.
    pub fn over(&self, mut camera: Camera) -> Result<Camera> {
        camera.projection = self.projected(camera.projection)?;
        camera.lens = self.lens(&camera)?;
        camera.clip = self.clip(camera.clip)?;
        camera.stereo = self.stereo(&camera)?;
        Ok(camera)
    }

    fn projected(&self, own: Projection) -> Result<Projection> {
        if let Some(height) = self.orthographic {
            let is_possible = height.is_finite() && height > 0.0;
            let refusal = || Error::new(format!("--orthographic {height} is no height: give a number greater than 0"));
            return is_possible.then_some(Projection::Orthographic { height }).ok_or_else(refusal);
        }
        match (self.projection, own) {
            (Some(Kind::Equirectangular), _) | (None, Projection::Equirectangular) if self.fov.is_some() => {
                Err(Error::new("--fov: an equirectangular image shows all around; leave it out"))
            }
            (Some(Kind::Equirectangular), _) | (None, Projection::Equirectangular) => Ok(Projection::Equirectangular),
            (Some(Kind::Fisheye), Projection::Fisheye { fov, mapping })
            | (None, Projection::Fisheye { fov, mapping }) => {
                Ok(Projection::Fisheye { fov: self.angle(360.0)?.unwrap_or(fov), mapping })
            }
            (Some(Kind::Fisheye), _) => {
                Ok(Projection::Fisheye { fov: self.angle(360.0)?.unwrap_or(180.0), mapping: Mapping::default() })
            }
            (Some(Kind::Perspective), _) => {
                Ok(Projection::Perspective { fov: self.angle(180.0)?.or(own.fov()).unwrap_or(60.0) })
            }
            (None, own) => Ok(self.angle(180.0)?.map_or(own, |fov| Projection::Perspective { fov })),
        }
    }

    /// Of a view, below 180 degrees or up to a whole turn.
    fn angle(&self, most: f32) -> Result<Option<f32>> {
        match self.fov {
            Some(fov) if !(fov > 0.0 && (fov < most || fov == most && most == 360.0)) => {
                Err(Error::new(format!("--fov {fov} is not between 0 and {most} degrees")))
            }
            fov => Ok(fov),
        }
    }

    /// The radius that is asked for, if one is.
    fn radius(&self, projection: Projection) -> Result<Option<f32>> {
        let radius = match (self.f_stop, projection) {
            (None, _) => self.aperture,
            (Some(f_stop), Projection::Perspective { fov }) if f_stop > 0.0 => {
                Some(Lens::radius_of(f_stop, fov, Lens::SENSOR))
            }
            (Some(f_stop), Projection::Perspective { .. }) => {
                return Err(Error::new(format!("--f-stop {f_stop} is no f-number: give one greater than 0")));
            }
            (Some(_), _) => return Err(Error::new("--f-stop is of a perspective camera; give its --aperture")),
        };
        match radius {
            Some(radius) if !(radius.is_finite() && radius >= 0.0) => {
                Err(Error::new(format!("--aperture {radius} is no radius: give a number of at least 0")))
            }
            radius => Ok(radius),
        }
    }

    fn lens(&self, camera: &Camera) -> Result<Option<Lens>> {
        let lens = match (self.radius(camera.projection)?, camera.lens) {
            (Some(0.0), _) => None,
            (Some(radius), Some(own)) => Some(Lens { radius, ..own }),
            (Some(radius), None) => Some(Lens::round(radius)),
            (None, own) => own,
        };
        let Some(lens) = lens else {
            let none = "the camera has no lens; add --aperture or --f-stop";
            return self.of_a_lens().map_or(Ok(None), |option| Err(Error::new(format!("{option}: {none}"))));
        };
        if !camera.projection.is_flat() {
            return Err(Error::new("an image of all around has no lens: leave out its --aperture, or give 0"));
        }
        let focus = match self.focus {
            Some(distance) if !(distance.is_finite() && distance > 0.0) => {
                return Err(Error::new(format!("--focus {distance} is no distance: give a number greater than 0")));
            }
            distance => distance.map_or(lens.focus, Focus::Distance),
        };
        let blades = self.blades.unwrap_or(lens.blades);
        if !Lens::can_have(blades) {
            let most = Lens::MOST_BLADES;
            return Err(Error::new(format!("--blades {blades}: a lens has 3 to {most}, or 0 for a round one")));
        }
        Ok(Some(Lens { focus, blades, ..lens }))
    }

    fn clip(&self, [near, far]: [f32; 2]) -> Result<[f32; 2]> {
        let clip = [self.clip_near.unwrap_or(near), self.clip_far.unwrap_or(far)];
        let is_possible = clip[0] >= 0.0 && clip[0].is_finite() && clip[0] < clip[1];
        let refusal = || {
            let [near, far] = clip;
            Error::new(format!(
                "nothing lies between {near} and {far}: give --clip-near at least 0, and --clip-far more"
            ))
        };
        is_possible.then_some(clip).ok_or_else(refusal)
    }

    fn stereo(&self, camera: &Camera) -> Result<Option<Stereo>> {
        for (option, distance) in [("--eye-distance", self.eye_distance), ("--convergence", self.convergence)] {
            let is_possible = distance.is_none_or(|distance| distance.is_finite() && distance > 0.0);
            if let (Some(distance), false) = (distance, is_possible) {
                return Err(Error::new(format!("{option} {distance} is no distance: give a number greater than 0")));
            }
        }
        let own = camera.stereo;
        let Some(layout) = self.stereo.or(own.map(|own| own.layout)) else {
            let idle = self.eye_distance.map(|_| "--eye-distance").or(self.convergence.map(|_| "--convergence"));
            let none = "the camera has one eye; add --stereo";
            return idle.map_or(Ok(None), |option| Err(Error::new(format!("{option}: {none}"))));
        };
        let distance = self.eye_distance.or(own.map(|own| own.distance)).unwrap_or(Stereo::HUMAN);
        let convergence = self.convergence.or(own.and_then(|own| own.convergence));
        let stereo = Stereo { layout, distance, convergence };
        match stereo.misfit(camera.projection) {
            Some((key, why)) => Err(Error::new(format!("--{key}: {why}; leave it out"))),
            None => Ok(Some(stereo)),
        }
    }

    /// An option that only says how a lens is, if one is given.
    fn of_a_lens(&self) -> Option<&'static str> {
        let (focus, blades) = (self.focus.map(|_| "--focus"), self.blades.map(|_| "--blades"));
        focus.or(self.focus_on.map(|_| "--focus-on")).or(blades)
    }
}

/// `X,Y`.
fn pixel(text: &str) -> std::result::Result<(u32, u32), String> {
    let parts = text.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    parts.ok_or_else(|| "write a column and a row from 0, for example 320,200".to_owned())
}

//! Pictures of a scene, whose film grows by samples.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use eyerays::choice::Named;
use eyerays::error::{Error, Result};
use eyerays::film::{Film, Identity};
use eyerays::image::{Encoding, Format, encode};
use eyerays::layers::{self, Layer, Shown, Values};
use eyerays::picture::Picture;
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish, Precision, Rendering, Session};
use eyerays::scene::{Camera, Scene, Settings};
use eyerays::scene_io::{self, Loading, Moment};
use eyerays::view::View;
use eyerays::watch::{Growth, Watch};
use numpy::ndarray::Array3;
use numpy::{IntoPyArray, PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::error::{raised, raised_of};
use crate::gpu;

/// A scene and how it is seen.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Wish {
    /// The scene file, whose text may be given.
    path: PathBuf,
    text: Option<String>,
    /// Tables that go before its own.
    over: String,
    /// One of its cameras by its name.
    camera: Option<String>,
    /// The moment of what moves.
    seconds: Option<f64>,
    layers: Vec<String>,
    device: String,
    precision: String,
    threads: usize,
}

/// What errors call the tables of [`Wish::over`].
const ARGUMENTS: &str = "arguments";

/// What is rendered, and what has been.
struct State {
    session: Session,
    scene: Scene,
    camera: Camera,
    /// Of as many samples as may be asked for.
    view: View,
    layers: Vec<Layer>,
    identity: Identity,
    device: String,
    done: Option<Rendering>,
}

/// Layers by their names.
type Layers = Vec<(Layer, Values)>;

/// A session.
#[pyclass(frozen, module = "eyerays._native")]
pub struct Studio(Mutex<State>);

#[pymethods]
impl Studio {
    /// Reads a scene and gets it ready; and what warnings say.
    #[staticmethod]
    fn open(py: Python<'_>, wish: Wish) -> PyResult<(Studio, Vec<String>)> {
        let opened = py.detach(|| State::open(&wish));
        let texts: &[&Path] =
            if wish.text.is_some() { &[ARGUMENTS.as_ref(), &wish.path] } else { &[ARGUMENTS.as_ref()] };
        let (state, said) = opened.map_err(|error| raised_of(error, texts))?;
        Ok((Studio(Mutex::new(state)), said))
    }

    /// Adds samples to every pixel. `progress` hears of them.
    fn add(&self, py: Python<'_>, samples: u32, progress: Option<Bound<'_, PyAny>>) -> PyResult<()> {
        let progress = progress.map(Bound::unbind);
        let stop = AtomicBool::new(false);
        let failed: Mutex<Option<PyErr>> = Mutex::new(None);
        let done = py.detach(|| {
            let mut state = self.state();
            let before = state.samples();
            let grown = |growth: Growth<'_>| {
                let count = (growth.samples.saturating_sub(before), samples);
                let heard = Python::attach(|py| {
                    py.check_signals()?;
                    progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, count).map(drop))
                });
                if let Err(error) = heard {
                    *failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                    stop.store(true, Ordering::Relaxed);
                }
            };
            state.add(samples, &Watch { limit: None, stop: &stop, grown: &grown })
        });
        if let Some(error) = failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        done.map_err(raised)
    }

    /// Samples that every pixel has.
    #[getter]
    fn samples(&self, py: Python<'_>) -> u32 {
        py.detach(|| self.state().samples())
    }

    /// What renders.
    #[getter]
    fn device(&self, py: Python<'_>) -> String {
        py.detach(|| self.state().device.clone())
    }

    /// The picture: three numbers a pixel, or four where the surroundings are left out.
    fn picture<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let array = py.detach(|| self.state().rendering().map(|done| pixels(&done.picture))).map_err(raised)?;
        Ok(array.into_pyarray(py))
    }

    /// The hash of the picture's bits, as the program prints it.
    fn hash(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.state().rendering().map(|done| done.picture.hash())).map_err(raised)
    }

    /// The layers that were asked for, by their names.
    fn layers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (layers, size) = py.detach(|| self.state().layers()).map_err(raised)?;
        let arrays = PyDict::new(py);
        for (name, values) in layers {
            put(&arrays, name, values, size)?;
        }
        Ok(arrays)
    }

    /// The film as a file has it, to be gone on with.
    fn film<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &py.detach(|| self.state().film()).map_err(raised)?))
    }

    /// Takes the samples of a film file that are not there yet.
    fn merge(&self, py: Python<'_>, film: Vec<u8>) -> PyResult<()> {
        py.detach(|| self.state().merge(&film)).map_err(raised)
    }
}

impl Studio {
    fn state(&self) -> MutexGuard<'_, State> {
        // A film is the one before or the one after, whatever failed.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn open(wish: &Wish) -> Result<(State, Vec<String>)> {
        let moment = Moment { seconds: wish.seconds, ..Moment::default() };
        let loading = Loading { moment, ..Loading::default() };
        let (mut scene, warnings) = match &wish.text {
            Some(text) => scene_io::read_as(text.as_bytes(), &wish.path, loading)?,
            None => scene_io::load_as(&wish.path, loading)?,
        };
        let mut said: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        scene_io::overlay(&mut scene, ARGUMENTS.as_ref(), &wish.over)?;
        said.extend(scene.settings.transport.integrator.ignored(&scene));
        let layers = wish.layers.iter().map(|name| Layer::from_name(name)).collect::<Result<Vec<_>>>()?;
        let choice = Choice {
            device: DeviceWish::from_name(&wish.device)?,
            precision: Precision::from_name(&wish.precision)?,
            threads: wish.threads,
            ..Choice::default()
        };
        let camera = camera(&scene, wish.camera.as_deref())?;
        let job = choice.pack(&scene, scene.settings, Bvh::Medium.quality())?.keeping(layers::asked(&layers))?;
        // Of a sampler without a grid there is always another sample.
        let own = scene.settings.samples_a_pixel();
        let most = if scene.settings.sampler.has_cells() { own } else { Settings::MOST_SPP };
        let view = View::new(&job.with(Settings { spp: most, ..scene.settings })?, &camera)?;
        let backend = backend(&choice)?;
        let identity = Identity::of(scene_io::fingerprint(&scene)?, &job, &view, choice.precision)?;
        let identity = match choice.precision {
            Precision::Fast => identity.on(&backend.description(), choice.traversal),
            _ => identity,
        };
        let (session, device) = (backend.open(&job)?, backend.description());
        Ok((State { session, scene, camera, view, layers, identity, device, done: None }, said))
    }

    fn samples(&self) -> u32 {
        self.done.as_ref().map_or(0, |done| done.samples)
    }

    fn rendering(&self) -> Result<&Rendering> {
        self.done.as_ref().ok_or_else(|| Error::new("there is no sample yet: add some"))
    }

    fn add(&mut self, samples: u32, watch: &Watch<'_>) -> Result<()> {
        let (from, most) = (self.done.take(), self.view.samples());
        let before = from.as_ref().map_or(0, |done| done.samples);
        let rendered = match before.checked_add(samples).filter(|&end| end <= most) {
            Some(end) => {
                let part = self.view.part(self.view.region(), 0..end);
                let film = from.as_ref().and_then(|done| done.film.as_ref());
                part.and_then(|part| self.session.render_watched(&part, film, watch))
            }
            None => Err(Error::new(format!("{before} samples and {samples} are more than {most} a pixel"))),
        };
        self.done = match rendered {
            Ok(done) => {
                self.device.clone_from(&done.device);
                Some(done)
            }
            Err(error) => {
                self.done = from;
                return Err(error);
            }
        };
        Ok(())
    }

    fn layers(&mut self) -> Result<(Layers, (u32, u32))> {
        let done = self.done.as_ref().ok_or_else(|| Error::new("there is no sample yet: add some"))?;
        let shown = Shown { scene: &self.scene, camera: &self.camera, neighbours: None };
        let size = (done.picture.width, done.picture.height);
        Ok((layers::render(&mut self.session, shown, done, &self.layers)?, size))
    }

    fn film(&self) -> Result<Vec<u8>> {
        let film = self.rendering()?.film.as_ref().ok_or_else(|| Error::new("the picture has no film"))?;
        let (mut film, mut bytes) = (film.clone(), Vec::new());
        film.identity = self.identity.clone();
        film.write(&mut bytes)?;
        Ok(bytes)
    }

    fn merge(&mut self, bytes: &[u8]) -> Result<()> {
        let film = Film::read(&mut &*bytes)?;
        self.identity.check(&film.identity)?;
        let stop = AtomicBool::new(false);
        let all = match self.done.as_ref().and_then(|done| done.film.clone()) {
            Some(mut own) => {
                own.identity = self.identity.clone();
                own.merge(film)?;
                own
            }
            None => film,
        };
        let end = (all.coverage().volume() / self.view.region().pixels()) as u32;
        let part = self.view.part(self.view.region(), 0..end)?;
        self.done = Some(self.session.render_watched(
            &part,
            Some(&all),
            &Watch { limit: None, stop: &stop, grown: &|_| () },
        )?);
        Ok(())
    }
}

/// One of a scene's cameras, its first without a name.
fn camera(scene: &Scene, name: Option<&str>) -> Result<Camera> {
    let found = scene.cameras.iter().find(|camera| name.is_none_or(|name| camera.name == name));
    found.cloned().ok_or_else(|| {
        let names: Vec<&str> = scene.cameras.iter().map(|camera| &*camera.name).collect();
        Error::new(format!("no camera is called {:?}; there is {}", name.unwrap_or_default(), names.join(", ")))
    })
}

/// The device, which all sessions of a process share if it is a GPU.
fn backend(choice: &Choice) -> Result<Backend> {
    match choice.device {
        DeviceWish::Gpu => Backend::on(gpu::any()?, choice),
        DeviceWish::Auto if choice.precision != Precision::Reference => match gpu::hardware() {
            Some(gpu) => Backend::on(gpu, choice),
            None => Backend::new(&Choice { device: DeviceWish::Cpu, ..choice.clone() }),
        },
        _ => Backend::new(&Choice { device: DeviceWish::Cpu, ..choice.clone() }),
    }
}

/// Rows, columns, channels.
fn pixels(picture: &Picture) -> Array3<f32> {
    let size = (picture.height as usize, picture.width as usize);
    let array = match &picture.alpha {
        None => Array3::from_shape_vec((size.0, size.1, 3), picture.pixels.as_flattened().to_vec()),
        Some(alpha) => {
            let with = picture.pixels.iter().zip(alpha).flat_map(|(&[r, g, b], &a)| [r, g, b, a]);
            Array3::from_shape_vec((size.0, size.1, 4), with.collect())
        }
    };
    array.expect("a picture has all of its pixels")
}

/// Puts a layer where its name says.
fn put(arrays: &Bound<'_, PyDict>, layer: Layer, values: Values, (width, height): (u32, u32)) -> PyResult<()> {
    let (py, name, size) = (arrays.py(), layer.name(), [height as usize, width as usize]);
    match values {
        Values::Light(picture)
        | Values::Colours(picture)
        | Values::Vectors(picture)
        | Values::Coordinates(picture)
        | Values::Ways(picture) => arrays.set_item(name, pixels(&picture).into_pyarray(py)),
        Values::Lengths(lengths) => arrays.set_item(name, lengths.into_pyarray(py).reshape(size)?),
        Values::Numbers(numbers) => arrays.set_item(name, numbers.into_pyarray(py).reshape(size)?),
        Values::Parts(parts) => {
            parts.iter().try_for_each(|(name, picture)| arrays.set_item(name, pixels(picture).into_pyarray(py)))
        }
        Values::Shares(_) => {
            Err(PyValueError::new_err(format!("the layer {name} is one of files alone; ask the program for it")))
        }
    }
}

/// A picture (height, width, 3 or 4) as a PNG.
#[pyfunction]
pub fn png<'py>(py: Python<'py>, picture: PyReadonlyArray3<'_, f32>, exposure: f32) -> PyResult<Bound<'py, PyBytes>> {
    let shape = picture.shape();
    let [height, width] = [0, 1].map(|axis| u32::try_from(shape[axis]).unwrap_or(u32::MAX));
    Picture::check_size(width, height).map_err(raised)?;
    if ![3, 4].contains(&shape[2]) {
        return Err(PyValueError::new_err(format!("a picture has three numbers a pixel or four, not {}", shape[2])));
    }
    let rows = picture.as_array();
    let pixels = rows.rows().into_iter().map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let alpha = (shape[2] == 4).then(|| rows.rows().into_iter().map(|pixel| pixel[3]).collect());
    let mut picture = Picture::from_pixels(width, height, pixels).map_err(raised)?;
    picture.alpha = alpha;
    let encoding = Encoding { exposure_ev: exposure, ..Encoding::default() };
    let mut bytes = Vec::new();
    py.detach(|| encode(&picture, Format::Png, &encoding, &mut bytes)).map_err(raised)?;
    Ok(PyBytes::new(py, &bytes))
}

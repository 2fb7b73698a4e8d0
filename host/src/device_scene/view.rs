//! A scene as the kernels of a processor see it.

use eyerays_shader::bvh8::Bvh8View;
use eyerays_shader::data::{Frame, Launch, Light as LightRecord, Media, Specialisation};
use eyerays_shader::integrator::ScatterContext;
use eyerays_shader::light as shading;
use eyerays_shader::material::Albedos;
use eyerays_shader::scene::{LaunchContext, ShadingData, TraceContext};
use eyerays_shader::texture::Textures;
use eyerays_shader::traverse::Cutout;

use super::{Lighting, NodeWords, PrimitiveWords};
use crate::error::Result;
use crate::job::Job;
use crate::method::{Method, Traversal};
use crate::scene::Light;

/// A scene laid out for a traversal, once for all launches.
pub struct SceneView {
    /// The scene, and what is asked of it.
    pub job: Job,
    /// How its rays are followed.
    pub traversal: Traversal,
    nodes: NodeWords,
    primitives: PrimitiveWords,
    /// Other lights than the scene's.
    relit: Option<(Vec<LightRecord>, Lighting)>,
}

impl SceneView {
    /// Lays out what the traversal does not take as it is packed.
    pub fn new(job: &Job, traversal: Traversal) -> Self {
        let (nodes, primitives) = (NodeWords::of(job, traversal.layout), PrimitiveWords::of(job, traversal.layout));
        let view = SceneView { job: job.clone(), traversal, nodes, primitives, relit: None };
        // Made now, on the threads of whoever asks.
        view.bvh8();
        view
    }

    fn bvh8(&self) -> Bvh8View<'_> {
        match self.traversal.method {
            Method::Auto | Method::Wide => self.job.bvh8().borrow(),
            _ => Bvh8View::default(),
        }
    }

    /// Lights in file order.
    pub fn lights(&self) -> &[LightRecord] {
        self.relit.as_ref().map_or(self.job.lights(), |(lights, _)| lights)
    }

    /// What surfaces look like.
    pub fn shading(&self) -> ShadingData<'_> {
        let packed = &self.job;
        ShadingData {
            normals: packed.normals(),
            materials: packed.materials(),
            tangents: &packed.textures().tangents,
            maps: &packed.textures().maps,
            textures: self.textures(),
        }
    }

    fn textures(&self) -> Textures<'_> {
        let textures = self.job.textures();
        Textures {
            textures: &textures.textures,
            texels: &textures.texels,
            coordinates: &textures.coordinates,
            colours: &textures.colours,
        }
    }

    /// What an integrator chooses from that samples one light of all.
    fn lighting(&self) -> shading::Lighting<'_> {
        let lighting = self.relit.as_ref().map_or(self.job.lighting(), |(_, lighting)| lighting);
        shading::Lighting {
            emitters: &lighting.emitters,
            nodes: &lighting.nodes,
            emissions: &lighting.emissions,
            textures: self.textures(),
            environment: self.job.environment(),
            spectra: self.job.spectra(),
        }
    }

    /// What scatters where integrators sample.
    pub fn scattering(&self) -> ScatterContext<'_> {
        let (physicals, albedos) = (self.job.physicals(), Albedos(self.job.albedos()));
        let media = self.job.media();
        ScatterContext {
            finishes: self.job.finishes(),
            shading: self.shading(),
            physicals,
            albedos,
            lighting: self.lighting(),
            media,
            grids: self.job.grids(),
        }
    }

    /// Takes other lights.
    ///
    /// # Errors
    /// As [`DeviceScene::relit`](super::DeviceScene::relit).
    pub fn set_lights(&mut self, lights: &[Light]) -> Result<()> {
        self.relit = Some(self.job.relit(lights)?);
        Ok(())
    }

    /// What kernels are compiled for that follow the camera's rays.
    pub fn specialisation(&self) -> Specialisation {
        self.job.specialisation(&self.traversal)
    }

    /// The scene for a launch by a kernel that is compiled for `spec`.
    pub fn context<'g>(&'g self, frame: &'g Frame, spec: Specialisation) -> TraceContext<'g> {
        TraceContext {
            base: LaunchContext::new(frame, spec, self.primitives.words(&self.job), self.job.instances()),
            nodes: self.nodes.words(&self.job),
            wide: self.job.wide(),
            bvh8: self.bvh8(),
            cutout: Cutout { opacities: &self.job.textures().opacities, textures: self.textures() },
        }
    }

    /// The same for rays that meet surfaces, too, which are not there themselves.
    pub(crate) fn stream_through_media<'g>(&'g self, frame: &'g Frame) -> TraceContext<'g> {
        self.context(frame, self.specialisation().with_launch(Launch::STREAM))
    }

    /// The scene for a launch of a stream's rays, see [`DeviceScene::stream_frame`](super::DeviceScene::stream_frame).
    pub fn stream<'g>(&'g self, frame: &'g Frame) -> TraceContext<'g> {
        // Rays of their own meet what is there.
        let spec = Specialisation { media: Media::default(), ..self.specialisation() };
        self.context(frame, spec.with_launch(Launch::STREAM))
    }
}

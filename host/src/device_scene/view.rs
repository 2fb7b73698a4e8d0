//! A scene as the kernels of a processor see it.

use std::borrow::Cow;

use eyerays_shader::bvh8::Bvh8View;
use eyerays_shader::data::{Frame, Launch, Light as LightRecord, Specialisation};
use eyerays_shader::integrator::ScatterContext;
use eyerays_shader::light as shading;
use eyerays_shader::material::Albedos;
use eyerays_shader::scene::{LaunchContext, ShadingData, TraceContext};
use eyerays_shader::texture::Textures;
use eyerays_shader::traverse::Cutout;

use super::{DeviceScene, Lighting, NodeWords, PrimitiveWords};
use crate::error::Result;
use crate::method::{Method, Traversal};
use crate::scene::Light;

/// A scene laid out for a traversal, once for all launches.
pub struct SceneView<'a> {
    /// The scene.
    pub packed: &'a DeviceScene,
    /// How its rays are followed.
    pub traversal: Traversal,
    nodes: NodeWords<'a>,
    primitives: PrimitiveWords<'a>,
    bvh8: Bvh8View<'a>,
    lights: Cow<'a, [LightRecord]>,
    lighting: Cow<'a, Lighting>,
}

impl<'a> SceneView<'a> {
    /// Lays out what the traversal does not take as it is packed.
    pub fn new(packed: &'a DeviceScene, traversal: Traversal) -> Self {
        let (nodes, primitives) =
            (NodeWords::of(packed, traversal.layout), PrimitiveWords::of(packed, traversal.layout));
        let bvh8 = match traversal.method {
            Method::Auto | Method::Wide => packed.bvh8().borrow(),
            _ => Bvh8View::default(),
        };
        SceneView {
            packed,
            traversal,
            nodes,
            primitives,
            bvh8,
            lights: Cow::Borrowed(packed.lights()),
            lighting: Cow::Borrowed(packed.lighting()),
        }
    }

    /// Lights in file order.
    pub fn lights(&self) -> &[LightRecord] {
        &self.lights
    }

    /// What surfaces look like.
    pub fn shading(&self) -> ShadingData<'_> {
        let packed = self.packed;
        ShadingData {
            normals: packed.normals(),
            materials: packed.materials(),
            tangents: &packed.textures().tangents,
            maps: &packed.textures().maps,
            textures: self.textures(),
        }
    }

    fn textures(&self) -> Textures<'_> {
        let textures = self.packed.textures();
        Textures {
            textures: &textures.textures,
            texels: &textures.texels,
            coordinates: &textures.coordinates,
            colours: &textures.colours,
        }
    }

    /// What an integrator chooses from that samples one light of all.
    fn lighting(&self) -> shading::Lighting<'_> {
        shading::Lighting {
            emitters: &self.lighting.emitters,
            nodes: &self.lighting.nodes,
            emissions: &self.lighting.emissions,
            textures: self.textures(),
            environment: self.packed.environment(),
        }
    }

    /// What scatters where integrators sample.
    pub fn scattering(&self) -> ScatterContext<'_> {
        let (physicals, albedos) = (self.packed.physicals(), Albedos(self.packed.albedos()));
        ScatterContext { shading: self.shading(), physicals, albedos, lighting: self.lighting() }
    }

    /// Takes other lights.
    ///
    /// # Errors
    /// As [`DeviceScene::relit`].
    pub fn set_lights(&mut self, lights: &[Light]) -> Result<()> {
        let (records, lighting) = self.packed.relit(lights)?;
        (self.lights, self.lighting) = (Cow::Owned(records), Cow::Owned(lighting));
        Ok(())
    }

    /// What kernels are compiled for that follow the camera's rays.
    pub fn specialisation(&self) -> Specialisation {
        self.packed.specialisation(&self.traversal)
    }

    /// The scene for a launch by a kernel that is compiled for `spec`.
    pub fn context<'g>(&'g self, frame: &'g Frame, spec: Specialisation) -> TraceContext<'g> {
        TraceContext {
            base: LaunchContext { frame, spec, primitives: &self.primitives.0 },
            nodes: &self.nodes.0,
            wide: self.packed.wide(),
            bvh8: self.bvh8,
            bounds: self.packed.bounds(),
            cutout: Cutout { opacities: &self.packed.textures().opacities, textures: self.textures() },
        }
    }

    /// The scene for a launch of a stream's rays, see [`DeviceScene::stream_frame`].
    pub fn stream<'g>(&'g self, frame: &'g Frame) -> TraceContext<'g> {
        self.context(frame, self.specialisation().with_launch(Launch::STREAM))
    }
}

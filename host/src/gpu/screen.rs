//! What a screen shows of films that stay on a GPU.

use eyerays_shader::screen::{Screen as Told, VALUES};
use eyerays_shader::stage::FilmWords;

use super::device::Gpu;
use super::step::{Kernel, Step, empty, uniform};
use crate::error::{Error, Result};
use crate::film::Leasts;
use crate::view::Region;

/// A texture that films of one size are shown in, and the kernel that does.
pub(super) struct Screen {
    kernel: Kernel,
    region: Region,
    /// Pixels of a row: a row that is copied is of whole blocks of 256 bytes.
    stride: u32,
    leasts: Option<Leasts>,
    least: wgpu::Buffer,
    pixels: wgpu::Buffer,
    texture: wgpu::Texture,
    /// The films that were shown last, with what shows each.
    steps: Vec<(wgpu::Buffer, Step)>,
}

/// A film on the device, and the pixels that it is of.
pub(super) type OfRegion<'f> = (Region, &'f wgpu::Buffer);

impl Screen {
    /// For pictures of a region.
    ///
    /// # Errors
    /// A picture too large for a texture of the device, or what it reports.
    pub fn new(gpu: &Gpu, region: Region) -> Result<Screen> {
        let Region { width, height, .. } = region;
        let (most, stride) = (gpu.device.limits().max_texture_dimension_2d, width.next_multiple_of(64));
        if width.max(height) > most {
            let device = &gpu.report.name;
            return Err(Error::new(format!(
                "a picture of {width}x{height} pixels is too large for \"{device}\", whose textures have at most {most} an edge: choose a smaller size"
            )));
        }
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let usage =
            wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            // The bytes are those of a screen already.
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage,
            view_formats: &[],
        });
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let size = 4 * u64::from(stride) * u64::from(height);
        let pixels = wgpu::BufferDescriptor { label: Some("pixels"), size, usage, mapped_at_creation: false };
        let screen = Screen {
            kernel: Kernel::new(gpu, eyerays_modules::SCREEN, "screen::show", &[false, false, true]),
            region,
            stride,
            leasts: None,
            least: empty(gpu, "least", 12 * u64::from(VALUES)),
            pixels: gpu.device.create_buffer(&pixels),
            texture,
            steps: Vec::new(),
        };
        gpu.check()?;
        Ok(screen)
    }

    /// The pixels that it is for.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Has films shown, which together are of its region. Does not wait for the device.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn show(
        &mut self,
        gpu: &Gpu,
        words: FilmWords,
        films: &[OfRegion<'_>],
        leasts: Leasts,
    ) -> Result<wgpu::Texture> {
        if self.leasts.as_ref() != Some(&leasts) {
            gpu.queue.write_buffer(&self.least, 0, bytemuck::cast_slice(&leasts.words()));
            self.leasts = Some(leasts);
        }
        if !self.steps.iter().map(|(film, _)| film).eq(films.iter().map(|(_, film)| *film)) {
            self.steps = films.iter().map(|film| ((*film.1).clone(), self.step(gpu, words, film))).collect();
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        self.steps.iter().for_each(|(_, step)| step.record(&mut pass));
        drop(pass);
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo {
                buffer: &self.pixels,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(4 * self.stride),
                    rows_per_image: None,
                },
            },
            self.texture.as_image_copy(),
            self.texture.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        gpu.check()?;
        Ok(self.texture.clone())
    }

    fn step(&self, gpu: &Gpu, words: FilmWords, (region, film): &OfRegion<'_>) -> Step {
        let told = Told {
            columns: region.width,
            rows: region.height,
            light: words.light,
            aovs: words.aovs,
            first: (region.y - self.region.y) * self.stride + region.x - self.region.x,
            stride: self.stride,
            ..Told::default()
        };
        self.kernel.step(gpu, &uniform(gpu, &told), &[film, &self.least, &self.pixels], region.pixels() as u32)
    }
}

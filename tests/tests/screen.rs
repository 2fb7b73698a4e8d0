//! What a screen shows of a film that does not leave the GPU: the bytes of a picture's file.

use eyerays::film::Part;
use eyerays::gpu::{AdapterRequest, Gpu, wgpu};
use eyerays::image::{self, Encoding, ToneMap};
use eyerays::job::Job;
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish, Display, Session};
use eyerays::scene::Settings;
use eyerays::view::{Region, View};
use eyerays_tests::{adapter, shipped};

/// A device as a window opens one.
fn window() -> Option<(wgpu::Adapter, wgpu::Device, wgpu::Queue)> {
    let adapter = adapter(&eyerays_tests::gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() })?);
    let (device, queue) = pollster::block_on(adapter.request_device(&Gpu::descriptor(&adapter))).unwrap();
    Some((adapter, device, queue))
}

/// The pixels of a texture.
fn read(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Vec<[u8; 4]> {
    let (width, height) = (texture.width(), texture.height());
    let stride = (4 * width).next_multiple_of(256);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(stride * height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
    queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |_| ());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let bytes = buffer.slice(..).get_mapped_range().unwrap().to_vec();
    let rows = bytes.chunks(stride as usize).flat_map(|row| row[..4 * width as usize].as_chunks().0.to_vec());
    rows.collect()
}

/// Samples of all pixels, and then what a screen shows of them.
fn shown(session: &mut Session, view: &View, encoding: &Encoding, samples: std::ops::Range<u32>) -> Display {
    let end = samples.end;
    session.add(Part { region: view.region(), samples }).unwrap();
    session.display(encoding, end).unwrap()
}

#[test]
fn a_texture_has_the_bytes_of_a_png_of_the_same_film() {
    let Some((adapter, device, queue)) = window() else { return };
    let gpu = Gpu::from_wgpu(&adapter, device.clone(), queue.clone()).unwrap();
    let scene = shipped("cornell_path");
    let settings = Settings { bounces: 2, spp: 64, ..scene.settings };
    let job = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let choice = Choice { device: DeviceWish::Gpu, ..Choice::default() };
    let mut session = Backend::on(gpu, &choice).unwrap().open(&job).unwrap();
    for size in [(64, 3), (37, 29), (1, 1)] {
        let view = View::new(&job.with(Settings { size, ..settings }).unwrap(), &scene.cameras[0]).unwrap();
        for exposure_ev in [0.0, -3.7, 5.25] {
            let encoding = Encoding { exposure_ev, ..Encoding::default() };
            session.begin(&view, &[view.region()]).unwrap();
            for samples in [0..1, 1..3, 3..10] {
                let Display::Texture(texture) = shown(&mut session, &view, &encoding, samples.clone()) else {
                    panic!("the picture has left the device");
                };
                let picture = session.film().unwrap().develop().unwrap();
                let wanted = image::screen(&picture, &encoding).unwrap();
                assert_eq!(read(&device, &queue, &texture), wanted, "{size:?} {exposure_ev} {samples:?}");
            }
        }
    }
}

/// In strips, as a window has them of pictures that take long.
#[test]
fn strips_are_shown_together_and_a_strip_without_samples_is_refused() {
    let Some((adapter, device, queue)) = window() else { return };
    let gpu = Gpu::from_wgpu(&adapter, device.clone(), queue.clone()).unwrap();
    let scene = shipped("whitted");
    let settings = Settings { size: (50, 40), samples: 1, spp: 0, ..scene.settings };
    let job = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let choice = Choice { device: DeviceWish::Gpu, ..Choice::default() };
    let mut session = Backend::on(gpu, &choice).unwrap().open(&job).unwrap();
    let view = View::new(&job, &scene.cameras[0]).unwrap();
    let strips: Vec<Region> = view.region().pieces(50, 9).collect();
    session.begin(&view, &strips).unwrap();
    for region in strips {
        let refused = session.display(&Encoding::default(), 1).err().map(|error| error.to_string());
        assert!(refused.is_some_and(|refused| refused.contains("no sample yet")));
        session.add(Part { region, samples: 0..1 }).unwrap();
    }
    let Display::Texture(texture) = session.display(&Encoding::default(), 1).unwrap() else { panic!("no texture") };
    let wanted = image::screen(&session.film().unwrap().develop().unwrap(), &Encoding::default()).unwrap();
    assert_eq!(read(&device, &queue, &texture), wanted);
}

#[test]
fn what_mixes_channels_is_shown_by_the_host() {
    let Some((adapter, device, queue)) = window() else { return };
    let gpu = Gpu::from_wgpu(&adapter, device, queue).unwrap();
    let scene = shipped("whitted");
    let settings = Settings { size: (16, 12), samples: 1, spp: 0, ..scene.settings };
    let job = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let choice = Choice { device: DeviceWish::Gpu, ..Choice::default() };
    let mut session = Backend::on(gpu, &choice).unwrap().open(&job).unwrap();
    let view = View::new(&job, &scene.cameras[0]).unwrap();
    session.begin(&view, &[view.region()]).unwrap();
    let encoding = Encoding { tone: ToneMap::Agx, ..Encoding::default() };
    let Display::Pixels { size, bytes } = shown(&mut session, &view, &encoding, 0..1) else { panic!("a texture") };
    let wanted = image::screen(&session.film().unwrap().develop().unwrap(), &encoding).unwrap();
    assert_eq!((size, bytes), ((16, 12), wanted));
}

#[test]
fn samples() {
    let Ok(folder) = std::env::var("SAMPLES") else { return };
    let mut paths: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.push(std::path::Path::new(&folder).join("FlightHelmet/FlightHelmet.gltf"));
    paths.sort();
    for path in paths {
        if path.is_dir() {
            continue;
        }
        let start = std::time::Instant::now();
        match crate::scene::load(&path) {
            Ok((scene, warnings)) => {
                println!(
                    "{}: {} triangles {} vertices {} materials {} lights cameras {:?} bg {:?} check {:?} {:?}",
                    path.file_name().unwrap().to_string_lossy(),
                    scene.mesh.triangles.len(),
                    scene.mesh.positions.len(),
                    scene.materials.len(),
                    scene.lights.len(),
                    scene.cameras.iter().map(|c| &c.name).collect::<Vec<_>>(),
                    scene.background,
                    scene.check(),
                    start.elapsed()
                );
                for w in warnings {
                    println!("    {w}")
                }
            }
            Err(e) => println!("FAILED {e}"),
        }
    }
}

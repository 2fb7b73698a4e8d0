"""Compares path traced pictures of Eyerays with those of Mitsuba 3 (scalar_rgb), block by block.

    pip install mitsuba numpy
    cargo build --release && python3 tests/peers/beside_mitsuba.py scenes/cornell_path.toml tests/peers/glass_mirror.toml

Both render each scene with several seeds and independent samples. A block's means over the seeds of either differ by chance alone
if z, their difference over its standard error, is normally distributed: its root mean square is about 1, and none of 64 is above 4.
Scenes may have the shapes quad (rectangles), box, sphere and OBJ meshes of one material; materials that are matt, a mirror, glass,
a lamp, a conductor or rough glass; textures of matt quads, looked up between four texels; a constant background or an environment.
Mitsuba has the masking of facets for both directions apart, and not correlated by height: a roughness of at most 0.3 keeps that
below the noise."""

import argparse
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import mitsuba as mi
import numpy as np

BLOCKS = 8
LARGEST = 4.0
# Deeper than any path: no Russian roulette.
NEVER = 65_535


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=Path)
    parser.add_argument("--camera", help="a camera's name [default: the first]")
    parser.add_argument("--size", type=int, default=64, help="pixels along an edge, a multiple of 8")
    parser.add_argument("--spp", type=int, default=256, help="samples of a pixel with each seed")
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--eyerays", default=Path(__file__).parents[2] / "target/release/eyerays")
    return parser.parse_args()


def rgb(colour):
    return {"type": "rgb", "value": colour}


# Facets by the square of the roughness, sampled as the viewer sees them.
GGX = {"distribution": "ggx", "sample_visible": True}


def bitmap(path):
    """Linear RGB, row by row from the top."""
    picture = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    return np.array(picture)


def texture(named, colour, folder):
    """What a matt quad's reflectance is multiplied with. Mitsuba counts rows of a rectangle from its lower edge."""
    named = {"file": named} if isinstance(named, str) else named
    u, v = named.get("scale", [1.0, 1.0])
    to_uv = mi.ScalarTransform3f().translate([0.0, v]).scale([u, -v])
    picture = mi.Bitmap((bitmap(folder / named["file"]) * np.array(colour)).astype(np.float32))
    return {"type": "bitmap", "bitmap": picture, "raw": True, "filter_type": "bilinear", "to_uv": to_uv}


def sky(background, folder):
    """An environment on Mitsuba's grid: its columns begin a quarter of a turn apart, and its rows lie on the poles. Twice as many of them
    have all rows of ours among them, so that what is between two rows is the same."""
    picture = bitmap(folder / background["environment"]) * background.get("intensity", 1.0)
    height, width, _ = picture.shape
    rows = np.clip(np.arange(2 * height + 1) / 2 - 0.5, 0, height - 1)
    above, share = np.floor(rows).astype(int), (rows % 1)[:, None, None]
    below = np.minimum(above + 1, height - 1)
    between = np.roll(picture[above] * (1 - share) + picture[below] * share, -width // 4, axis=1)
    return {"type": "envmap", "bitmap": mi.Bitmap(between.astype(np.float32))}


def surface(material, folder):
    """A material's part that scatters."""
    black = [0.0, 0.0, 0.0]
    alpha = material.get("roughness", 0.0) ** 2
    if "conductor" in material:
        index = {name: rgb(material["conductor"][name]) for name in ("eta", "k")}
        return {"type": "twosided", "of": GGX | index | {"type": "roughconductor", "alpha": alpha}}
    if alpha > 0.0 and any(material.get("transmission", black)):
        glass = {"type": "roughdielectric", "alpha": alpha, "int_ior": material.get("ior", 1.5), "ext_ior": 1.0}
        return GGX | glass | {"specular_transmittance": rgb(material["transmission"])}
    if any(material.get("transmission", black)):
        glass = {"type": "dielectric", "int_ior": material.get("ior", 1.5), "ext_ior": 1.0}
        return glass | {"specular_transmittance": rgb(material["transmission"])}
    if any(material.get("reflection", black)):
        if any(material.get("diffuse", [0.8, 0.8, 0.8])):
            sys.exit(f"{material['name']}: a mirror here is not matt, too; set its diffuse to zeros")
        mirror = {"type": "conductor", "material": "none", "specular_reflectance": rgb(material["reflection"])}
        return {"type": "twosided", "of": mirror}
    colour = material.get("diffuse", [0.8, 0.8, 0.8])
    reflectance = texture(material["base_texture"], colour, folder) if "base_texture" in material else rgb(colour)
    return {"type": "twosided", "of": {"type": "diffuse", "reflectance": reflectance}}


def placed(mesh):
    """Scaled, turned about the fixed axes, moved."""
    scale = mesh.get("scale", 1.0)
    x, y, z = mesh.get("rotate", [0.0, 0.0, 0.0])
    to_world = mi.ScalarTransform4f().translate(mesh.get("translate", [0.0, 0.0, 0.0]))
    to_world = to_world.rotate([0, 0, 1], z).rotate([0, 1, 0], y).rotate([1, 0, 0], x)
    return to_world.scale(scale if isinstance(scale, list) else [scale] * 3)


def rectangle(corners):
    """A matrix that takes Mitsuba's rectangle to these corners, counter-clockwise seen from the front."""
    a, b, c, d = (np.array(corner, dtype=float) for corner in corners)
    if not np.allclose(a + c, b + d) or abs(np.dot(b - a, d - a)) > 1e-9:
        sys.exit(f"{corners} are no rectangle")
    u, v = (b - a) / 2, (d - a) / 2
    normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([u, v, normal, (a + c) / 2])
    return mi.ScalarTransform4f(matrix)


def triangles(path):
    """Positions and triangles of an OBJ file."""
    positions, faces = [], []
    for line in path.read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            positions.append(words[1:4])
        elif words[:1] == ["f"]:
            face = [int(word.split("/")[0]) for word in words[1:]]
            face = [index - 1 if index > 0 else len(positions) + index for index in face]
            faces += [[face[0], face[i], face[i + 1]] for i in range(1, len(face) - 1)]
    return np.array(positions, dtype=np.float32), np.array(faces, dtype=np.uint32)


def obj(path, bsdf):
    positions, faces = triangles(path)
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf)
    mesh = mi.Mesh(path.stem, len(positions), len(faces), props=properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = positions.ravel()
    parameters["faces"] = faces.ravel()
    parameters.update()
    return mesh


def shape(mesh, materials, folder):
    material = materials[mesh["material"]]
    bsdf = surface(material, folder)
    if "file" in mesh:
        if {"scale", "rotate", "translate"} & mesh.keys():
            sys.exit("meshes of files are read as they are here, without scale, rotate and translate")
        return obj(folder / mesh["file"], bsdf)
    found = {"bsdf": bsdf}
    if "emission" in material:
        found["emitter"] = {"type": "area", "radiance": rgb(material["emission"])}
    if mesh["shape"] == "sphere":
        return found | {"type": "sphere", "center": mesh["center"], "radius": mesh["radius"], "to_world": placed(mesh)}
    if mesh["shape"] == "quad":
        return found | {"type": "rectangle", "to_world": placed(mesh) @ rectangle(mesh["corners"])}
    if mesh["shape"] == "box":
        least, greatest = np.array(mesh["min"]), np.array(mesh["max"])
        cube = mi.ScalarTransform4f().translate((least + greatest) / 2).scale((greatest - least) / 2)
        return found | {"type": "cube", "to_world": placed(mesh) @ cube}
    sys.exit(f"the shape {mesh['shape']} is not compared here")


def mitsuba_scene(path, scene, options):
    cameras = scene["camera"]
    camera = next((c for c in cameras if c["name"] == options.camera), cameras[0])
    size, materials = options.size, {material["name"]: material for material in scene["material"]}
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "component_format": "float32"}
    look = mi.ScalarTransform4f().look_at(camera["eye"], camera["target"], camera.get("up", [0, 1, 0]))
    # One segment to the first vertex, one each bounce, and one to a light.
    integrator = {"type": "path", "max_depth": scene["render"]["bounces"] + 2, "rr_depth": NEVER}
    described = {"type": "scene", "integrator": integrator}
    described["sensor"] = {
        "type": "perspective",
        "fov": camera["fov"],
        "fov_axis": "y",
        "to_world": look,
        "film": film | {"pixel_format": "rgb"},
        "sampler": {"type": "independent", "sample_count": options.spp},
    }
    if "environment" in scene.get("background", {}):
        described["sky"] = sky(scene["background"], path.parent)
    elif "background" in scene:
        described["sky"] = {"type": "constant", "radiance": rgb(scene["background"]["color"])}
    for number, mesh in enumerate(scene["mesh"]):
        described[f"shape{number}"] = shape(mesh, materials, path.parent)
    return mi.load_dict(described)


def eyerays_picture(path, camera, options, seed):
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "picture.exr"
        command = [options.eyerays, "render", path, "--integrator", "path", "--sampler", "random", "--device", "cpu"]
        command += ["--filter", "bilinear", "--roulette", NEVER, "--size", f"{options.size}x{options.size}", "--spp", options.spp]
        command += ["--no-compensation", "--camera", camera, "--seed", seed, "--output", output, "--quiet"]
        subprocess.run([str(word) for word in command], check=True)
        return np.array(mi.Bitmap(str(output)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))


def blocks(picture):
    edge = picture.shape[0] // BLOCKS
    return picture.reshape(BLOCKS, edge, BLOCKS, edge, 3).mean(axis=(1, 3, 4)).ravel()


def z_values(ours, theirs):
    """Of block means by seed: the difference of the means over its standard error."""
    error = np.sqrt(ours.var(axis=0, ddof=1) / len(ours) + theirs.var(axis=0, ddof=1) / len(theirs))
    difference = ours.mean(axis=0) - theirs.mean(axis=0)
    # A block without noise, of a lamp or the background alone, differs by rounding.
    return np.where(error > 1e-6 * np.abs(ours.mean(axis=0)), difference / np.maximum(error, 1e-30), 0.0)


def main():
    options = arguments()
    mi.set_variant("scalar_rgb")
    print("| scene | samples of a pixel | mean, Eyerays | mean, Mitsuba | z of means | rms z | largest |z| of 64 blocks |".replace("|z|", "\\|z\\|"))
    print("|---|---|---|---|---|---|---|")
    agree = True
    for path in options.scenes:
        scene = tomllib.loads(path.read_text())
        camera = options.camera or scene["camera"][0]["name"]
        described = mitsuba_scene(path, scene, options)
        seeds = range(1, options.seeds + 1)
        ours = np.array([blocks(eyerays_picture(path, camera, options, seed)) for seed in seeds])
        theirs = np.array([blocks(np.array(mi.render(described, spp=options.spp, seed=seed))) for seed in seeds])
        z = z_values(ours, theirs)
        of_means = z_values(ours.mean(axis=1, keepdims=True), theirs.mean(axis=1, keepdims=True))[0]
        largest = np.abs(z).max()
        agree &= largest < LARGEST
        samples = options.spp * options.seeds
        row = [path.stem, samples, f"{ours.mean():.6f}", f"{theirs.mean():.6f}", f"{of_means:.2f}"]
        print("|", " | ".join(str(cell) for cell in row + [f"{np.sqrt((z * z).mean()):.2f}", f"{largest:.2f}"]), "|", flush=True)
    sys.exit(0 if agree else f"a block is {LARGEST} standard errors apart, or more")


if __name__ == "__main__":
    main()

"""Parts of scenes for Mitsuba, whose variant is chosen by whoever imports this."""

import mitsuba as mi
import numpy as np


def read(path):
    return np.array(mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))


def mesh(name, corners, faces, properties):
    made = mi.Mesh(name, len(corners), len(faces), props=properties)
    parameters = mi.traverse(made)
    parameters["vertex_positions"] = np.array(corners, dtype=np.float32).ravel()
    parameters["faces"] = np.array(faces, dtype=np.uint32).ravel()
    parameters.update()
    return made


def sensor(asked, eye, target, fov):
    """A camera with a square image of box-filtered pixels, as a comparison is asked for; `fov` is vertical, in degrees."""
    return {
        "type": "perspective",
        "fov": fov,
        "fov_axis": "y",
        "to_world": mi.ScalarTransform4f().look_at(list(eye), list(target), [0, 1, 0]),
        "film": {"type": "hdrfilm", "width": asked.size, "height": asked.size, "rfilter": {"type": "box"},
                 "component_format": "float32", "pixel_format": "rgb"},
        "sampler": {"type": "independent", "sample_count": asked.samples},
    }


def pictures(asked, scene):
    """Those of a scene's dictionary, a seed each."""
    scene = mi.load_dict(scene)
    for seed in range(asked.seeds):
        yield np.array(mi.render(scene, seed=seed))

"""Parts of scene files that comparisons with other programs write."""


def head(bounces, sky, camera, keys=""):
    """No lamps but what glows, a render by paths with further keys of `[render]`, a background and a camera: where it stands, what it looks
    at, and its vertical angle in degrees. A list of sections."""
    eye, target, fov = camera
    return [
        f'light = []\n[render]\nintegrator = "path"\nsampler = "sobol"\nbounces = {bounces}\npixel_filter = "box"{keys}',
        f"[background]\ncolor = {list(sky)}",
        f'[[camera]]\nname = "front"\neye = {list(eye)}\ntarget = {list(target)}\nfov = {fov}',
    ]


def quad(corners, material):
    """Four places, of a material by its name."""
    return f'[[mesh]]\nshape = "quad"\ncorners = {[list(corner) for corner in corners]}\nmaterial = "{material}"'

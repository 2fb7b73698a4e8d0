"""Pictures of two programs side by side: the means of their blocks, and how far these are apart."""

import numpy as np

BLOCKS = 8


def blocks(pictures):
    """Means of 64 blocks, in the mean of seeds, and their variances."""
    stack = np.stack([picture.mean(axis=2) for picture in pictures]).astype(np.float64)
    seeds, size, _ = stack.shape
    means = stack.reshape(seeds, BLOCKS, size // BLOCKS, BLOCKS, size // BLOCKS).mean(axis=(2, 4)).reshape(seeds, -1)
    return means.mean(axis=0), means.var(axis=0, ddof=1) / seeds


def compared(own, other):
    """The greatest z, the root of the mean of its square (1 where all is chance), and the difference of the whole image as a share."""
    error = np.sqrt(own[1] + other[1])
    lit = error > 0
    z = (own[0] - other[0])[lit] / error[lit]
    return np.abs(z).max(), np.sqrt((z * z).mean()), own[0].mean() / other[0].mean() - 1

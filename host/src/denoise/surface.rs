//! What a pixel shows, and how unlike others it is.

/// Albedos that differ by this much, as a length, are as unlike as light that differs by a standard error.
const ALBEDO: f32 = 0.05;
/// Normals, likewise.
const NORMAL: f32 = 0.1;
/// Depths, likewise, as a share for each pixel between them.
const DEPTH: f32 = 0.04;
/// Squares of differences from which on neighbours do not count.
const UNLIKE: f32 = 4.0;

/// What is seen first through a pixel.
#[derive(Clone, Copy)]
pub(super) struct Surface {
    pub albedo: [f32; 3],
    pub normal: [f32; 3],
    /// Infinite for nothing.
    pub depth: f32,
}

impl Surface {
    /// The square of the greatest difference from that of a pixel so far away.
    pub fn unlike(&self, other: &Surface, dx: isize, dy: isize) -> f32 {
        let by_albedo = square(self.albedo, other.albedo) / (ALBEDO * ALBEDO);
        let by_normal = square(self.normal, other.normal) / (NORMAL * NORMAL);
        let by_depth = match (self.depth.is_finite(), other.depth.is_finite()) {
            (true, true) => {
                let between = ((dx * dx + dy * dy) as f32).sqrt();
                let allowed = DEPTH * self.depth.max(other.depth) * between + f32::MIN_POSITIVE;
                let apart = (self.depth - other.depth) / allowed;
                apart * apart
            }
            (false, false) => 0.0,
            _ => f32::INFINITY,
        };
        by_albedo.max(by_normal).max(by_depth)
    }
}

fn square(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum()
}

/// 1 for what is alike, and nothing from [`UNLIKE`] on.
pub(super) fn weight(unlike: f32) -> f32 {
    let left = (1.0 - unlike / UNLIKE).max(0.0);
    (left * left) * (left * left)
}

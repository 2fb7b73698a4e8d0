//! Where a scene's surfaces are.

use glam::Vec3;

use super::Scene;

impl Scene {
    /// Points that no surface reaches beyond on any axis while the shutter is open: the vertices of what stands where it is, the
    /// corners of boxes around all copies, and the corners of the bounding boxes of spheres and disks, rounded outward.
    pub fn extremes(&self) -> impl Iterator<Item = Vec3> + '_ {
        let spheres = self.spheres.iter().flat_map(|sphere| sphere.bounds());
        let disks = self.disks.iter().flat_map(|disk| disk.bounds());
        let own = self.mesh.positions[..self.own_vertices()].iter().copied();
        let moved = self.motion.iter().flat_map(|_| self.motion_bounds());
        own.chain(self.copies_bounds().into_iter().flatten()).chain(moved).chain(spheres).chain(disks)
    }

    /// The least and the greatest corner of all surfaces, in world units; zeros where there are none.
    pub fn bounds(&self) -> [Vec3; 2] {
        of(self.extremes())
    }
}

/// The least and the greatest corner of points; zeros where there are none.
pub(crate) fn of(points: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    let widen = |[least, greatest]: [Vec3; 2], [low, high]: [Vec3; 2]| [least.min(low), greatest.max(high)];
    points.map(|point| [point; 2]).reduce(widen).unwrap_or_default()
}

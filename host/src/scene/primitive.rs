//! Surfaces that rays meet as they are, without triangles, and how a part names its own.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// A sphere; its front is its outside.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Sphere {
    /// Finite, in world units.
    pub center: Vec3,
    /// Finite and above 0, in world units; all of the sphere lies in single precision.
    pub radius: f32,
    /// An index into [`super::Scene::materials`].
    pub material: u32,
}

/// A flat disk without thickness.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Disk {
    /// Finite, in world units.
    pub center: Vec3,
    /// Of unit length; the front is the side that it points to.
    pub normal: Vec3,
    /// Finite and above 0, in world units; all of the disk lies in single precision.
    pub radius: f32,
    /// An index into [`super::Scene::materials`].
    pub material: u32,
}

/// What a part is made of, and where that stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Primitives {
    /// In [`super::Mesh::triangles`].
    Triangles(Range<usize>),
    /// In [`super::Scene::spheres`].
    Spheres(Range<usize>),
    /// In [`super::Scene::disks`].
    Disks(Range<usize>),
    /// In [`super::Scene::instances`].
    Instances(Range<usize>),
}

impl Primitives {
    /// How many there are.
    pub fn count(&self) -> usize {
        let (Primitives::Triangles(range)
        | Primitives::Spheres(range)
        | Primitives::Disks(range)
        | Primitives::Instances(range)) = self;
        range.len()
    }

    /// Those of a scene's instances that it is made of.
    pub fn instances<'s>(&self, all: &'s [super::Instance]) -> &'s [super::Instance] {
        match self {
            Primitives::Instances(range) => &all[range.clone()],
            _ => &[],
        }
    }

    /// What one of them is called: `triangle`, `sphere`, `disk` or `instance`.
    pub fn noun(&self) -> &'static str {
        match self {
            Primitives::Triangles(_) => "triangle",
            Primitives::Spheres(_) => "sphere",
            Primitives::Disks(_) => "disk",
            Primitives::Instances(_) => "instance",
        }
    }
}

impl Sphere {
    /// The least and the greatest corner of its bounding box, rounded outward: no point of the sphere lies outside.
    pub fn bounds(&self) -> [Vec3; 2] {
        around(self.center, DVec3::splat(f64::from(self.radius)))
    }

    /// What single precision can't hold of it, and the remedy; it follows the sphere's name.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        fault(self.center, self.radius, self.bounds())
    }
}

impl Disk {
    /// The least and the greatest corner of its bounding box, rounded outward.
    pub fn bounds(&self) -> [Vec3; 2] {
        let normal = self.normal.as_dvec3();
        let square = normal * normal;
        // The sine of the angle between the normal and each axis.
        let across = DVec3::new(square.y + square.z, square.z + square.x, square.x + square.y);
        let sines = (across / square.element_sum()).map(f64::sqrt);
        around(self.center, sines * f64::from(self.radius))
    }

    /// As [`Sphere::fault`].
    pub(crate) fn fault(&self) -> Option<&'static str> {
        fault(self.center, self.radius, self.bounds())
    }
}

/// What is wrong with a round surface's numbers, and the remedy; it follows the surface's name.
fn fault(center: Vec3, radius: f32, bounds: [Vec3; 2]) -> Option<&'static str> {
    let far = center.abs().max_element();
    if !bounds.iter().all(|corner| corner.is_finite()) {
        Some("leaves the range of single precision; make it smaller or move it nearer to the origin")
    } else if far + radius == far {
        Some("is too small for single precision where it stands; make it larger or move it nearer to the origin")
    } else {
        None
    }
}

fn around(center: Vec3, reach: DVec3) -> [Vec3; 2] {
    let corner = |reach: DVec3| {
        let axis = |i: usize| outward(f64::from(center[i]), reach[i]);
        Vec3::new(axis(0), axis(1), axis(2))
    };
    [corner(-reach), corner(reach)]
}

/// The sum in single precision, rounded the way that `reach` points.
fn outward(center: f64, reach: f64) -> f32 {
    let sum = center + reach;
    let own = sum - center;
    // Knuth: what the sum has lost, exactly.
    let lost = (center - (sum - own)) + (reach - own);
    let near = sum as f32;
    let beyond = (f64::from(near) - sum) - lost;
    match reach < 0.0 {
        true if beyond > 0.0 => near.next_down(),
        false if beyond < 0.0 => near.next_up(),
        _ => near,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn bounds_are_as_narrow_as_single_precision_allows() {
        let sphere = |center: f32, radius| Sphere { center: Vec3::splat(center), radius, material: 0 }.bounds();
        assert_eq!(sphere(0.5, 0.25), [Vec3::splat(0.25), Vec3::splat(0.75)]);
        // Less than half of the distance to the next number, and less than double precision holds.
        for radius in [1e-9, 1e-30] {
            assert_eq!(sphere(1.0, radius), [Vec3::splat(1f32.next_down()), Vec3::splat(1f32.next_up())]);
        }
        assert_eq!(sphere(1e-30, 1.0), [Vec3::splat(-1.0), Vec3::splat(1f32.next_up())]);
    }

    #[test]
    fn a_disk_takes_no_room_along_its_normal() {
        let disk = |normal| Disk { center: Vec3::ONE, normal, radius: 2.0, material: 0 }.bounds();
        assert_eq!(disk(Vec3::Y), [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(3.0, 1.0, 3.0)]);
        let [least, greatest] = disk(Vec3::new(0.6, 0.8, 0.0));
        assert!((least - Vec3::new(-0.6, -0.2, -1.0)).length() < 1e-6, "{least}");
        assert!((greatest - Vec3::new(2.6, 2.2, 3.0)).length() < 1e-6, "{greatest}");
    }

    #[test]
    fn a_radius_is_lost_beside_a_far_center_and_where_nothing_is_left_of_it() {
        let fault = |y, radius| Sphere { center: Vec3::new(0.0, y, 3.0), radius, material: 0 }.fault();
        assert!(fault(-1e8, 1.0).unwrap().contains("too small") && fault(0.0, 0.0).unwrap().contains("too small"));
        assert!(fault(3e38, 1e38).unwrap().contains("leaves the range"));
        assert_eq!((fault(-1e8, 8.0), fault(0.0, 1e-6)), (None, None));
    }

    proptest! {
        /// Of the same exponent, the sums are exact in double precision.
        #[test]
        fn no_sphere_leaves_its_bounds(center in -1e3f32..1e3, radius in 1e-4f32..1e3) {
            let [least, greatest] = Sphere { center: Vec3::splat(center), radius, material: 0 }.bounds();
            let (center, radius) = (f64::from(center), f64::from(radius));
            prop_assert!(f64::from(least.x) <= center - radius && f64::from(least.x.next_up()) > center - radius);
            prop_assert!(f64::from(greatest.x) >= center + radius && f64::from(greatest.x.next_down()) < center + radius);
        }
    }
}

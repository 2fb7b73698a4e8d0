//! Rays taken apart: the lanes of a packet, each by itself.

use crate::ray::{Hit, Ray};
#[cfg(target_arch = "x86_64")]
use crate::real::{Eight, Four};
#[cfg(not(target_arch = "spirv"))]
use crate::real::{F32xN, Lanes, V3};
use crate::real::{Fast, Real, Scalar};

/// Rays that methods may take apart, to follow some by themselves.
pub trait RayLanes: Real {
    /// One lane.
    type Lane: Scalar;

    /// Calls `f` for each lane of the mask, one after the other.
    fn each_lane(
        ray: &Ray<Self>,
        hit: &mut Hit<Self>,
        mask: Self::Mask,
        f: impl FnMut(&Ray<Self::Lane>, &mut Hit<Self::Lane>),
    );
}

/// Implements [`RayLanes`](crate::traverse::lanes::RayLanes) for numbers of one lane.
#[macro_export]
macro_rules! lone_rays {
    ($($scalar:ty),*) => {$(
        impl $crate::traverse::lanes::RayLanes for $scalar {
            type Lane = Self;

            #[inline(always)]
            fn each_lane(
                ray: &$crate::ray::Ray<Self>,
                hit: &mut $crate::ray::Hit<Self>,
                mask: bool,
                mut f: impl FnMut(&$crate::ray::Ray<Self>, &mut $crate::ray::Hit<Self>),
            ) {
                if mask {
                    f(ray, hit);
                }
            }
        }
    )*};
}
lone_rays!(f32, Fast);
#[cfg(not(target_arch = "spirv"))]
lone_rays!(f64);

/// Implements [`RayLanes`] for the vectors of a CPU.
#[cfg(not(target_arch = "spirv"))]
macro_rules! vectors {
    ($(for [$($parameters:tt)*] $vector:ty);*) => {$(
        impl<$($parameters)*> RayLanes for $vector {
            type Lane = f32;

            #[inline(always)]
            fn each_lane(
                ray: &Ray<Self>,
                hit: &mut Hit<Self>,
                mask: Self::Mask,
                mut f: impl FnMut(&Ray<f32>, &mut Hit<f32>),
            ) {
                let mut open = <Self as Lanes<f32>>::bits(mask);
                while open != 0 {
                    let i = open.trailing_zeros() as usize;
                    open &= open - 1;
                    let mut lane = hit.lane(i);
                    f(&ray.lane(i), &mut lane);
                    hit.set_lane(i, &lane);
                }
            }
        }
    )*};
}
#[cfg(not(target_arch = "spirv"))]
vectors!(for [const N: usize] F32xN<N>);
#[cfg(target_arch = "x86_64")]
vectors!(for [] Eight; for [] Four);

#[cfg(not(target_arch = "spirv"))]
impl<R: Real> Ray<R> {
    /// One lane's ray.
    #[inline(always)]
    fn lane<S: Scalar>(&self, i: usize) -> Ray<S>
    where
        R: Lanes<S>,
    {
        let vector = |v: &V3<R>| V3::new(v.x.lane(i), v.y.lane(i), v.z.lane(i));
        Ray {
            origin: vector(&self.origin),
            direction: vector(&self.direction),
            inverse: vector(&self.inverse),
            offset: vector(&self.offset),
            shear: self.shear.lane(i),
            source_primitive: S::index(R::index_of(self.source_primitive, i)),
            time: self.time,
            behind: self.behind.lane(i),
        }
    }
}

#[cfg(not(target_arch = "spirv"))]
impl<R: Real> Hit<R> {
    /// One lane's hit.
    #[inline(always)]
    pub fn lane<S: Scalar>(&self, i: usize) -> Hit<S>
    where
        R: Lanes<S>,
    {
        Hit {
            t: self.t.lane(i),
            u: self.u.lane(i),
            v: self.v.lane(i),
            scale: self.scale.lane(i),
            primitive_index: R::index_of(self.primitive_index, i),
            primitive: R::index_of(self.primitive, i),
            instance: R::index_of(self.instance, i),
        }
    }

    #[inline(always)]
    fn set_lane<S: Scalar>(&mut self, i: usize, hit: &Hit<S>)
    where
        R: Lanes<S>,
    {
        self.t.set_lane(i, hit.t);
        self.u.set_lane(i, hit.u);
        self.v.set_lane(i, hit.v);
        self.scale.set_lane(i, hit.scale);
        R::set_index(&mut self.primitive_index, i, hit.primitive_index);
        R::set_index(&mut self.primitive, i, hit.primitive);
        R::set_index(&mut self.instance, i, hit.instance);
    }
}

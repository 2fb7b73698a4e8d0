//! A picture over any numbers, on one thread.

use eyerays::cpu::{Isa, Planned};
use eyerays::device_scene::SceneView;
use eyerays::method::Method;
use eyerays_shader::real::{Scalar, V3};

use crate::Posed;

/// The film of one sample a pixel by the simplest method, row-major from the top left.
pub fn picture<R: Scalar>(posed: &Posed) -> Vec<V3<R>> {
    let planned = Planned::new(SceneView::new(&posed.packed, Method::IfIf.into()), Isa::Baseline);
    let mut film = planned.film::<R>(posed.view.region());
    planned.add::<R>(&posed.view, posed.view.region(), 0..1, &mut film, &());
    film.into_iter().map(|record| R::load(record).0).collect()
}

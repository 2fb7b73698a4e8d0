//! Haines' sphere flake, of any number of spheres.

use std::collections::VecDeque;

use glam::DVec3;

/// How much smaller a child is.
const SHRINK: f64 = 1.0 / 3.0;
/// How many children a sphere has.
const CHILDREN: u64 = 9;

/// A sphere of the flake, and the frame that its children stand in.
#[derive(Clone, Copy)]
pub struct Ball {
    /// In world units.
    pub center: DVec3,
    /// In world units.
    pub radius: f64,
    /// Away from the sphere that it sits on, and two directions across.
    axes: [DVec3; 3],
}

impl Ball {
    /// The one that all others sit on, around a place.
    fn root(center: DVec3, radius: f64) -> Self {
        Ball { center, radius, axes: [DVec3::Y, DVec3::Z, DVec3::X] }
    }

    /// Those that sit on it: six around its equator and three above, each as far from its neighbours.
    fn children(&self) -> [Ball; CHILDREN as usize] {
        let [out, right, up] = self.axes;
        let (half, high) = (0.5, 0.75f64.sqrt());
        // The corners of a hexagon, and of a triangle between every other two of them: a cuboctahedron without its base.
        let hexagon = [(1.0, 0.0), (half, high), (-half, high), (-1.0, 0.0), (-half, -high), (half, -high)];
        let triangle = [(high, half), (-high, half), (0.0, -1.0)];
        let (near, far) = ((1f64 / 3.0).sqrt(), (2f64 / 3.0).sqrt());
        let flat = hexagon.map(|(x, y)| right * x + up * y);
        let raised = triangle.map(|(x, y)| (right * x + up * y) * near + out * far);
        std::array::from_fn(|child| self.child(*flat.iter().chain(&raised).nth(child).expect("nine directions")))
    }

    /// The one in a direction of unit length. Its axes are this one's, turned the shortest way.
    fn child(&self, direction: DVec3) -> Ball {
        let out = self.axes[0];
        let middle = out + direction;
        let turned = |axis: DVec3| axis - middle * (axis.dot(direction) / (1.0 + out.dot(direction)));
        let radius = self.radius * SHRINK;
        Ball {
            center: self.center + direction * (self.radius + radius),
            radius,
            axes: [direction, turned(self.axes[1]), turned(self.axes[2])],
        }
    }
}

/// The first `count` spheres, larger ones before smaller ones.
pub fn balls(center: DVec3, radius: f64, count: u64) -> impl Iterator<Item = Ball> {
    let root = Ball::root(center, radius);
    let (mut parents, mut children, mut pushed) = (VecDeque::from([root]), Vec::new(), 1);
    let others = std::iter::from_fn(move || {
        if children.is_empty() {
            children.extend(parents.pop_front()?.children());
            children.reverse();
        }
        let next = children.pop()?;
        // No more are kept than have children themselves.
        if pushed * CHILDREN + 1 < count {
            parents.push_back(next);
            pushed += 1;
        }
        Some(next)
    });
    std::iter::once(root).chain(others).take(count.try_into().unwrap_or(usize::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flake(count: u64) -> Vec<Ball> {
        balls(DVec3::ZERO, 1.0, count).collect()
    }

    #[test]
    fn there_are_exactly_as_many_spheres_as_asked_for_and_more_are_the_same_and_others() {
        let all = flake(1 + 9 + 81 + 729 + 5);
        for count in [1, 2, 9, 10, 11, 91, 100, 820, 825] {
            let some = flake(count);
            assert_eq!(some.len() as u64, count);
            assert!(some.iter().zip(&all).all(|(a, b)| a.center == b.center && a.radius == b.radius), "{count}");
        }
        let count = |radius: f64| all.iter().filter(|ball| (ball.radius - radius).abs() < 1e-9).count();
        assert_eq!([1.0, 1.0 / 3.0, 1.0 / 9.0, 1.0 / 27.0, 1.0 / 81.0].map(count), [1, 9, 81, 729, 5]);
    }

    #[test]
    fn each_sphere_touches_the_one_that_it_sits_on_and_none_is_inside_another() {
        let all = flake(1 + 9 + 81 + 729);
        for (number, ball) in all.iter().enumerate().skip(1) {
            let parent = &all[(number - 1) / 9];
            let apart = parent.center.distance(ball.center) - parent.radius - ball.radius;
            assert!(apart.abs() < 1e-9, "{number}: {apart}");
        }
        for (number, a) in all[..91].iter().enumerate() {
            for b in &all[..number] {
                assert!(a.center.distance(b.center) > (a.radius - b.radius).abs() + 1e-9, "{number}");
            }
        }
    }

    #[test]
    fn all_of_it_is_within_two_radii() {
        for ball in flake(10_000) {
            assert!(ball.center.length() + ball.radius < 2.0);
            assert!(ball.center.y - ball.radius >= -1.0, "{}", ball.center);
        }
    }
}

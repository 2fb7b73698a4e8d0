//! What a ray is in.

use crate::buffer::read;
use crate::data::Medium;

/// How often a ray goes on through surfaces that are not there before it ends: rounding may hold it between two that touch.
pub const MOST_CROSSINGS: u32 = 255;

/// The media whose surfaces a ray has entered and not left, at most three, and how often it has crossed surfaces that are not there:
/// in a word, since paths keep it in memory. The lowest byte is the medium that was entered last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Inside(pub u32);

const BYTE: u32 = 0xff;
const MEDIA: u32 = (1 << Inside::BITS) - 1;

impl Inside {
    /// The bits of media; crossings are above.
    pub const BITS: u32 = 24;

    /// Across a surface that a medium fills (by its number, or 0 for none), seen from its front or from its back. Of more than three media
    /// the first that was entered is forgotten.
    #[inline(always)]
    pub fn across(self, front: bool, medium: u32) -> Self {
        let (media, crossings) = (self.0 & MEDIA, self.0 & !MEDIA);
        let left = if media & BYTE == medium {
            media >> 8
        } else if (media >> 8) & BYTE == medium {
            (media & BYTE) | ((media >> 16) << 8)
        } else if media >> 16 == medium {
            media & 0xffff
        } else {
            media
        };
        let entered = ((media << 8) | medium) & MEDIA;
        let next = if medium == 0 {
            media
        } else if front {
            entered
        } else {
            left
        };
        Inside(next | crossings)
    }

    /// Once more through a surface that is not there.
    #[inline(always)]
    pub fn crossed(self) -> Self {
        Inside(self.0 + (1 << Self::BITS))
    }

    /// How often it was.
    #[inline(always)]
    pub fn crossings(self) -> u32 {
        self.0 >> Self::BITS
    }

    /// As a ray begins that was scattered.
    #[inline(always)]
    pub fn scattered(self) -> Self {
        Inside(self.0 & MEDIA)
    }

    /// Outside of all surfaces.
    #[inline(always)]
    pub fn outside(self) -> Self {
        Inside(self.0 & !MEDIA)
    }

    /// The medium that is there, by its number: of those that were entered the one of the highest priority, of several the last; outside
    /// of all, `fog`; 0 for none.
    #[inline(always)]
    pub fn medium(self, media: &[Medium], fog: u32) -> u32 {
        let (last, before, first) = (self.0 & BYTE, (self.0 >> 8) & BYTE, (self.0 >> 16) & BYTE);
        if last == 0 {
            return fog;
        }
        // Most rays are in one at most.
        if before == 0 {
            return last;
        }
        let (mut found, mut highest) = (last, priority(media, last));
        let other = priority(media, before);
        if highest < other {
            (found, highest) = (before, other);
        }
        if first != 0 && highest < priority(media, first) { first } else { found }
    }
}

#[inline(always)]
fn priority(media: &[Medium], number: u32) -> u32 {
    read(media, number - 1).extinction.w
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use glam::UVec4;
    use proptest::prelude::*;

    /// Media with these priorities, from number 1 on.
    fn media(priorities: &[u32]) -> Vec<Medium> {
        priorities.iter().map(|&p| Medium { extinction: UVec4::new(0, 0, 0, p), ..Zeroable::zeroed() }).collect()
    }

    #[test]
    fn outside_of_all_surfaces_there_is_fog() {
        let media = media(&[0, 0]);
        assert_eq!(Inside::default().medium(&media, 2), 2);
        let within = Inside::default().across(true, 1);
        assert_eq!(within.medium(&media, 2), 1);
        assert_eq!(within.across(false, 1).medium(&media, 2), 2);
        assert_eq!(within.across(true, 0), within, "nothing fills an opaque surface");
    }

    #[test]
    fn the_highest_priority_is_there_and_of_several_the_last() {
        let media = media(&[1, 1, 5]);
        let both = Inside::default().across(true, 1).across(true, 2);
        assert_eq!(both.medium(&media, 0), 2);
        let ice = Inside::default().across(true, 3).across(true, 1);
        assert_eq!(ice.medium(&media, 0), 3);
        assert_eq!(ice.across(true, 2).medium(&media, 0), 3, "the first of three");
        assert_eq!(ice.across(false, 3).medium(&media, 0), 1);
    }

    #[test]
    fn crossings_are_counted_beside_the_media() {
        let mut inside = Inside::default().across(true, 7);
        for count in 0..MOST_CROSSINGS {
            assert_eq!(inside.crossings(), count);
            inside = inside.crossed();
        }
        assert_eq!(inside.scattered(), Inside::default().across(true, 7));
        assert_eq!((inside.outside().scattered(), inside.outside().crossings()), (Inside::default(), MOST_CROSSINGS));
    }

    proptest! {
        /// Against a list, for walks that are never in more than three.
        #[test]
        fn it_is_the_multiset_of_what_was_entered_and_not_left(steps in proptest::collection::vec((1u32..6, any::<bool>()), 0..60)) {
            let media = media(&[3, 1, 4, 1, 5]);
            let (mut inside, mut list) = (Inside::default(), Vec::new());
            for (medium, enters) in steps {
                if enters && list.len() < 3 {
                    list.push(medium);
                    inside = inside.across(true, medium);
                } else if !enters && let Some(place) = list.iter().rposition(|&m| m == medium) {
                    list.remove(place);
                    inside = inside.across(false, medium);
                }
                let priority = |m: u32| media[m as usize - 1].extinction.w;
                let there = list.iter().copied().max_by_key(|&m| priority(m)).unwrap_or(0);
                prop_assert_eq!(inside.medium(&media, 0), there);
            }
        }
    }
}

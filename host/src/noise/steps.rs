//! After how many samples a cell decides: often at first, where a sample more is much, and each time after a quarter more.

use eyerays_shader::stage::BLOCK;

/// Samples before the first decision: four blocks, whose means tell how much they differ.
pub(super) const LEAST: u32 = 64;

/// How many of these samples are whole blocks.
pub(crate) fn whole_blocks(samples: u32) -> u32 {
    samples / BLOCK * BLOCK
}

/// The numbers of samples after which a cell decides.
fn decisions() -> impl Iterator<Item = u32> {
    std::iter::successors(Some(LEAST), |&samples| samples.checked_add(whole_blocks(samples / 4).max(BLOCK)))
}

/// Does a cell of so many samples decide whether it has enough?
pub(crate) fn decides_at(samples: u32) -> bool {
    decisions().take_while(|&decision| decision <= samples).last() == Some(samples)
}

/// How many samples a cell of so many has when it decides next; no more than `most`, which are whole blocks.
pub(crate) fn next(samples: u32, most: u32) -> u32 {
    decisions().find(|&decision| decision > samples).unwrap_or(u32::MAX).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_decides_after_four_blocks_and_then_after_a_quarter_more() {
        let first: Vec<u32> = decisions().take(12).collect();
        assert_eq!(first, [64, 80, 96, 112, 128, 160, 192, 240, 288, 352, 432, 528]);
        assert!(decisions().take_while(|&samples| samples < 1 << 24).all(|samples| samples % BLOCK == 0));
    }

    /// So that who goes on with a film that had fewer samples at most decides where others do.
    #[test]
    fn the_most_samples_change_no_decision_but_the_last() {
        assert_eq!((next(0, 1024), next(64, 1024), next(64, 64), next(80, 90)), (64, 80, 64, 90));
        assert_eq!((next(176, 1024), decides_at(176), decides_at(192), decides_at(0)), (192, false, true, false));
        assert_eq!(next(1 << 24, 1 << 24), 1 << 24);
    }
}

//! Tables by which one of several is drawn in no more time than of two.

use glam::UVec4;

/// The alias table of some powers (Vose, A Linear Algorithm for Generating Random Numbers with a Given Distribution, 1991): for
/// each its threshold, its alias and the bits of its probability. All are as likely if all are black.
pub(super) fn table(powers: &[f64]) -> Vec<UVec4> {
    let total: f64 = powers.iter().sum();
    let share = |power: f64| if total > 0.0 { power / total } else { 1.0 / powers.len() as f64 };
    let mut left: Vec<f64> = powers.iter().map(|&power| share(power) * powers.len() as f64).collect();
    let (mut less, mut more): (Vec<usize>, Vec<usize>) = (0..powers.len()).partition(|&i| left[i] < 1.0);
    let mut table: Vec<UVec4> =
        powers.iter().zip(0..).map(|(&power, i)| UVec4::new(u32::MAX, i, (share(power) as f32).to_bits(), 0)).collect();
    while let (Some(&small), Some(&large)) = (less.last(), more.last()) {
        less.pop();
        table[small].x = (left[small] * 4_294_967_296.0) as u32;
        table[small].y = large as u32;
        left[large] -= 1.0 - left[small];
        if left[large] < 1.0 {
            more.pop();
            less.push(large);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often a table chooses each, by its thresholds.
    fn shares(table: &[UVec4]) -> Vec<f64> {
        let mut shares = vec![0.0; table.len()];
        for (i, entry) in table.iter().enumerate() {
            let own = f64::from(entry.x) / f64::from(u32::MAX);
            shares[i] += own / table.len() as f64;
            shares[entry.y as usize] += (1.0 - own) / table.len() as f64;
        }
        shares
    }

    #[test]
    fn each_light_is_chosen_as_often_as_its_power_says() {
        let many: Vec<f64> = (0..1000).map(|i| f64::from((i * 7919) % 1000)).collect();
        for powers in [&[1.0][..], &[1.0, 1.0], &[3.0, 0.0, 1.0], &[1e-9, 1.0, 1e9], &many] {
            let (table, total) = (table(powers), powers.iter().sum::<f64>());
            for ((share, power), entry) in shares(&table).into_iter().zip(powers).zip(&table) {
                assert!((share - power / total).abs() < 1e-8, "{powers:?}: {share}");
                assert_eq!(f32::from_bits(entry.z), (power / total) as f32);
            }
        }
        assert!(table(&[]).is_empty());
        assert_eq!(shares(&table(&[0.0, 0.0])), [0.5, 0.5]);
    }
}

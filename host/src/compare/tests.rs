use proptest::prelude::*;

use super::*;

fn picture(pixels: &[[f32; 3]]) -> Picture {
    Picture::from_pixels(pixels.len() as u32, 1, pixels.to_vec()).unwrap()
}

#[test]
fn equal_pictures_are_infinitely_alike() {
    let a = picture(&[[0.5, f32::NAN, f32::INFINITY], [1.0; 3]]);
    let found = compare(&a, &a).unwrap();
    assert!(found.bit_equal && !found.exceeds(0.0));
    assert_eq!((found.differing_pixels, found.largest_ulps), (0, 0));
    assert_eq!((found.largest_difference, found.rmse), (0.0, 0.0));
    assert_eq!(found.psnr, f64::INFINITY);
    assert_eq!(found.non_finite, [2, 2]);
    let json = serde_json::to_value(&found).unwrap();
    assert!(json["psnr"].is_null());
    assert_eq!(json["bit_equal"], true);
}

#[test]
fn known_differences() {
    let a = picture(&[[0.0; 3], [1.0; 3]]);
    let b = picture(&[[0.0; 3], [1.0, 0.5, 1.0f32.next_up()]]);
    let found = compare(&a, &b).unwrap();
    assert_eq!((found.differing_pixels, found.largest_ulps), (1, 1 << 23));
    assert_eq!(found.largest_difference, 0.5);
    assert!((found.rmse - (0.25_f64 / 6.0).sqrt()).abs() < 1e-9);
    assert!((found.psnr - 13.802).abs() < 1e-3);
    assert!(!found.exceeds(0.5) && found.exceeds(0.499));
    let lines = found.to_string();
    assert!(lines.contains("differing pixels    1 of 2\n"), "{lines}");
}

#[test]
fn the_sign_of_a_zero_is_a_bit() {
    let found = compare(&picture(&[[0.0; 3]]), &picture(&[[-0.0; 3]])).unwrap();
    assert!(!found.bit_equal && found.exceeds(0.0) && !found.exceeds(1e-9));
    assert_eq!((found.largest_ulps, found.rmse), (0, 0.0));
}

#[test]
fn a_nan_is_beyond_any_tolerance() {
    for odd in [f32::NAN, f32::INFINITY] {
        let found = compare(&picture(&[[odd; 3]]), &picture(&[[1.0; 3]])).unwrap();
        assert!(found.exceeds(f32::MAX));
        assert_eq!(found.psnr, f64::NEG_INFINITY);
        assert_eq!(found.non_finite, [3, 0]);
    }
}

#[test]
fn unequal_sizes_are_both_named() {
    let error = compare(&Picture::new(2, 3).unwrap(), &Picture::new(3, 2).unwrap()).unwrap_err();
    assert!(error.message().contains("2x3") && error.message().contains("3x2"), "{error}");
    assert!(heat_map(&Picture::new(2, 3).unwrap(), &Picture::new(3, 2).unwrap()).is_err());
}

#[test]
fn heat_grows_lighter_by_the_decade() {
    let zero = picture(&[[0.0; 3]; 13]);
    let mut steps = [[0.0; 3]; 13];
    for (i, step) in steps.iter_mut().enumerate().skip(1) {
        *step = [0.0, 10_f32.powi(i as i32 - 10), 0.0];
    }
    let heat = heat_map(&zero, &picture(&steps)).unwrap().pixels;
    let lightness = heat.iter().map(|[r, g, b]| 0.2126 * r + 0.7152 * g + 0.0722 * b);
    let lightness: Vec<f32> = lightness.collect();
    assert_eq!(lightness[0], 0.0);
    // 1e-9 and 1e-8 share the first colour, 1 and more the last.
    assert!(lightness[2..=10].is_sorted_by(|a, b| a < b), "{lightness:?}");
    assert_eq!((heat[1], heat[11]), (heat[2], heat[10]));
    assert!(lightness[1] > 0.01);
}

#[test]
fn distances_of_ulps_are_known() {
    assert_eq!(ulp_distance(1.0, 1.0f32.next_up()), 1);
    assert_eq!(ulp_distance(0.0, -0.0), 0);
    assert_eq!(ulp_distance(f32::from_bits(1), -f32::from_bits(1)), 2);
    assert_eq!(ulp_distance(f32::INFINITY, f32::NEG_INFINITY), 0xff00_0000);
    assert_eq!(ulp_distance(f32::MAX, f32::INFINITY), 1);
    assert_eq!(ulp_distance(f32::NAN, 1.0), u32::MAX);
    assert_eq!(ulp_distance(f32::NAN, f32::NAN), 0);
}

fn any_float() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn ulps_are_a_distance(a in any_float(), b in any_float(), c in any_float()) {
        prop_assert_eq!(ulp_distance(a, b), ulp_distance(b, a));
        prop_assert_eq!(ulp_distance(a, a), 0);
        if a.is_finite() {
            prop_assert_eq!(ulp_distance(a, a.next_up()), 1);
            prop_assert_eq!(ulp_distance(a, b) == 0, a == b);
        }
        let detour = u64::from(ulp_distance(a, c)) + u64::from(ulp_distance(c, b));
        prop_assert!(u64::from(ulp_distance(a, b)) <= detour);
    }

    #[test]
    fn heat_is_black_where_and_only_where_bits_are_equal(
        a in prop::array::uniform3(any_float()), b in prop::array::uniform3(any_float()),
        same in any::<bool>(), flip in 0..32_u32,
    ) {
        let near = [a[0], f32::from_bits(a[1].to_bits() ^ (1_u32 << flip)), a[2]];
        let heat = heat_map(&picture(&[a, a, a]), &picture(&[a, near, if same { a } else { b }])).unwrap();
        prop_assert_eq!(heat.pixels[0], [0.0; 3]);
        prop_assert!(heat.pixels[1].iter().all(|v| *v > 0.0 && *v <= 1.0));
        let differ = bits_differ(a, if same { a } else { b });
        prop_assert_eq!(heat.pixels[2] != [0.0; 3], differ);
        let found = compare(&picture(&[a]), &picture(&[b])).unwrap();
        prop_assert_eq!(found.bit_equal, !found.exceeds(0.0));
        prop_assert!(!found.rmse.is_nan() && !found.psnr.is_nan());
    }
}

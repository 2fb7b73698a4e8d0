//! "Did you mean": the nearest of the names that exist.

/// The end of a message about the unknown `name`: the nearest known name, or all of them.
///
/// Nothing is suggested that differs in more than a third of its letters.
pub fn suggest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let mut known: Vec<&str> = known.into_iter().collect();
    known.sort_unstable();
    known.dedup();
    let distance = |other: &&str| strsim::damerau_levenshtein(name, other);
    match known.iter().copied().min_by_key(distance) {
        None => "there are none".into(),
        Some(near) if is_near(name, near) => format!("did you mean {near:?}?"),
        Some(_) => format!("known are {}", known.join(", ")),
    }
}

/// Is `name` probably a misspelling of `known`?
pub fn is_near(name: &str, known: &str) -> bool {
    strsim::damerau_levenshtein(name, known) <= (known.chars().count() / 3).max(1)
}

#[cfg(test)]
mod tests {
    use super::suggest;

    #[test]
    fn the_nearest_name_is_suggested_and_a_far_one_is_not() {
        assert_eq!(suggest("colour", ["size", "color"]), "did you mean \"color\"?");
        assert_eq!(suggest("glow", ["size", "color"]), "known are color, size");
        assert_eq!(suggest("x", []), "there are none");
    }
}

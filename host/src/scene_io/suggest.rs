//! "Did you mean": the nearest of the names that exist.

/// The end of a message about the unknown `name`: the nearest known name, or all of them.
///
/// Nothing is suggested that differs in more than a third of its letters.
pub fn suggest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let mut known: Vec<&str> = known.into_iter().collect();
    known.sort_unstable();
    known.dedup();
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean {near:?}?"),
        None if known.is_empty() => "there are none".into(),
        None => format!("known are {}", known.join(", ")),
    }
}

/// The known name that `name` is probably a misspelling of.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let near = known.into_iter().filter_map(|other| Some((distance(name, other)?, other)));
    near.min().map(|(_, near)| near)
}

/// Is `name` probably a misspelling of `known`?
pub fn is_near(name: &str, known: &str) -> bool {
    distance(name, known).is_some()
}

/// How many letters differ, if they are few. Comparing takes as long as both lengths multiplied, so what nobody
/// types is not compared.
fn distance(name: &str, known: &str) -> Option<usize> {
    const LONGEST: usize = 256;
    if name.len().max(known.len()) > LONGEST {
        return None;
    }
    let distance = strsim::damerau_levenshtein(name, known);
    (distance <= (known.chars().count() / 3).max(1)).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::suggest;

    #[test]
    fn the_nearest_name_is_suggested_and_a_far_one_is_not() {
        assert_eq!(suggest("colour", ["size", "color"]), "did you mean \"color\"?");
        assert_eq!(suggest("glow", ["size", "color"]), "known are color, size");
        assert_eq!(suggest("x", []), "there are none");
        assert_eq!(suggest("aa", ["aab", "aabbbbbb"]), "did you mean \"aab\"?");
    }

    #[test]
    fn names_of_a_million_letters_are_not_compared() {
        let long = |letter: &str| letter.repeat(1 << 20);
        assert!(suggest(&long("a"), ["size", &long("b")]).starts_with("known are bbb"));
    }
}

/// Longer values are shown by their first characters, if they are all of a hash.
const SHOWN: usize = 12;

/// In words, where two lists of (what, value) differ; empty if they say the same. Each list comes with the name
/// of its file. The order of the entries does not matter.
pub fn identity_differences(
    (first, a): (&str, &[(String, String)]),
    (second, b): (&str, &[(String, String)]),
) -> Vec<String> {
    let value = |list: &[(String, String)], what: &str| {
        list.iter().find(|entry| entry.0 == what).map(|entry| entry.1.clone())
    };
    let of_first = a.iter().filter_map(|(what, one)| match value(b, what) {
        Some(other) if *one == other => None,
        Some(other) => {
            let [one, other] = shown(one, &other);
            Some(format!("{what}: {one} and {other}"))
        }
        None => Some(format!("only in {first}: {what}")),
    });
    let of_second = b
        .iter()
        .filter(|(what, _)| value(a, what).is_none())
        .map(|(what, _)| format!("only in {second}: {what}"));
    of_first.chain(of_second).collect()
}

/// Two values that differ, hashes shortened if that leaves them different.
fn shown(one: &str, other: &str) -> [String; 2] {
    let is_hash = |v: &str| v.len() > SHOWN && v.bytes().all(|b| b.is_ascii_hexdigit());
    let short = |v: &str| if is_hash(v) { format!("{}…", &v[..SHOWN]) } else { v.to_owned() };
    let (a, b) = (short(one), short(other));
    if a == b { [one.to_owned(), other.to_owned()] } else { [a, b] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(entries: &[(&str, &str)]) -> Vec<(String, String)> {
        entries.iter().map(|(what, value)| ((*what).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn differences_are_told_in_words() {
        let a = list(&[
            ("scene", "0123456789abcdef0123"),
            ("mesh bunny.ply", "77"),
            ("seed", "0"),
            ("depth", "8"),
        ]);
        let b =
            list(&[("depth", "8"), ("scene", "fedcba9876543210ffff"), ("seed", "1"), ("mesh cow.ply", "77")]);
        assert_eq!(
            identity_differences(("a.film", &a), ("b.film", &b)),
            [
                "scene: 0123456789ab… and fedcba987654…",
                "only in a.film: mesh bunny.ply",
                "seed: 0 and 1",
                "only in b.film: mesh cow.ply",
            ]
        );
        assert!(identity_differences(("a", &a), ("a", &a)).is_empty());
    }

    #[test]
    fn hashes_that_begin_alike_are_shown_whole() {
        let one = list(&[("scene", "0123456789abcdef")]);
        let other = list(&[("scene", "0123456789abcdee")]);
        assert_eq!(
            identity_differences(("a", &one), ("b", &other)),
            ["scene: 0123456789abcdef and 0123456789abcdee"]
        );
    }
}

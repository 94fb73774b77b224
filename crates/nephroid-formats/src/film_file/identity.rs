/// Longer values are shown by their first characters, if they are all of a hash.
const SHOWN: usize = 12;

/// In words, where two lists of (what, value) differ; empty if they say the same. Each list comes with the name
/// of its file. The order of the entries does not matter. What follows from another difference is left out:
/// `integrator …` where `integrator` differs, and `decided: …` where anything else does.
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
            Some((what, format!("{what}: {one} and {other}")))
        }
        None => Some((what, format!("only in {first}: {what}"))),
    });
    let of_second = b
        .iter()
        .filter(|(what, _)| value(a, what).is_none())
        .map(|(what, _)| (what, format!("only in {second}: {what}")));
    let all: Vec<(&String, String)> = of_first.chain(of_second).collect();
    let is_decided = |what: &str| what.starts_with("decided:");
    let only_decided = all.iter().all(|(what, _)| is_decided(what));
    let other_integrator = all.iter().any(|(what, _)| *what == "integrator");
    let follows = |what: &str| {
        (is_decided(what) && !only_decided) || (other_integrator && what.starts_with("integrator "))
    };
    all.iter().filter(|(what, _)| !follows(what)).map(|(_, text)| text.clone()).collect()
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
    fn what_follows_from_a_difference_is_left_out() {
        let a = list(&[
            ("integrator", "path"),
            ("integrator depth", "8"),
            ("seed", "0"),
            ("decided: paths", "3"),
        ]);
        let mut b = list(&[
            ("integrator", "ppm"),
            ("integrator kernel", "box"),
            ("seed", "1"),
            ("decided: paths", "4"),
        ]);
        let differences = |b: &[(String, String)]| identity_differences(("a", &a), ("b", b));
        assert_eq!(differences(&b), ["integrator: path and ppm", "seed: 0 and 1"]);
        b[..3].clone_from_slice(&a[..3]);
        assert_eq!(differences(&b), ["decided: paths: 3 and 4"]);
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

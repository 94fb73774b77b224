//! What a `uri` names: a file beside the document, or data in the URI itself.

/// What is behind a `uri`.
#[derive(Debug, PartialEq)]
pub(super) enum Target {
    /// The path of a file, from the folder of the document.
    File(String),
    /// The bytes themselves.
    Data(Vec<u8>),
}

/// Reads a `uri`; the error completes "the uri …".
pub(super) fn resolve(uri: &str) -> Result<Target, String> {
    let scheme = uri.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("data:"));
    if scheme {
        // RFC 2397: data:[<media type>][;base64],<data>
        let (kind, data) = uri[5..].split_once(',').ok_or("has no comma before its data")?;
        let bytes = percent_decoded(data);
        if kind.len() >= 7 && kind.as_bytes()[kind.len() - 7..].eq_ignore_ascii_case(b";base64") {
            return base64(&bytes).map(Target::Data).ok_or_else(|| "is not in base64".to_owned());
        }
        return Ok(Target::Data(bytes));
    }
    if uri.contains("://") {
        return Err("is an address in a network, and only files are read".to_owned());
    }
    let name = String::from_utf8(percent_decoded(uri)).map_err(|_| "is not in UTF-8".to_owned())?;
    Ok(Target::File(name))
}

/// Undoes `%20` and the like (RFC 3986, §2.1); a `%` without two digits stands for itself.
fn percent_decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let digit = |at: usize| bytes.get(at).and_then(|b| char::from(*b).to_digit(16));
        match (bytes[i], digit(i + 1), digit(i + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((high * 16 + low) as u8);
                i += 3;
            }
            (byte, ..) => {
                out.push(byte);
                i += 1;
            }
        }
    }
    out
}

/// RFC 4648, §4, and the alphabet of §5 as well; padding and white space may be left out or put in.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    let mut ended = false;
    for byte in text {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' => {
                ended = true;
                continue;
            }
            b' ' | b'\t' | b'\r' | b'\n' => continue,
            _ => return None,
        };
        if ended {
            return None;
        }
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    // Six bits alone make no byte.
    (count < 6).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data(uri: &str) -> Result<Vec<u8>, String> {
        resolve(uri).map(|target| match target {
            Target::Data(bytes) => bytes,
            Target::File(name) => panic!("{name} is a file"),
        })
    }

    #[test]
    fn data_is_decoded() {
        // The examples of RFC 4648, §10.
        for (coded, plain) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob")] {
            assert_eq!(data(&format!("data:application/octet-stream;base64,{coded}")), Ok(plain.into()));
        }
        assert_eq!(data("DATA:image/png;BASE64,%2B%2F%2b/"), Ok(vec![0xfb, 0xff, 0xbf]));
        assert_eq!(data("data:text/plain,a%20b%"), Ok(b"a b%".to_vec()));
    }

    #[test]
    fn bad_data_is_told() {
        assert!(data("data:;base64,Z").is_err());
        assert!(data("data:;base64,Zg==Zg==").is_err());
        assert!(data("data:;base64,Z!==").is_err());
        assert!(data("data:;base64").is_err());
        assert!(resolve("https://a/b.bin").is_err());
    }

    #[test]
    fn names_of_files_are_decoded() {
        assert_eq!(resolve("a%20%C3%A4/b.bin"), Ok(Target::File("a ä/b.bin".into())));
        assert_eq!(resolve("100%.png"), Ok(Target::File("100%.png".into())));
        assert!(resolve("%ff").is_err());
    }
}

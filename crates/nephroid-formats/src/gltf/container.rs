//! The two forms of a file: JSON alone, and a container with JSON and one buffer.

/// What is in a file.
#[derive(Debug, PartialEq)]
pub(super) struct Container {
    /// The document.
    pub(super) json: String,
    /// The first buffer, if it is in the file.
    pub(super) binary: Option<Vec<u8>>,
}

const MAGIC: &[u8] = b"glTF";
const JSON: [u8; 4] = *b"JSON";
const BINARY: [u8; 4] = *b"BIN\0";

/// Whether a file starts as a container does.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Takes a file apart (glTF 2.0, §4.4).
pub(super) fn open(bytes: Vec<u8>) -> Result<Container, String> {
    if !is_binary(&bytes) {
        return Ok(Container { json: text(bytes)?, binary: None });
    }
    let header: [u32; 3] = [word(&bytes, 0), word(&bytes, 4), word(&bytes, 8)].map(|w| w.unwrap_or(0));
    if bytes.len() < 12 {
        return Err("the file ends in its header".to_owned());
    }
    if header[1] != 2 {
        return Err(format!("the file is a container of version {}, and only version 2 is read", header[1]));
    }
    let length = header[2] as usize;
    if length > bytes.len() {
        return Err(format!("the file is cut off: it has {} bytes and should have {length}", bytes.len()));
    }
    let (mut json, mut binary) = (None, None);
    let mut at = 12;
    while at < length {
        let (Some(size), Some(kind)) = (word(&bytes, at), bytes.get(at + 4..at + 8)) else {
            return Err(format!("the file ends in the header of a chunk, at byte {at}"));
        };
        let Some(content) =
            (at + 8).checked_add(size as usize).filter(|end| *end <= length).map(|end| &bytes[at + 8..end])
        else {
            return Err(format!(
                "a chunk of {size} bytes at byte {at} reaches beyond the end of the file at {length}"
            ));
        };
        if at == 12 && kind != JSON {
            return Err("the first chunk of the file is not its document (JSON)".to_owned());
        }
        if at == 12 {
            json = Some(content.to_vec());
        } else if kind == BINARY && binary.is_none() {
            binary = Some(content.to_vec());
        }
        at += 8 + size as usize;
    }
    let json = json.ok_or("the file has no document (a chunk of JSON)")?;
    Ok(Container { json: text(json)?, binary })
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at + 4)?.first_chunk().map(|word| u32::from_le_bytes(*word))
}

fn text(bytes: Vec<u8>) -> Result<String, String> {
    let text = String::from_utf8(bytes).map_err(|error| {
        format!("the document is not in UTF-8: see byte {}", error.utf8_error().valid_up_to())
    })?;
    // Not allowed, and written by some all the same.
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A container of such chunks.
    pub(in super::super) fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, content) in chunks {
            body.extend((content.len() as u32).to_le_bytes());
            body.extend(*kind);
            body.extend(*content);
        }
        let mut out = MAGIC.to_vec();
        out.extend(2u32.to_le_bytes());
        out.extend((12 + body.len() as u32).to_le_bytes());
        out.extend(body);
        out
    }

    #[test]
    fn chunks_are_found() {
        let file = glb(&[(b"JSON", b"{}  "), (b"ABCD", b"1234"), (b"BIN\0", b"data")]);
        let expected = Container { json: "{}  ".into(), binary: Some(b"data".to_vec()) };
        assert_eq!(open(file), Ok(expected));
        let json = Container { json: "{}".into(), binary: None };
        assert_eq!(open(b"{}".to_vec()), Ok(json));
    }

    #[test]
    fn damage_is_told() {
        let whole = glb(&[(b"JSON", b"{}  "), (b"BIN\0", b"data")]);
        for length in 4..whole.len() {
            assert!(open(whole[..length].to_vec()).is_err(), "{length} bytes");
        }
        let fails = |bytes: Vec<u8>| open(bytes).expect_err("it is damaged");
        assert!(fails(glb(&[(b"BIN\0", b"data")])).contains("first chunk"));
        assert!(fails(glb(&[])).contains("no document"));
        let mut old = whole.clone();
        old[4] = 1;
        assert!(fails(old).contains("version 1"));
        let mut long = whole.clone();
        long[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(fails(long).contains("beyond the end"));
        assert!(fails(vec![b'{', 0xff]).contains("UTF-8"));
    }
}

//! Pictures that are shown while they are rendered.

use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::thread::JoinHandle;

use crate::support::{Dir, Run};

/// What is in a packet of tev: its kind, and the rest.
type Packet = (u8, Vec<u8>);

/// Reads a packet: a length that counts itself, and then the packet.
fn packet(stream: &mut TcpStream) -> Option<Packet> {
    let mut length = [0; 4];
    stream.read_exact(&mut length).ok()?;
    let mut rest = vec![0; u32::from_le_bytes(length) as usize - 4];
    stream.read_exact(&mut rest).ok()?;
    Some((rest[0], rest.split_off(1)))
}

/// Something that listens as tev does, for so many packets, and its address.
fn viewer(packets: usize) -> (String, JoinHandle<Vec<Packet>>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let listen = move || {
        let mut stream = listener.accept().unwrap().0;
        std::iter::from_fn(|| packet(&mut stream)).take(packets).collect()
    };
    (address, std::thread::spawn(listen))
}

fn render(dir: &Dir, more: &[&str]) -> Run {
    dir.run(&[&["render", "a.xml", "--passes", "4", "-o", "x.exr"], more].concat())
}

#[test]
fn tev_shows_the_picture_as_it_is_in_the_end() {
    let dir = Dir::with_scene("", "");
    let (address, packets) = viewer(usize::MAX);
    render(&dir, &["--tev", &address]).ends_with(0).does_not_say("warning");
    let packets = packets.join().unwrap();
    let kinds: Vec<u8> = packets.iter().map(|(kind, _)| *kind).collect();
    assert!(kinds.len() >= 2 && kinds[0] == 4 && kinds[1..].iter().all(|kind| *kind == 6), "{kinds:?}");
    // Neither takes the focus; the name, and for a new picture its size.
    assert_eq!(packets[0].1[..11], *b"\0a\0\x08\0\0\0\x06\0\0\0");
    let last = &packets.last().unwrap().1;
    assert_eq!(last[..3], *b"\0a\0");
    let numbers: Vec<f32> = last[last.len() - 4 * 3 * 8 * 6..]
        .chunks_exact(4)
        .map(|four| f32::from_le_bytes(four.try_into().unwrap()))
        .collect();
    let written = crate::layers::channels(&dir, "x.exr");
    for (c, channel) in ["R", "G", "B"].into_iter().enumerate() {
        let shown: Vec<f32> = numbers.iter().skip(c).step_by(3).copied().collect();
        assert_eq!(shown, written[channel]);
    }
}

#[test]
fn a_viewer_that_is_not_there_or_goes_away_is_told_once() {
    let dir = Dir::with_scene("", "");
    let nobody = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let run = render(&dir, &["--tev", &nobody]).ends_with(0).says("warning: no more pictures for tev");
    assert_eq!(run.stderr.matches("tev").count(), 1);
    // It reads the first packet and leaves; a picture of this size does not fit into what is on its way.
    let (address, _) = viewer(1);
    let large = ["--tev", &address, "--resolution", "400x400", "--spp", "1", "--integrator", "path"];
    render(&dir, &large).ends_with(0);
    let run = render(&dir, &["--tev", "no-such-name.invalid:14158"]).ends_with(0);
    run.says("warning: no more pictures for tev: no-such-name.invalid:14158: ");
    dir.run(&["render", "a.xml", "--tev", "nowhere"]).ends_with(2).says("write HOST:PORT");
}

#[test]
fn a_preview_is_the_picture_in_the_end() {
    let dir = Dir::with_scene("", "");
    let args = ["--preview", "p.png", "--preview-every", "0.001", "-o", "x.png", "--tonemap", "reinhard"];
    render(&dir, &args).ends_with(0);
    assert!(dir.read("p.png") == dir.read("x.png"));
    render(&dir, &["--preview", "p.exr"]).ends_with(2).says("this picture is a .png");
    render(&dir, &["--preview", "no/p.png"]).ends_with(4).says("there is no folder no");
    assert_eq!(dir.files(), ["p.png", "x.exr", "x.png"]);
}

//! Pictures for the viewer tev, <https://github.com/Tom94/tev>.

use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use nephroid::texture::Image;
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// A viewer that takes longer to answer or to read is not waited for.
const PATIENCE: Duration = Duration::from_secs(2);

const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A viewer and the picture that it shows of us.
pub struct Viewer {
    /// HOST:PORT.
    address: String,
    name: String,
    client: Option<TevClient>,
}

impl Viewer {
    /// A viewer that is called when there is a picture.
    pub fn new(address: &str, name: &str) -> Self {
        Self { address: address.to_owned(), name: name.to_owned(), client: None }
    }

    /// Shows a picture, which has the same size each time. After an error, there is no more to be had of this viewer.
    pub fn show(&mut self, image: &Image) -> Result<(), String> {
        if image.pixels.is_empty() {
            return Ok(());
        }
        self.send(image).map_err(|error| format!("{}: {error}", self.address))
    }

    fn send(&mut self, image: &Image) -> io::Result<()> {
        let client = match &mut self.client {
            Some(client) => client,
            None => {
                let stream = call(&self.address)?;
                stream.set_write_timeout(Some(PATIENCE))?;
                stream.set_nodelay(true)?;
                let mut client = TevClient::wrap(stream);
                client.send(PacketCreateImage {
                    image_name: &self.name,
                    grab_focus: false,
                    width: image.width,
                    height: image.height,
                    channel_names: &CHANNELS,
                })?;
                self.client.insert(client)
            }
        };
        let data: Vec<f32> = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
        client.send(PacketUpdateImage {
            image_name: &self.name,
            grab_focus: false,
            channel_names: &CHANNELS,
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3, 3, 3],
            x: 0,
            y: 0,
            width: image.width,
            height: image.height,
            data: &data,
        })
    }
}

/// Looks the name up, and tries all addresses that it has: a viewer may listen at one of them only.
fn call(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(io::ErrorKind::NotFound, "the name has no address");
    for one in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&one, PATIENCE) {
            Ok(stream) => return Ok(stream),
            Err(error) => last = error,
        }
    }
    Err(last)
}

//! Photons in files, for other programs to look at: tables of comma-separated values and clouds of points.
//!
//! Both have the same columns, one photon a row, by map and within a map by path. Positions are in scene
//! units and world space, directions are unit vectors along the photons' flight, and powers are in W, each
//! photon's share: divided by the paths emitted for its map.

mod csv;
mod ply;

pub use self::csv::{encode_csv, write_csv};
pub use self::ply::{encode_ply, write_ply};

#[cfg(test)]
mod tests {
    use nephroid::color::Rgb;
    use nephroid::integrator::MapName;
    use nephroid::laboratory::MapPhoton;
    use nephroid::math::Vec3;
    use nephroid::photon_map::Photon;
    use nephroid::transport::Bounces;

    use super::*;

    fn photon() -> MapPhoton {
        let photon = Photon {
            position: Vec3::new(0.1, -2.5, 1e-9),
            power: Rgb::new(1e-20, 0.5, 3.0),
            wi: Vec3::Z,
            normal: Vec3::Z,
            depth: 1,
            light: 4,
        };
        MapPhoton { photon, map: MapName::Caustic, path: 1 << 40, bounces: Bounces::default() }
    }

    #[test]
    fn tables_have_every_digit_that_counts() {
        let text = String::from_utf8(encode_csv(&[photon()]).unwrap()).unwrap();
        let (header, row) = text.trim_end().split_once('\n').unwrap();
        assert_eq!(header, "x,y,z,dx,dy,dz,power_r,power_g,power_b,map,bounce,light,path,kind");
        let digits = "0.1,-2.5,0.000000001,0,0,-1,0.00000000000000000001,0.5,3,caustic,0,4,1099511627776,LD";
        assert_eq!(row, digits);
    }

    #[test]
    fn clouds_hold_the_bits() {
        let bytes = encode_ply(&[photon()]).unwrap();
        let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        let mut expected: Vec<u8> = [0.1f32, -2.5, 1e-9, 0.0, 0.0, -1.0, 1e-20, 0.5, 3.0]
            .into_iter()
            .flat_map(f32::to_le_bytes)
            .collect();
        expected.push(1);
        expected.extend([0, 0, 0, 0, 4, 0, 0, 0]);
        expected.extend(((1u64 << 40) as f64).to_le_bytes());
        assert_eq!(bytes[end..], expected);
        let none = encode_ply(&[]).unwrap();
        assert!(none.windows(17).any(|w| w == b"element vertex 0\n".as_slice()));
    }
}

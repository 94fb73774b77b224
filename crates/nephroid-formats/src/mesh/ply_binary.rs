//! The elements of binary PLY files, one at a time: big meshes are never held as numbers of a general kind.

use ply_rs_bw::ply::{ElementDef, Encoding, PropertyType, ScalarType};

use super::MeshError;

/// What follows the header of a binary file.
pub(super) struct Body<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

/// What is done with a property of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// Nothing.
    None,
    /// Its number goes to this place.
    Number(usize),
    /// The numbers of its list are wanted.
    List,
}

impl<'a> Body<'a> {
    pub fn new(bytes: &'a [u8], encoding: Encoding) -> Self {
        Self { bytes, big_endian: encoding == Encoding::BinaryBigEndian }
    }

    /// Hands over the numbers and the list of each element that are wanted, in order.
    pub fn elements<const N: usize>(
        &mut self,
        element: &ElementDef,
        wanted: impl Fn(&str) -> Use,
        mut take: impl FnMut(&[f64; N], &[i64]) -> Result<(), MeshError>,
    ) -> Result<(), MeshError> {
        let plan: Vec<(&PropertyType, Use)> =
            element.properties.iter().map(|(name, p)| (&p.data_type, wanted(name))).collect();
        let (mut numbers, mut list) = ([0.0; N], Vec::new());
        for number in 0..element.count {
            let short = || MeshError::new(format!("{} {number} is cut off", element.name));
            list.clear();
            for &(data_type, wanted) in &plan {
                match data_type {
                    PropertyType::Scalar(kind) => {
                        let value = self.scalar(kind).ok_or_else(short)?;
                        if let Use::Number(place) = wanted {
                            numbers[place] = value;
                        }
                    }
                    PropertyType::List(of_count, kind) => {
                        let count = self.scalar(of_count).ok_or_else(short)?;
                        if count.is_nan() || count < 0.0 {
                            let message = format!("{} {number} has a list of length {count}", element.name);
                            return Err(MeshError::new(message));
                        }
                        let length = (count as usize).saturating_mul(size_of_scalar(kind) as usize);
                        if length > self.bytes.len() {
                            return Err(short());
                        }
                        if wanted == Use::List {
                            for _ in 0..count as usize {
                                list.push(self.scalar(kind).ok_or_else(short)? as i64);
                            }
                        } else {
                            self.bytes = &self.bytes[length..];
                        }
                    }
                }
            }
            take(&numbers, &list)?;
        }
        Ok(())
    }

    #[inline]
    fn scalar(&mut self, kind: &ScalarType) -> Option<f64> {
        Some(match kind {
            ScalarType::Char => f64::from(self.next::<1>()?[0].cast_signed()),
            ScalarType::UChar => f64::from(self.next::<1>()?[0]),
            ScalarType::Short => f64::from(i16::from_le_bytes(self.next()?)),
            ScalarType::UShort => f64::from(u16::from_le_bytes(self.next()?)),
            ScalarType::Int => f64::from(i32::from_le_bytes(self.next()?)),
            ScalarType::UInt => f64::from(u32::from_le_bytes(self.next()?)),
            ScalarType::Float => f64::from(f32::from_le_bytes(self.next()?)),
            ScalarType::Double => f64::from_le_bytes(self.next()?),
        })
    }

    /// The next bytes, the lowest first.
    #[inline]
    fn next<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (&(mut out), rest) = self.bytes.split_first_chunk::<N>()?;
        self.bytes = rest;
        if self.big_endian {
            out.reverse();
        }
        Some(out)
    }
}

pub(super) fn size_of_scalar(kind: &ScalarType) -> u64 {
    match kind {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

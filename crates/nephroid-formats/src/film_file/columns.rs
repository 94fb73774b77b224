//! Integers column by column, with as few bytes each as the largest of the column needs.
//!
//! Sums of many bits have long rows of zeros above them and noise below, so cutting off the former is most of what
//! a compressor finds, and is read at the speed of memory.

/// Appends a column of two's complement numbers and returns the bytes of each, from 1 to 16.
pub fn pack(values: impl Iterator<Item = i128> + Clone, out: &mut Vec<u8>) -> u8 {
    // Bits that differ from the sign, of all numbers together.
    let used = values.clone().fold(0, |used, v| used | (v ^ (v >> 127)));
    let bits = 128 - used.leading_zeros() + 1;
    let width = bits.div_ceil(8) as usize;
    for v in values {
        out.extend_from_slice(&v.to_le_bytes()[..width]);
    }
    width as u8
}

/// A column as it was packed.
#[derive(Clone, Copy)]
pub struct Column<'b> {
    width: usize,
    /// From its first number on, and on to the end of the block.
    bytes: &'b [u8],
}

impl Column<'_> {
    /// The number in row `row`.
    #[inline]
    pub fn get(&self, row: usize) -> i128 {
        let start = row * self.width;
        let rest = &self.bytes[start..];
        let raw = match rest.first_chunk() {
            Some(sixteen) => i128::from_le_bytes(*sixteen),
            None => {
                let mut padded = [0; 16];
                padded[..rest.len()].copy_from_slice(rest);
                i128::from_le_bytes(padded)
            }
        };
        let unused = 128 - 8 * self.width as u32;
        (raw << unused) >> unused
    }
}

/// The columns of a block, which has a byte for the width of each and then their numbers. `None` if the block has
/// another length than that comes to, or a number more bytes than its column's `largest`.
pub fn unpack<'b>(block: &'b [u8], rows: usize, largest: &[u8]) -> Option<Vec<Column<'b>>> {
    let (widths, mut bytes) = block.split_at_checked(largest.len())?;
    let mut columns = Vec::with_capacity(largest.len());
    for (width, largest) in widths.iter().zip(largest) {
        if !(1..=*largest).contains(width) {
            return None;
        }
        let width = usize::from(*width);
        columns.push(Column { width, bytes });
        bytes = bytes.get(width * rows..)?;
    }
    bytes.is_empty().then_some(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_come_back_with_as_few_bytes_as_they_need() {
        let cases: [(&[i128], u8); 8] = [
            (&[0, 0, 0], 1),
            (&[127, -128, 3], 1),
            (&[128, 0, 0], 2),
            (&[-129, 1, -1], 2),
            (&[(1 << 95) - 1, -(1 << 95), 7], 12),
            (&[1 << 95, 0, 0], 13),
            (&[i128::MIN, i128::MAX, -1], 16),
            (&[-1, -1, -1], 1),
        ];
        let mut block = vec![0; cases.len()];
        for (i, (values, width)) in cases.iter().enumerate() {
            block[i] = pack(values.iter().copied(), &mut block);
            assert_eq!(block[i], *width, "{values:?}");
        }
        let columns = unpack(&block, 3, &[16; 8]).expect("a good block");
        for (column, (values, _)) in columns.iter().zip(cases) {
            assert_eq!([0, 1, 2].map(|row| column.get(row)), values);
        }
    }

    #[test]
    fn blocks_of_another_length_or_width_are_refused() {
        let block = [2, 1, 0, 0, 0, 0, 5, 6];
        assert!(unpack(&block, 2, &[2, 1]).is_some());
        assert!(unpack(&block, 2, &[1, 1]).is_none());
        assert!(unpack(&block, 3, &[2, 1]).is_none());
        assert!(unpack(&block, 1, &[2, 1]).is_none());
        assert!(unpack(&[0, 1, 0], 1, &[2, 1]).is_none());
        assert!(unpack(&[1], 0, &[2, 1]).is_none());
    }
}

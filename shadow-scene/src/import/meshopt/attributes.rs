//! Mode 0: elements of any kind, as differences between their bytes.

use super::{Decoded, Reader};

/// Elements that share a header.
const GROUP: usize = 16;
/// The most elements of a block.
const MAX_BLOCK: usize = 256;
/// The most bytes of a block.
const MAX_BLOCK_BYTES: usize = 8192;

/// What a version's streams start with, and how long their tail is at least.
const VERSION_0: u8 = 0xa0;
const VERSION_1: u8 = 0xa1;
const MIN_TAIL_0: usize = 32;
const MIN_TAIL_1: usize = 24;

/// How the differences of a channel, 4 bytes of each element, are taken.
#[derive(Clone, Copy)]
enum Channel {
    Bytes,
    Words,
    /// Exclusive or of 32 bits, rotated.
    Bits(u32),
}

/// Decodes `count` elements of `stride` bytes, which must be a multiple of 4 up to 256.
pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Decoded<Vec<u8>> {
    let mut reader = Reader(bytes);
    let is_newer = match reader.byte()? {
        VERSION_0 => false,
        VERSION_1 => true,
        other => return Err(format!("the compressed attributes start with {other:#x}, which is no known version")),
    };
    let tail_length = if is_newer { stride + stride / 4 } else { stride };
    let padded = tail_length.max(if is_newer { MIN_TAIL_1 } else { MIN_TAIL_0 });
    let body = reader.0.len().checked_sub(padded).ok_or("the compressed data ends too early")?;
    let (body, tail) = reader.0.split_at(body);
    let (first, modes) = tail[padded - tail_length..].split_at(stride);
    let channels = channels(modes, stride)?;

    let mut reader = Reader(body);
    let mut decoded = vec![0; count * stride];
    let mut last = first.to_vec();
    let block = (MAX_BLOCK_BYTES / stride / GROUP * GROUP).min(MAX_BLOCK);
    let mut deltas = [[0; MAX_BLOCK]; 4];
    for elements in decoded.chunks_mut(block * stride) {
        let here = elements.len() / stride;
        let controls = if is_newer { Some(reader.take(stride / 4)?) } else { None };
        for (c, channel) in channels.iter().enumerate() {
            for (byte, deltas) in deltas.iter_mut().enumerate() {
                let control = controls.map(|controls| controls[c] >> (2 * byte) & 3);
                read_deltas(&mut reader, control, deltas, here)?;
            }
            let last = &mut last[4 * c..][..4];
            for (e, element) in elements.chunks_exact_mut(stride).enumerate() {
                let delta = [deltas[0][e], deltas[1][e], deltas[2][e], deltas[3][e]];
                let value = channel.add([last[0], last[1], last[2], last[3]], delta);
                last.copy_from_slice(&value);
                element[4 * c..][..4].copy_from_slice(&value);
            }
        }
    }
    reader.finish()?;
    Ok(decoded)
}

/// The modes of the channels: those of the tail, or all bytes where it has none.
fn channels(modes: &[u8], stride: usize) -> Decoded<Vec<Channel>> {
    if modes.is_empty() {
        return Ok(vec![Channel::Bytes; stride / 4]);
    }
    let channel = |&mode: &u8| match (mode & 15, mode >> 4) {
        (0, 0) => Ok(Channel::Bytes),
        (1, 0) => Ok(Channel::Words),
        (2, rotation) => Ok(Channel::Bits(rotation.into())),
        _ => Err(format!("a channel of the compressed attributes has the unknown mode {mode:#x}")),
    };
    modes.iter().map(channel).collect()
}

impl Channel {
    /// The value after `last`, little-endian.
    fn add(self, last: [u8; 4], delta: [u8; 4]) -> [u8; 4] {
        match self {
            Self::Bytes => core::array::from_fn(|i| {
                let delta = delta[i];
                last[i].wrapping_add(delta >> 1 ^ (delta & 1).wrapping_neg())
            }),
            Self::Words => {
                let add = |low: usize| {
                    let delta = u16::from_le_bytes([delta[low], delta[low + 1]]);
                    let last = u16::from_le_bytes([last[low], last[low + 1]]);
                    last.wrapping_add(delta >> 1 ^ (delta & 1).wrapping_neg()).to_le_bytes()
                };
                let ([a, b], [c, d]) = (add(0), add(2));
                [a, b, c, d]
            }
            Self::Bits(rotation) => (u32::from_le_bytes(last) ^ u32::from_le_bytes(delta).rotate_left(rotation)).to_le_bytes(),
        }
    }
}

/// Reads the differences of one byte of the `count` elements of a block. `control` is `None` in version 0.
fn read_deltas(reader: &mut Reader<'_>, control: Option<u8>, deltas: &mut [u8; MAX_BLOCK], count: usize) -> Decoded<()> {
    /// The bits of a difference for each value of a group's header.
    const BITS_0: [u32; 4] = [0, 2, 4, 8];
    const CONTROL_0: [u32; 4] = [0, 1, 2, 4];
    const CONTROL_1: [u32; 4] = [1, 2, 4, 8];
    let bits = match control {
        None => BITS_0,
        Some(0) => CONTROL_0,
        Some(1) => CONTROL_1,
        Some(2) => {
            deltas.fill(0);
            return Ok(());
        }
        Some(_) => {
            // Only these are not rounded up to whole groups.
            deltas[..count].copy_from_slice(reader.take(count)?);
            return Ok(());
        }
    };
    let groups = count.div_ceil(GROUP);
    let headers = reader.take(groups.div_ceil(4))?;
    for (g, group) in deltas.chunks_exact_mut(GROUP).take(groups).enumerate() {
        let header = headers[g / 4] >> (2 * (g % 4)) & 3;
        match bits[usize::from(header)] {
            0 => group.fill(0),
            8 => group.copy_from_slice(reader.take(GROUP)?),
            bits => read_group(reader, bits, group)?,
        }
    }
    Ok(())
}

/// Reads a group whose differences have 1, 2 or 4 bits; all of them set stand for a whole byte behind the group.
fn read_group(reader: &mut Reader<'_>, bits: u32, group: &mut [u8]) -> Decoded<()> {
    let per_byte = 8 / bits as usize;
    let sentinel = (1 << bits) - 1;
    let packed = reader.take(GROUP / per_byte)?;
    for (i, delta) in group.iter_mut().enumerate() {
        let place = (i % per_byte) as u32 * bits;
        // Single bits come from the lowest on, wider ones from the highest.
        let shift = if bits == 1 { place } else { 8 - bits - place };
        let value = packed[i / per_byte] >> shift & sentinel;
        *delta = if value == sentinel { reader.byte()? } else { value };
    }
    Ok(())
}

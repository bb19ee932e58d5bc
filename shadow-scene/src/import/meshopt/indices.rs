//! Modes 1 and 2: indices, of triangles and of anything else.

use super::{Decoded, Reader};

/// What a stream of triangles starts with: the extension has version 1 only.
const TRIANGLES: u8 = 0xe1;
/// What a stream of other indices starts with.
const SEQUENCE: u8 = 0xd1;
/// Bytes of the table behind the triangles.
const TABLE: usize = 16;
/// Bytes behind a stream of other indices.
const SEQUENCE_TAIL: usize = 4;

/// The last 16 things, the newest first.
struct Fifo<T> {
    entries: [Option<T>; 16],
    next: usize,
}

impl<T: Copy> Fifo<T> {
    fn new() -> Self {
        Self { entries: [None; 16], next: 0 }
    }

    fn push(&mut self, entry: T) {
        self.entries[self.next] = Some(entry);
        self.next = (self.next + 1) % self.entries.len();
    }

    /// The thing pushed `back` things before the newest.
    fn get(&self, back: u8) -> Decoded<T> {
        let entry = (self.next + self.entries.len() - 1 - usize::from(back & 15)) % self.entries.len();
        self.entries[entry].ok_or_else(|| "a compressed triangle refers to one that does not exist".into())
    }
}

/// What decoding triangles goes by.
struct Triangles<'a> {
    data: Reader<'a>,
    next: u32,
    last: u32,
    edges: Fifo<(u32, u32)>,
    vertices: Fifo<u32>,
}

/// A number whose lowest bit says whether the rest is negative.
fn from_zigzag(value: u32) -> u32 {
    value >> 1 ^ (value & 1).wrapping_neg()
}

impl Triangles<'_> {
    fn take_next(&mut self) -> u32 {
        let next = self.next;
        self.next = next.wrapping_add(1);
        next
    }

    fn explicit(&mut self) -> Decoded<u32> {
        self.last = self.last.wrapping_add(from_zigzag(self.data.varint()?));
        Ok(self.last)
    }

    /// A corner by a half byte: the next vertex, one of the last ones, or one that the data name.
    fn corner(&mut self, code: u8) -> Decoded<u32> {
        match code {
            0 => Ok(self.take_next()),
            15 => self.explicit(),
            back => self.vertices.get(back - 1),
        }
    }

    /// A triangle on one of the last edges.
    fn on_edge(&mut self, edge: u8, code: u8) -> Decoded<[u32; 3]> {
        let (a, b) = self.edges.get(edge)?;
        let c = match code {
            0 => self.take_next(),
            13 | 14 => {
                self.last = if code == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.last
            }
            15 => self.explicit()?,
            back => self.vertices.get(back)?,
        };
        self.edges.push((c, b));
        self.edges.push((a, c));
        if !(1..13).contains(&code) {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }

    /// A triangle without an edge of the last ones: `a` is its first corner, `codes` has the other two.
    fn free(&mut self, a: u32, codes: u8) -> Decoded<[u32; 3]> {
        let (second, third) = (codes >> 4, codes & 15);
        let (b, c) = (self.corner(second)?, self.corner(third)?);
        self.edges.push((b, a));
        self.edges.push((c, b));
        self.edges.push((a, c));
        self.vertices.push(a);
        for (code, vertex) in [(second, b), (third, c)] {
            if code == 0 || code == 15 {
                self.vertices.push(vertex);
            }
        }
        Ok([a, b, c])
    }
}

/// Decodes `count` indices of triangles; `count` must be a multiple of 3.
pub(super) fn decode_triangles(bytes: &[u8], count: usize) -> Decoded<Vec<u32>> {
    let mut reader = Reader(bytes);
    if reader.byte()? != TRIANGLES {
        return Err(format!("the compressed triangles do not start with {TRIANGLES:#x}"));
    }
    let codes = reader.take(count / 3)?;
    let body = reader.0.len().checked_sub(TABLE).ok_or("the compressed data ends too early")?;
    let (data, table) = reader.0.split_at(body);
    if table[TABLE - 2..] != [0, 0] || table.iter().any(|entry| entry & 15 == 15 || entry >> 4 == 15) {
        return Err("the table behind the compressed triangles has values that it may not have".into());
    }
    let mut state = Triangles { data: Reader(data), next: 0, last: 0, edges: Fifo::new(), vertices: Fifo::new() };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        indices.extend(match (code >> 4, code & 15) {
            (15, free @ (14 | 15)) => {
                let codes = state.data.byte()?;
                if codes == 0 {
                    state.next = 0;
                }
                let a = if free == 14 { state.take_next() } else { state.explicit()? };
                state.free(a, codes)?
            }
            (15, entry) => {
                let a = state.take_next();
                state.free(a, table[usize::from(entry)])?
            }
            (edge, code) => state.on_edge(edge, code)?,
        });
    }
    state.data.finish()?;
    Ok(indices)
}

/// Decodes `count` indices of anything.
pub(super) fn decode_sequence(bytes: &[u8], count: usize) -> Decoded<Vec<u32>> {
    let mut reader = Reader(bytes);
    if reader.byte()? != SEQUENCE {
        return Err(format!("the compressed indices do not start with {SEQUENCE:#x}"));
    }
    let body = reader.0.len().checked_sub(SEQUENCE_TAIL).ok_or("the compressed data ends too early")?;
    // Each index takes at least a byte.
    if count > body {
        return Err("the compressed data ends too early".into());
    }
    let mut reader = Reader(&reader.0[..body]);
    let mut last = [0_u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let value = reader.varint()?;
        let baseline = &mut last[(value & 1) as usize];
        *baseline = baseline.wrapping_add(from_zigzag(value >> 1));
        indices.push(*baseline);
    }
    reader.finish()?;
    Ok(indices)
}

/// Indices as little-endian numbers of 2 or 4 bytes.
pub(super) fn pack(indices: &[u32], size: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(indices.len() * size);
    for index in indices {
        bytes.extend_from_slice(&index.to_le_bytes()[..size]);
    }
    bytes
}

//! The numbers that buffers hold.

/// The type of one.
#[derive(Clone, Copy)]
pub enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// By the number that glTF has for it.
    pub fn from_code(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            _ => return None,
        })
    }

    /// Bytes.
    pub fn size(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// The number at the start of the bytes, zero where they end before; a normalised one is a share in [-1, 1].
    pub fn number(self, bytes: &[u8], is_normalised: bool) -> f32 {
        let (number, most) = match self {
            Component::F32 => return f32::from_le_bytes(first(bytes)),
            Component::I8 => (f64::from(i8::from_le_bytes(first(bytes))), f64::from(i8::MAX)),
            Component::U8 => (f64::from(u8::from_le_bytes(first(bytes))), f64::from(u8::MAX)),
            Component::I16 => (f64::from(i16::from_le_bytes(first(bytes))), f64::from(i16::MAX)),
            Component::U16 => (f64::from(u16::from_le_bytes(first(bytes))), f64::from(u16::MAX)),
            Component::U32 => (f64::from(u32::from_le_bytes(first(bytes))), f64::from(u32::MAX)),
        };
        if is_normalised { (number / most).max(-1.0) as f32 } else { number as f32 }
    }

    /// Likewise, of a list of indices; `u32::MAX`, which is the number of nothing, for what is no whole number.
    pub fn whole(self, bytes: &[u8]) -> u32 {
        match self {
            Component::U8 => u8::from_le_bytes(first(bytes)).into(),
            Component::U16 => u16::from_le_bytes(first(bytes)).into(),
            Component::U32 => u32::from_le_bytes(first(bytes)),
            Component::I8 | Component::I16 | Component::F32 => u32::MAX,
        }
    }
}

fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk::<N>().copied().unwrap_or([0; N])
}

const NAMES: [(&str, usize); 5] = [("SCALAR", 1), ("VEC2", 2), ("VEC3", 3), ("VEC4", 4), ("MAT4", 16)];

/// How many numbers an element of the type has; of matrices only those of four rows are read.
pub fn width(kind: &str) -> Option<usize> {
    NAMES.iter().find(|(name, _)| *name == kind).map(|&(_, width)| width)
}

/// The type of so many numbers.
pub fn name(width: usize) -> Option<&'static str> {
    NAMES.iter().find(|(_, of)| *of == width).map(|&(name, _)| name)
}

//! Lists of numbers and vectors in buffers.
//!
//! They are read one element at a time: a primitive may use a few of many, and a file may name one list a million times.

use std::cell::Cell;

use super::buffer::Buffers;
use super::component::{self, Component};
use super::document::{Accessor, Document, Sparse, SparsePart, pick};
use crate::scene::Unplaced;

/// The lists of a file.
pub struct Accessors<'f> {
    all: &'f [Accessor],
    buffers: &'f Buffers<'f>,
    /// How many sparse elements may still be looked at, however often a file names them.
    sparse: Cell<usize>,
}

const MOST_SPARSE: usize = 1 << 28;

/// A list that is there in full.
pub struct Elements<'f> {
    /// How many there are, at most `u32::MAX`.
    pub count: usize,
    /// Numbers of an element.
    pub width: usize,
    component: Component,
    /// That of the component.
    code: u64,
    /// All are zero without.
    base: Option<Strided<'f>>,
    /// Elements in place of those of the base.
    over: Option<Over<'f>>,
    is_normalised: bool,
}

struct Over<'f> {
    /// In rising order.
    places: Vec<u32>,
    values: Strided<'f>,
}

/// Elements with a distance of `stride` bytes; all of them are within the bytes.
struct Strided<'f> {
    bytes: &'f [u8],
    stride: usize,
}

impl<'f> Accessors<'f> {
    /// Those of a document, by its buffers.
    pub fn new(document: &'f Document, buffers: &'f Buffers<'f>) -> Self {
        Accessors { all: &document.accessors, buffers, sparse: Cell::new(MOST_SPARSE) }
    }

    /// The list of a number, whose elements have so many numbers; `owner` is the JSON path of what names it.
    ///
    /// # Errors
    /// There is no such list, it is of another type, or its buffer ends before it.
    pub fn open(&self, number: usize, widths: &[usize], owner: &str) -> Unplaced<Elements<'f>> {
        let accessor = pick(self.all, number, owner, "accessor")?;
        let here = format!("accessors[{number}]");
        let width = component::width(&accessor.kind).filter(|width| widths.contains(width)).ok_or_else(|| {
            let wanted: Vec<_> = widths.iter().filter_map(|&width| component::name(width)).collect();
            format!("{here}.type: {:?} is not {}; write the file again", accessor.kind, wanted.join(" or "))
        })?;
        let component = component_of(accessor.component_type, &here)?;
        let size = width * component.size();
        if u32::try_from(accessor.count).is_err() {
            return Err(format!("{here}.count: {} elements are too many; split the mesh", accessor.count));
        }
        let count = accessor.count;
        let base = accessor.buffer_view.map(|view| self.strided(view, accessor.byte_offset, count, size, &here));
        let over = accessor.sparse.as_ref().map(|sparse| self.over(sparse, count, size, &here));
        let (base, over) = (base.transpose()?, over.transpose()?);
        let code = accessor.component_type;
        Ok(Elements { count, width, component, code, base, over, is_normalised: accessor.normalized })
    }

    /// A list of numbers of vertices.
    ///
    /// # Errors
    /// Those of [`Accessors::open`], and numbers that are not whole.
    pub fn indices(&self, number: usize, owner: &str) -> Unplaced<Elements<'f>> {
        let indices = self.open(number, &[1], owner)?;
        check_indices(indices.code, &format!("accessors[{number}]"))?;
        Ok(indices)
    }

    fn strided(&self, view: usize, offset: usize, count: usize, size: usize, owner: &str) -> Unplaced<Strided<'f>> {
        let (bytes, stride) = self.buffers.view(view, &format!("{owner}.bufferView"))?;
        let stride = stride.unwrap_or(size);
        if stride < size {
            return Err(format!(
                "bufferViews[{view}].byteStride: {stride} is less than the {size} bytes of an element; write the file again"
            ));
        }
        let found = bytes.len();
        let wanted = count.checked_sub(1).map_or(Some(0), |before| before.checked_mul(stride)?.checked_add(size));
        let wanted = wanted.and_then(|length| length.checked_add(offset));
        let part = wanted.filter(|&end| end <= found).and_then(|_| bytes.get(offset..));
        let bytes = part.ok_or_else(|| {
            format!(
                "{owner}: {count} elements of {size} bytes from {offset} are more than the {found} of buffer view {view}; \
                 write the file again"
            )
        })?;
        Ok(Strided { bytes, stride })
    }

    fn over(&self, sparse: &Sparse, count: usize, size: usize, owner: &str) -> Unplaced<Over<'f>> {
        let Sparse { count: places, indices, values } = sparse;
        let here = format!("{owner}.sparse");
        if *places > count {
            return Err(format!("{here}.count: {places} elements replace {count}; write the file again"));
        }
        let left = self.sparse.get().checked_sub(*places);
        self.sparse.set(left.ok_or_else(|| format!("{here}: sparse accessors are used too often; write dense ones"))?);
        let SparsePart { buffer_view, byte_offset, component_type } = *indices;
        let owner = format!("{here}.indices");
        let component = component_of(component_type, &owner)?;
        check_indices(component_type, &owner)?;
        let list = self.strided(buffer_view, byte_offset, *places, component.size(), &owner)?;
        let places: Vec<u32> = (0..*places).map(|number| component.whole(list.from(number))).collect();
        let is_rising = places.is_sorted_by(|a, b| a < b);
        if !is_rising || places.last().is_some_and(|&last| last as usize >= count) {
            return Err(format!("{owner}: they don't rise below {count}; write the file again"));
        }
        let values =
            self.strided(values.buffer_view, values.byte_offset, places.len(), size, &format!("{here}.values"))?;
        Ok(Over { places, values })
    }
}

/// Refuses indices that are no whole numbers from 0 on.
fn check_indices(code: u64, owner: &str) -> Unplaced<()> {
    match code {
        5121 | 5123 | 5125 => Ok(()),
        _ => Err(format!(
            "{owner}.componentType: {code} is none of 5121, 5123 and 5125, as indices have; write the file again"
        )),
    }
}

fn component_of(code: u64, owner: &str) -> Unplaced<Component> {
    let fault =
        || format!("{owner}.componentType: {code} is none of 5120 to 5123, 5125 and 5126; write the file again");
    Component::from_code(code).ok_or_else(fault)
}

impl Strided<'_> {
    /// The bytes from an element on; nothing beyond the last.
    fn from(&self, number: usize) -> &[u8] {
        number.checked_mul(self.stride).and_then(|start| self.bytes.get(start..)).unwrap_or_default()
    }
}

impl Elements<'_> {
    fn bytes(&self, number: usize) -> Option<&[u8]> {
        let over = self.over.as_ref().and_then(|over| {
            let place = over.places.binary_search(&u32::try_from(number).ok()?).ok()?;
            Some(over.values.from(place))
        });
        over.or_else(|| self.base.as_ref().map(|base| base.from(number)))
    }

    /// The vector of a number below the count, and of its `N` numbers those beyond the width are zero. None is finite for sure.
    pub fn vector<const N: usize>(&self, number: usize) -> [f32; N] {
        let mut vector = [0.0; N];
        let Some(bytes) = self.bytes(number) else { return vector };
        let parts = bytes.chunks_exact(self.component.size()).take(self.width);
        for (number, part) in vector.iter_mut().zip(parts) {
            *number = self.component.number(part, self.is_normalised);
        }
        vector
    }

    /// The whole number of a number below the count.
    pub fn whole(&self, number: usize) -> u32 {
        self.bytes(number).map_or(0, |bytes| self.component.whole(bytes))
    }
}

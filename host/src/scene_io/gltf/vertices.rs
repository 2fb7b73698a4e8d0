//! The vertices in use of a primitive, and what its attributes say of them.

use std::collections::BTreeMap;

use super::accessor::{Accessors, Elements};
use crate::scene::Unplaced;

/// Which vertices of a primitive are in use.
pub struct Vertices<'v, 'f> {
    /// Their numbers in the file.
    pub used: &'v [u32],
    /// How many positions the file has for the primitive.
    pub count: usize,
    pub accessors: &'v Accessors<'f>,
    /// The JSON path of the primitive.
    pub owner: &'v str,
}

impl<'f> Vertices<'_, 'f> {
    /// The list that attributes name; `within` is the key that holds them.
    ///
    /// # Errors
    /// Those of [`Accessors::open`], or a list that is not as long as that of the positions.
    pub fn attribute(
        &self,
        attributes: &BTreeMap<String, usize>,
        key: &str,
        widths: &[usize],
        within: &str,
    ) -> Unplaced<Option<Elements<'f>>> {
        let Some(&number) = attributes.get(key) else { return Ok(None) };
        let owner = format!("{}.{within}.{key}", self.owner);
        let elements = self.accessors.open(number, widths, &owner)?;
        let (found, wanted) = (elements.count, self.count);
        if found != wanted {
            return Err(format!("{owner}: it has {found} elements for {wanted} positions; write the file again"));
        }
        Ok(Some(elements))
    }

    /// What is made of the elements of the vertices in use; nothing of no list.
    pub fn list<T, const N: usize>(&self, elements: Option<Elements>, make: impl Fn([f32; N]) -> T) -> Vec<T> {
        let Some(elements) = elements else { return Vec::new() };
        self.used.iter().map(|&number| make(elements.vector(number as usize))).collect()
    }
}

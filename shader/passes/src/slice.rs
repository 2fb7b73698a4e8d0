//! A module's words, apart by function: a kernel is parsed without the others beside it.

use rustc_hash::{FxHashMap, FxHashSet};
use std::ops::Range;

use rspirv::spirv::{Op, Word};

use crate::{Error, Result};

/// Words of the header: magic number, version, generator, bound, schema.
const HEADER: usize = 5;

/// The words of a module, and where its functions are in them.
#[derive(Debug, Clone)]
pub struct Sliced {
    words: Vec<u32>,
    /// All that precedes the functions.
    globals: Range<usize>,
    functions: Vec<Function>,
    /// By name as it stands in the module.
    entries: FxHashMap<String, Word>,
}

#[derive(Debug, Clone)]
struct Function {
    id: Word,
    words: Range<usize>,
    calls: Vec<Word>,
}

impl Sliced {
    /// Finds the functions of a module.
    ///
    /// # Errors
    /// It is no SPIR-V module, or a broken one.
    pub fn new(bytes: &[u8]) -> Result<Self> {
        let (words, rest) = bytes.as_chunks::<4>();
        let words: Vec<u32> = words.iter().map(|word| u32::from_le_bytes(*word)).collect();
        if !rest.is_empty() || words.len() < HEADER || words[0] != rspirv::spirv::MAGIC_NUMBER {
            return Err(Error::Malformed("these bytes are no module".to_owned()));
        }
        let mut this = Sliced { globals: 0..words.len(), words, functions: Vec::new(), entries: FxHashMap::default() };
        let mut at = HEADER;
        while at < this.words.len() {
            let end = at + (this.words[at] >> 16) as usize;
            if end == at || end > this.words.len() {
                return Err(Error::Malformed(format!("the instruction at word {at} has no end")));
            }
            this.note(at..end);
            at = end;
        }
        Ok(this)
    }

    fn note(&mut self, at: Range<usize>) {
        let inst = &self.words[at.clone()];
        let is = |op: Op| inst[0] & 0xffff == op as u32;
        if is(Op::EntryPoint) && inst.len() > 3 {
            self.entries.insert(name(&inst[3..]), inst[2]);
        } else if is(Op::Function) && inst.len() > 2 {
            if self.functions.is_empty() {
                self.globals.end = at.start;
            }
            self.functions.push(Function { id: inst[2], words: at, calls: Vec::new() });
        } else if let Some(function) = self.functions.last_mut() {
            function.words.end = at.end;
            if is(Op::FunctionCall) && inst.len() > 3 {
                function.calls.push(inst[3]);
            }
        }
    }

    /// The names of the entry points, sorted.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.entries.keys().cloned().collect();
        names.sort_unstable();
        names
    }

    /// The words of the module without the functions that an entry point does not reach; the other entry points are
    /// still declared.
    ///
    /// # Errors
    /// There is no such entry point.
    pub fn of_entry(&self, entry: &str) -> Result<Vec<u32>> {
        let &root = self.entries.get(entry).ok_or_else(|| Error::NoEntry(entry.to_owned()))?;
        let mut reached = FxHashSet::default();
        let mut open = vec![root];
        while let Some(id) = open.pop() {
            if reached.insert(id) {
                let called = self.functions.iter().filter(|function| function.id == id);
                open.extend(called.flat_map(|function| &function.calls));
            }
        }
        let functions = || self.functions.iter().filter(|function| reached.contains(&function.id));
        let mentioned = self.mentioned(functions());
        let mut words = self.words[..HEADER].to_vec();
        for inst in self.preceding() {
            // Of ten thousand names and decorations a kernel has some hundred.
            if !is_note(inst) || mentioned.contains(&inst[1]) {
                words.extend_from_slice(inst);
            }
        }
        for function in functions() {
            words.extend_from_slice(&self.words[function.words.clone()]);
        }
        Ok(words)
    }

    /// What functions mention and what the globals consist of, names and decorations aside: their ids, and literals beside them.
    fn mentioned<'f>(&self, functions: impl Iterator<Item = &'f Function>) -> FxHashSet<u32> {
        let globals = self.preceding().filter(|inst| !is_note(inst)).flatten();
        let bodies = functions.flat_map(|function| &self.words[function.words.clone()]);
        globals.chain(bodies).copied().collect()
    }

    /// The instructions that precede the functions.
    fn preceding(&self) -> impl Iterator<Item = &[u32]> {
        let mut rest = &self.words[HEADER..self.globals.end];
        std::iter::from_fn(move || {
            // The lengths were checked as the module was read.
            let (inst, others) = rest.split_at_checked((*rest.first()? >> 16) as usize)?;
            rest = others;
            Some(inst)
        })
    }
}

/// Is it a name or a decoration of something?
fn is_note(inst: &[u32]) -> bool {
    const NOTES: [Op; 4] = [Op::Name, Op::MemberName, Op::Decorate, Op::MemberDecorate];
    inst.len() > 1 && NOTES.iter().any(|&note| inst[0] & 0xffff == note as u32)
}

/// A literal string: bytes in words, the first in the lowest, up to a zero.
fn name(words: &[u32]) -> String {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).take_while(|&byte| byte != 0).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Kernel;
    use rspirv::binary::Assemble;
    use rspirv::dr;

    #[test]
    fn an_entry_comes_with_what_it_calls_and_without_the_rest() {
        let mut kernel = Kernel::new();
        let called = kernel.protected(|b| {
            let x = b.load_input();
            b.store_output(x);
        });
        kernel.entry("a", |b| b.call(called));
        kernel.entry("b", |_| {});
        let bytes: Vec<u8> = kernel.module().assemble().into_iter().flat_map(u32::to_le_bytes).collect();
        let sliced = Sliced::new(&bytes).unwrap();
        assert_eq!(sliced.names(), ["a", "b"]);
        let functions = |entry| dr::load_words(sliced.of_entry(entry).unwrap()).unwrap().functions.len();
        assert_eq!((functions("a"), functions("b")), (2, 1));
        assert_eq!(sliced.of_entry("c"), Err(Error::NoEntry("c".to_owned())));
    }

    #[test]
    fn broken_modules_are_refused() {
        let bytes: Vec<u8> = Kernel::new().module().assemble().into_iter().flat_map(u32::to_le_bytes).collect();
        for broken in [&bytes[..bytes.len() - 4], &bytes[..bytes.len() - 1], &bytes[4..], &[], &[1, 2, 3, 4]] {
            assert!(matches!(Sliced::new(broken), Err(Error::Malformed(_))), "{} bytes", broken.len());
        }
    }
}

//! Strict reading of TOML tables: every value is checked where it is taken, and what nobody takes
//! is an unknown key. Every error knows its line.

use glam::{Vec2, Vec3};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::source::Source;
use super::suggest::{is_near, suggest};
use crate::choice::Named;
use crate::error::{Error, Result};
use crate::scene::Range;

/// A table whose keys are taken one by one.
pub struct Table<'s> {
    source: Source<'s>,
    name: String,
    at: usize,
    entries: Vec<Entry<'s>>,
    asked: Vec<&'static str>,
}

struct Entry<'s> {
    key: String,
    at: usize,
    value: Option<Spanned<DeValue<'s>>>,
}

/// What a key has, and where in the text.
pub(super) type Value<'s> = Spanned<DeValue<'s>>;

impl<'s> Table<'s> {
    /// A table that begins at byte `at` and is called `name` in messages.
    pub(super) fn new(source: Source<'s>, name: impl Into<String>, at: usize, table: DeTable<'s>) -> Self {
        let mut entries: Vec<_> = table
            .into_iter()
            .map(|(key, value)| Entry { at: key.span().start, key: key.into_inner().into_owned(), value: Some(value) })
            .collect();
        // The first unknown key of the file is the one to report.
        entries.sort_by_key(|entry| entry.at);
        Table { source, name: name.into(), at, entries, asked: Vec::new() }
    }

    /// Calls the table by a narrower name in messages: `a "spot" light`.
    pub fn rename(&mut self, name: impl Into<String>) {
        self.name = name.into();
    }

    /// A fault of the whole table.
    pub fn fault(&self, message: impl Into<String>) -> Error {
        self.source.fault(self.at, message)
    }

    /// A fault of a key's value; of the table where the key is missing.
    pub fn fault_of(&self, key: &str, message: impl Into<String>) -> Error {
        let entry = self.entries.iter().find(|entry| entry.key == key);
        self.source.fault(entry.map_or(self.at, |entry| entry.at), message)
    }

    /// A fault of a value in a list.
    pub(super) fn fault_at(&self, value: &Value<'_>, message: impl Into<String>) -> Error {
        self.source.fault(value.span().start, message)
    }

    /// The value of `key`, or the error that it is missing, or that a key which nobody took misspells it.
    pub fn need<T>(&self, key: &str, value: Option<T>) -> Result<T> {
        value.ok_or_else(|| {
            let misspelt = self.entries.iter().find(|entry| entry.value.is_some() && is_near(&entry.key, key));
            match misspelt {
                Some(entry) => self.unknown(entry, &format!("did you mean {key:?}?")),
                None => self.fault(format!("{} needs {key:?}; add it", self.name)),
            }
        })
    }

    /// Refuses every key that was not taken.
    pub fn done(self) -> Result<()> {
        match self.entries.iter().find(|entry| entry.value.is_some()) {
            None => Ok(()),
            Some(entry) => Err(self.unknown(entry, &suggest(&entry.key, self.asked.iter().copied()))),
        }
    }

    fn unknown(&self, entry: &Entry, remedy: &str) -> Error {
        self.source.fault(entry.at, format!("unknown key {:?} in {}; {remedy}", entry.key, self.name))
    }

    /// What it says, but for some keys: tables that say the same have equal texts. Takes nothing.
    pub fn text_without(&self, keys: &[&str]) -> String {
        let others = self.entries.iter().filter(|entry| !keys.contains(&entry.key.as_str()));
        let said = others.filter_map(|entry| Some((entry, entry.value.as_ref()?)));
        let mut said: Vec<String> =
            said.map(|(entry, value)| format!("{} = {}\n", entry.key, self.source.part(value.span()))).collect();
        said.sort_unstable();
        said.concat()
    }

    /// Is the key there? Does not take it.
    pub fn has(&self, key: &str) -> bool {
        self.entries.iter().any(|entry| entry.key == key)
    }

    /// Is the key's value a number? Does not take it.
    pub fn is_number(&self, key: &str) -> bool {
        matches!(self.value(key), Some(DeValue::Integer(_) | DeValue::Float(_)))
    }

    /// Is it a table? Does not take it.
    pub fn is_table(&self, key: &str) -> bool {
        matches!(self.value(key), Some(DeValue::Table(_)))
    }

    fn value(&self, key: &str) -> Option<&DeValue<'s>> {
        self.entries.iter().find(|entry| entry.key == key)?.value.as_ref().map(Spanned::get_ref)
    }

    /// A string.
    pub fn text(&mut self, key: &'static str) -> Result<Option<String>> {
        self.map(key, |table, value| match value.get_ref() {
            DeValue::String(text) => Ok(text.clone().into_owned()),
            _ => Err(table.mismatch(key, "a string in quotes", &value)),
        })
    }

    /// A name: a string that is not empty.
    pub fn name(&mut self, key: &'static str) -> Result<Option<String>> {
        match self.text(key)? {
            Some(name) if name.trim().is_empty() => Err(self.fault_of(key, format!("{key:?} is empty; give a name"))),
            name => Ok(name),
        }
    }

    /// A list of names.
    pub fn names(&mut self, key: &'static str) -> Result<Option<Vec<String>>> {
        const WANTED: &str = "a list of names in quotes";
        self.map(key, |table, value| {
            let name = |item: &Value<'_>| match item.get_ref() {
                DeValue::String(text) => Ok(text.clone().into_owned()),
                _ => Err(table.mismatch(key, WANTED, item)),
            };
            table.list(key, WANTED, &value)?.iter().map(name).collect()
        })
    }

    /// One of a few words.
    pub fn word<T: Copy>(&mut self, key: &'static str, words: &[(&str, T)]) -> Result<Option<T>> {
        let Some(text) = self.text(key)? else {
            return Ok(None);
        };
        match words.iter().find(|(word, _)| *word == text) {
            Some((_, value)) => Ok(Some(*value)),
            None => Err(self.fault_of(
                key,
                format!("unknown {key} {text:?}; {}", suggest(&text, words.iter().map(|(word, _)| *word))),
            )),
        }
    }

    /// One of the values that have names.
    pub fn choice<T: Named>(&mut self, key: &'static str) -> Result<Option<T>> {
        let words: Vec<(&str, T)> = T::VARIANTS.iter().map(|&value| (value.name(), value)).collect();
        self.word(key, &words)
    }

    /// `true` or `false`.
    pub fn flag(&mut self, key: &'static str) -> Result<Option<bool>> {
        self.map(key, |table, value| match value.get_ref() {
            DeValue::Boolean(flag) => Ok(*flag),
            _ => Err(table.mismatch(key, "true or false", &value)),
        })
    }

    /// One of the values that have names; `false` and `true` are two of them, in this order.
    pub fn flag_or_choice<T: Named>(&mut self, key: &'static str, [no, yes]: [T; 2]) -> Result<Option<T>> {
        let is_flag = self.entries.iter().any(|entry| {
            entry.key == key && matches!(entry.value.as_ref().map(|v| v.get_ref()), Some(DeValue::Boolean(_)))
        });
        if is_flag { Ok(self.flag(key)?.map(|flag| if flag { yes } else { no })) } else { self.choice(key) }
    }

    /// A number in the range.
    pub fn number(&mut self, key: &'static str, range: Range) -> Result<Option<f32>> {
        self.map(key, |table, value| table.check(key, &value, &range))
    }

    /// A whole number from `least` to `most`.
    pub fn whole(&mut self, key: &'static str, least: u32, most: u32) -> Result<Option<u32>> {
        self.map(key, |table, value| table.check_whole(key, &value, least, most))
    }

    /// Two whole numbers from `least` to `most`.
    pub fn pair(&mut self, key: &'static str, least: u32, most: u32) -> Result<Option<(u32, u32)>> {
        self.map(key, |table, value| {
            let items = table.items(key, &value, "two whole numbers, [width, height]", 2)?;
            Ok((table.check_whole(key, items[0], least, most)?, table.check_whole(key, items[1], least, most)?))
        })
    }

    /// Three numbers in the range.
    pub fn triple(&mut self, key: &'static str, range: Range) -> Result<Option<Vec3>> {
        self.map(key, |table, value| table.check_triple(key, &value, &range))
    }

    /// Three numbers in the range, or one for all three.
    pub fn triple_or_number(&mut self, key: &'static str, range: Range) -> Result<Option<Vec3>> {
        self.map(key, |table, value| match value.get_ref() {
            DeValue::Array(_) => table.check_triple(key, &value, &range),
            _ => table.check(key, &value, &range).map(Vec3::splat),
        })
    }

    /// A string, or a table whose string `within` is it, for the rest of that table.
    pub fn text_or_table(
        &mut self,
        key: &'static str,
        within: &'static str,
    ) -> Result<Option<(String, Option<Table<'s>>)>> {
        self.map(key, |parent, value| {
            let at = value.span().start;
            match value.into_inner() {
                DeValue::String(text) => Ok((text.into_owned(), None)),
                DeValue::Table(table) => {
                    let mut table = Table::new(parent.source.clone(), format!("[{key}]"), at, table);
                    let text = table.name(within)?;
                    Ok((table.need(within, text)?, Some(table)))
                }
                _ => Err(parent.fault_of(key, format!("{key:?} must be a file's name or a table"))),
            }
        })
    }

    /// Two numbers in the range, or one for both.
    pub fn two(&mut self, key: &'static str, range: Range) -> Result<Option<Vec2>> {
        self.map(key, |table, value| match value.get_ref() {
            DeValue::Array(_) => {
                let items = table.items(key, &value, "two numbers", 2)?;
                Ok(Vec2::new(table.check(key, items[0], &range)?, table.check(key, items[1], &range)?))
            }
            _ => table.check(key, &value, &range).map(Vec2::splat),
        })
    }

    /// Two places.
    pub fn two_places(&mut self, key: &'static str) -> Result<Option<[Vec3; 2]>> {
        self.map(key, |table, value| {
            let items = table.items(key, &value, "two places, [[x, y, z], [x, y, z]]", 2)?;
            Ok([table.check_triple(key, items[0], &Range::ANY)?, table.check_triple(key, items[1], &Range::ANY)?])
        })
    }

    /// Four places.
    pub fn corners(&mut self, key: &'static str) -> Result<Option<[Vec3; 4]>> {
        self.map(key, |table, value| {
            let items = table.items(key, &value, "four places, [[x, y, z], ...]", 4)?;
            let mut corners = [Vec3::ZERO; 4];
            for (corner, item) in corners.iter_mut().zip(items) {
                *corner = table.check_triple(key, item, &Range::ANY)?;
            }
            Ok(corners)
        })
    }

    /// A table of its own.
    pub fn table(&mut self, key: &'static str) -> Result<Option<Table<'s>>> {
        self.map(key, |parent, value| {
            let at = value.span().start;
            match value.into_inner() {
                DeValue::Table(table) => Ok(Table::new(parent.source.clone(), format!("[{key}]"), at, table)),
                _ => Err(parent.fault_of(key, format!("{key:?} must be a table: [{key}]"))),
            }
        })
    }

    /// A list of tables, `[[key]]`.
    pub fn tables(&mut self, key: &'static str) -> Result<Option<Vec<Table<'s>>>> {
        self.map(key, |parent, value| {
            let not = || parent.fault_of(key, format!("{key:?} must be a list: [[{key}]]"));
            let DeValue::Array(array) = value.into_inner() else {
                return Err(not());
            };
            let mut tables = Vec::new();
            for item in array {
                let at = item.span().start;
                let DeValue::Table(table) = item.into_inner() else {
                    return Err(not());
                };
                tables.push(Table::new(parent.source.clone(), format!("[[{key}]]"), at, table));
            }
            Ok(tables)
        })
    }

    /// What `read` makes of a key's value.
    pub(super) fn map<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&Self, Value<'s>) -> Result<T>,
    ) -> Result<Option<T>> {
        self.asked.push(key);
        let entry = self.entries.iter_mut().find(|entry| entry.key == key);
        match entry.and_then(|entry| entry.value.take()) {
            Some(value) => read(self, value).map(Some),
            None => Ok(None),
        }
    }

    /// The values of a list, which may be in another.
    pub(super) fn list<'v>(&self, key: &str, wanted: &str, value: &'v Value<'s>) -> Result<&'v [Value<'s>]> {
        match value.get_ref() {
            DeValue::Array(items) => Ok(items),
            _ => Err(self.mismatch(key, wanted, value)),
        }
    }

    fn mismatch(&self, key: &str, wanted: &str, value: &Value<'s>) -> Error {
        let found = value.get_ref().type_str();
        let message = format!("{key:?} must be {wanted}, not {} {found}", article(found));
        self.source.fault(value.span().start, message)
    }

    fn items<'v>(&self, key: &str, value: &'v Value<'s>, wanted: &str, count: usize) -> Result<Vec<&'v Value<'s>>> {
        let array = self.list(key, wanted, value)?;
        if array.len() != count {
            return Err(self.fault_at(value, format!("{key:?} must be {wanted}, not {} of them", array.len())));
        }
        Ok(array.iter().collect())
    }

    /// Three numbers in the range, of a value in a list.
    pub(super) fn check_triple(&self, key: &str, value: &Value<'s>, range: &Range) -> Result<Vec3> {
        let items = self.items(key, value, "three numbers", 3)?;
        Ok(Vec3::new(
            self.check(key, items[0], range)?,
            self.check(key, items[1], range)?,
            self.check(key, items[2], range)?,
        ))
    }

    /// A number in the range, likewise.
    pub(super) fn check(&self, key: &str, value: &Value<'s>, range: &Range) -> Result<f32> {
        let digits = match value.get_ref() {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            _ => return Err(self.mismatch(key, "a decimal number", value)),
        };
        match digits.parse() {
            Ok(number) if range.holds(number) => Ok(number),
            _ => Err(self.source.fault(value.span().start, format!("{key:?} must be {}, not {digits}", range.says()))),
        }
    }

    fn check_whole(&self, key: &str, value: &Value<'s>, least: u32, most: u32) -> Result<u32> {
        let DeValue::Integer(number) = value.get_ref() else {
            return Err(self.mismatch(key, "a whole number", value));
        };
        match u32::from_str_radix(number.as_str(), number.radix()) {
            Ok(number) if (least..=most).contains(&number) => Ok(number),
            _ => Err(self
                .source
                .fault(value.span().start, format!("{key:?} must be between {least} and {most}, not {number}"))),
        }
    }
}

fn article(noun: &str) -> &'static str {
    if noun.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" }
}

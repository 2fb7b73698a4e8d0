//! An `[[object]]` of a TOML scene: what meshes and other objects stand on, and where that is. Like a node of glTF, but it may be in
//! several places.

use std::collections::HashMap;

use super::budget::Budget;
use super::table::Table;
use super::transform::Transform;
use crate::error::Result;

/// Where something stands in the world.
#[derive(Clone, Debug, Default)]
pub struct Worlds {
    /// None where nobody says anything: then it stays as it is.
    pub places: Vec<Transform>,
    /// When the last key is of it and of all that it stands on.
    pub last: Option<f32>,
}

/// All objects by their names.
#[derive(Default)]
pub struct Objects {
    worlds: HashMap<String, Worlds>,
    /// Places of them all.
    places: u64,
}

/// The most places of all objects, and of what stands on one: places of places are many soon.
const MOST: u64 = 1 << 24;

/// An object that does not know yet where in the world it is.
struct Object<'s> {
    table: Table<'s>,
    own: Worlds,
    on: Option<String>,
}

impl Objects {
    /// Those of some tables, after so many seconds.
    ///
    /// # Errors
    /// One without a name or of the name of another, one that stands on nothing or on itself, more places than there is room for, or a
    /// number out of range.
    pub fn read(tables: Vec<Table<'_>>, seconds: f64, budget: &Budget) -> Result<Objects> {
        let mut open: HashMap<String, Object> = HashMap::new();
        let mut names = Vec::new();
        for mut table in tables {
            table.rename("an object");
            let name = table.name("name")?;
            let name = table.need("name", name)?;
            let (own, on) = local(&mut table, seconds)?;
            if open.contains_key(&name) {
                return Err(table.fault_of("name", format!("a second object {name:?}; rename one")));
            }
            names.push(name.clone());
            open.insert(name, Object { table, own, on });
        }
        let mut objects = Objects::default();
        for name in names {
            // From what stands on something down to the ground.
            let mut chain = Vec::new();
            let mut next = Some(name);
            while let Some((name, object)) = next.and_then(|name| open.remove_entry(&name)) {
                next = object.on.clone();
                chain.push((name, object));
            }
            for (name, Object { table, own, on }) in chain.into_iter().rev() {
                let worlds = objects.on(&table, own, on, budget)?;
                table.done()?;
                objects.places += worlds.places.len() as u64;
                objects.worlds.insert(name, worlds);
            }
        }
        Ok(objects)
    }

    /// Where a `[[mesh]]` stands, by its own keys and by what it stands on.
    ///
    /// # Errors
    /// There is no such object, more places than there is room for, or a number out of range.
    pub fn worlds(&self, table: &mut Table<'_>, seconds: f64, budget: &Budget) -> Result<Worlds> {
        let (own, on) = local(table, seconds)?;
        self.on(table, own, on, budget)
    }

    /// What is at some places of an object, in the world.
    fn on(&self, table: &Table<'_>, own: Worlds, on: Option<String>, budget: &Budget) -> Result<Worlds> {
        let Some(on) = on else { return Ok(own) };
        let Some(ground) = self.worlds.get(&on) else {
            let fault =
                format!("it stands on the object {on:?}, which is not there or stands on it itself; name another");
            return Err(table.fault_of("on", fault));
        };
        let last = own.last.into_iter().chain(ground.last).reduce(f32::max);
        let places = match (&ground.places[..], &own.places[..]) {
            (places, []) | ([], places) => places.to_vec(),
            (grounds, places) => {
                let count = grounds.len() as u64 * places.len() as u64;
                if self.places + count > MOST {
                    let fault = format!("with its {count} places there are more than {MOST}; use fewer");
                    return Err(table.fault_of("on", fault));
                }
                let room = budget.check_bytes((self.places + count) * size_of::<Transform>() as u64);
                room.map_err(|why| table.fault(format!("its {count} places {why}; use fewer")))?;
                let on = |ground: &Transform| places.iter().map(move |place| ground.after(place)).collect::<Vec<_>>();
                grounds.iter().flat_map(|ground| on(&ground.clone())).collect()
            }
        };
        Ok(Worlds { places, last })
    }
}

/// What the keys of a table say by themselves, and on what it stands.
fn local(table: &mut Table<'_>, seconds: f64) -> Result<(Worlds, Option<String>)> {
    let on = table.name("on")?;
    let (own, mut last) = Transform::read(table, seconds)?;
    let mut places = Vec::new();
    for mut place in table.tables("place")?.unwrap_or_default() {
        place.rename("a place");
        let (there, keys) = Transform::read(&mut place, seconds)?;
        place.done()?;
        last = last.into_iter().chain(keys).reduce(f32::max);
        let there = there.unwrap_or(Transform::NONE);
        places.push(own.map_or(there, |own| there.after(&own)));
    }
    if places.is_empty() {
        places.extend(own);
    }
    Ok((Worlds { places, last }, on))
}
